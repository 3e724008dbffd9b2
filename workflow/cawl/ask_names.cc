#include "workflow/cawl/ask_names.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "graph/sparql/syntax/lexer.h"

namespace docent::cawl {
namespace {

// Renames one by one, as long as no name gets a second one.
class Renaming {
 public:
  explicit Renaming(NameMap* names) : names_(*names) {
    for (const auto& [from, to] : names_) taken_.insert(to);
  }

  // What the compiler itself names (_1, _event_1) is called the same.
  bool Take(std::string_view from, std::string_view to) {
    if (from.starts_with('_') || to.starts_with('_')) return from == to;
    const auto known = names_.find(std::string(from));
    if (known != names_.end()) return known->second == to;
    if (!taken_.insert(std::string(to)).second) return false;
    names_.emplace(from, to);
    return true;
  }
  bool Take(const std::vector<std::string>& from, const std::vector<std::string>& to) {
    return std::equal(from.begin(), from.end(), to.begin(), to.end(),
                      [this](const std::string& a, const std::string& b) { return Take(a, b); });
  }
  // The texts are the same but for the names of variables, comments and spaces.
  bool TakeQuery(const std::string& from, const std::string& to) {
    sparql::Lexer a(from), b(to);
    while (true) {
      const sparql::Token x = a.Next(), y = b.Next();
      if (x.kind != y.kind || x.kind == sparql::TokenKind::kError) return false;
      if (x.kind == sparql::TokenKind::kEnd) return true;
      const bool same = x.kind == sparql::TokenKind::kVariable ? Take(x.text, y.text)
                                                               : x.text == y.text && x.prefix == y.prefix;
      if (!same) return false;
    }
  }

 private:
  NameMap& names_;
  std::set<std::string> taken_;
};

std::vector<std::string> Sorted(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

const std::string& NameIn(const NameMap& names, const std::string& name) {
  const auto other = names.find(name);
  return other == names.end() ? name : other->second;
}

bool AskTheSame(const CompiledAsk& a, const CompiledAsk& b, NameMap* names) {
  Renaming renaming(names);
  if (a.priority != b.priority || !renaming.TakeQuery(a.ask, b.ask) ||
      !renaming.Take(a.free_variables, b.free_variables) ||
      !renaming.Take(a.event_variables, b.event_variables))
    return false;
  return std::equal(a.lasting.begin(), a.lasting.end(), b.lasting.begin(), b.lasting.end(),
                    [&](const LastingAsk& x, const LastingAsk& y) {
                      if (x.at_least_ms != y.at_least_ms || !renaming.TakeQuery(x.ask, y.ask)) return false;
                      std::vector<std::string> renamed;
                      for (const std::string& name : x.variables) renamed.push_back(NameIn(*names, name));
                      return Sorted(std::move(renamed)) == Sorted(y.variables);
                    });
}

}  // namespace docent::cawl
