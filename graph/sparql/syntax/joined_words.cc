#include "graph/sparql/syntax/joined_words.h"

#include "graph/sparql/syntax/builtins.h"
#include "graph/sparql/values/text.h"

namespace docent::sparql {
namespace {

// Those of clauses. A keyword that begins another stands after it.
constexpr std::string_view kKeywords[] = {
    "ADD",   "ALL",       "ASC",     "ASK",    "AS",      "BASE",   "BIND",     "BY",     "CLEAR",
    "COPY",  "CONSTRUCT", "CREATE",  "DATA",   "DEFAULT", "DELETE", "DESCRIBE", "DESC",   "DISTINCT",
    "DROP",  "EXISTS",    "FILTER",  "FROM",   "GRAPH",   "GROUP",  "HAVING",   "INSERT", "INTO",
    "IN",    "LIMIT",     "LOAD",    "MINUS",  "MOVE",    "NAMED",  "NOT",      "OFFSET", "OPTIONAL",
    "ORDER", "PREFIX",    "REDUCED", "SELECT", "SERVICE", "SILENT", "TO",       "UNDEF",  "UNION",
    "USING", "VALUES",    "WHERE",   "WITH",   "false",   "true"};
constexpr size_t kShortest = 3, kLongest = 64;  // of several in one word

bool BeginsWith(std::string_view word, std::string_view keyword) {
  return (word[0] | 0x20) == (keyword[0] | 0x20) && word.size() >= keyword.size() &&
         EqualsIgnoreCase(word.substr(0, keyword.size()), keyword);
}

bool TakesCall(std::string_view keyword) {
  return keyword == "FILTER" || keyword == "HAVING" || keyword == "BY";
}

// True if `rest`, which follows `keyword`, is keywords and numbers, or ends with a function that may stand there.
bool AreWords(std::string_view rest, std::string_view keyword) {
  while (!rest.empty() && rest[0] >= '0' && rest[0] <= '9') rest.remove_prefix(1);
  if (rest.empty()) return true;
  for (const std::string_view next : kKeywords) {
    if (BeginsWith(rest, next) && AreWords(rest.substr(next.size()), next)) return true;
  }
  return TakesCall(keyword) && (FindBuiltin(rest) != nullptr || FindAggregate(rest).has_value());
}

}  // namespace

size_t FirstWordLength(std::string_view word) {
  if (word.size() < kShortest || word.size() > kLongest) return word.size();
  for (const std::string_view keyword : kKeywords) {
    if (!BeginsWith(word, keyword)) continue;
    if (AreWords(word.substr(keyword.size()), keyword)) return keyword.size();
  }
  return word.size();
}

}  // namespace docent::sparql
