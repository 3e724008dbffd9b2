#include "graph/sparql/syntax/prefix_places.h"

#include <map>
#include <string>

#include "graph/sparql/syntax/lexer.h"
#include "graph/sparql/values/text.h"

namespace docent::sparql {

std::vector<PrefixPlace> PrefixPlaces(std::string_view text) {
  std::vector<PrefixPlace> places;
  std::map<std::string, size_t, std::less<>> declared;  // last declaration of each name, as index of `places`
  Lexer lexer(text);
  bool declares = false;
  for (Token token = lexer.Next(); token.kind != TokenKind::kEnd && token.kind != TokenKind::kError;
       token = lexer.Next()) {
    if (token.kind == TokenKind::kPrefixedName && declares) {
      declared[std::string(token.prefix)] = places.size();
      places.push_back({std::string(token.prefix), std::string(lexer.Next().text), token.span});
    } else if (token.kind == TokenKind::kPrefixedName) {
      if (const auto found = declared.find(token.prefix); found != declared.end())
        ++places[found->second].uses;
    }
    declares = token.kind == TokenKind::kWord && EqualsIgnoreCase(token.text, "PREFIX");
  }
  return places;
}

}  // namespace docent::sparql
