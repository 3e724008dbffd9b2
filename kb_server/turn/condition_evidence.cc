#include "kb_server/turn/condition_evidence.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace docent::server {
namespace {

// The value of a position of a pattern; null where `binding` has none.
const Term* ValueOf(const sparql::PatternTerm& term, const engine::TermBinding& binding) {
  if (!term.IsVariable()) return &term.term();
  const auto value = binding.find(term.variable().name);
  return value == binding.end() ? nullptr : &value->second;
}

}  // namespace

ConditionEvidence::ConditionEvidence(const sparql::Query& query, const Dictionary* dictionary)
    : dictionary_(dictionary) {
  for (const sparql::PatternOccurrence& occurrence : sparql::AllTriplePatterns(*query.algebra)) {
    if (occurrence.monotone) patterns_.push_back(*occurrence.pattern);
  }
}

std::string ConditionEvidence::Text(const GraphVersion& version, const engine::TermBinding& binding) const {
  std::vector<std::string> lines;
  for (const sparql::TriplePattern& pattern : patterns_) {
    const Term* subject = ValueOf(pattern.subject, binding);
    const Term* predicate = ValueOf(pattern.predicate, binding);
    const Term* object = ValueOf(pattern.object, binding);
    if (subject == nullptr || predicate == nullptr || object == nullptr) continue;
    const std::optional<TermId> s = dictionary_->Find(*subject), p = dictionary_->Find(*predicate),
                                o = dictionary_->Find(*object);
    if (!s || !p || !o || version.Count({*s, *p, *o, TermId()}) == 0) continue;
    std::string line =
        absl::StrCat(ToNTriples(*subject), " ", ToNTriples(*predicate), " ", ToNTriples(*object), " .\n");
    // One fact may meet several patterns.
    if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(std::move(line));
  }
  return absl::StrJoin(lines, "");
}

}  // namespace docent::server
