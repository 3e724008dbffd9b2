#include "reasoner/rules/inconsistency.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "graph/base/fingerprint.h"
#include "graph/base/text.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/vocabulary.h"

namespace docent::rules {
namespace {

// The triples that a solution must have matched, as far as its row determines them. Other facts in the graph
// must not matter: the same solution must always give the same report.
std::vector<Triple> Matched(const CompiledRule& rule, absl::Span<const TermId> row) {
  std::vector<Triple> matched;
  if (rule.body->flat()) {
    for (size_t i = 0; i < rule.body->patterns().size(); ++i) matched.push_back(rule.Premise(i, row));
    return matched;
  }
  for (const matching::Trigger& trigger : rule.body->triggers()) {
    if (!trigger.required || trigger.polarity != matching::Polarity::kPositive) continue;
    const QuadPattern& constants = trigger.match.constants;
    std::array<TermId, 3> terms = {constants.subject, constants.predicate, constants.object};
    for (size_t i = 0; i < terms.size(); ++i) {
      if (trigger.columns[i] != matching::Trigger::kNoColumn)
        terms[i] = row[static_cast<size_t>(trigger.columns[i])];
    }
    if (std::none_of(terms.begin(), terms.end(), [](TermId id) { return id.IsNone(); }))
      matched.push_back({terms[0], terms[1], terms[2]});
  }
  return matched;
}

}  // namespace

void InconsistencyFacts::Make(const CompiledRule& rule, absl::Span<const TermId> row,
                              std::vector<Triple>& out) {
  const std::vector<Triple> matched = Matched(rule, row);
  const bool flat = rule.body->flat();
  // If the triples determine a solution, those of two rules with one name come and go together.
  const bool by_name = !rule.name.empty() && rule.positive;
  std::string text = absl::StrCat(rule.set, "\n", by_name ? rule.name : rule.text);
  const auto add_text = [&](TermId id) {
    absl::StrAppend(&text, "\n", id.IsNone() ? "" : ToNTriples(dictionary_.Decode(id)));
  };
  if (!flat) {
    for (const TermId id : row) add_text(id);
  }
  for (const Triple& t : matched) {
    for (const TermId id : {t.subject, t.predicate, t.object}) add_text(id);
  }
  const std::string iri = absl::StrCat(PrefixOf(rule), absl::Hex(Fingerprint(text), absl::kZeroPad16));
  const TermId id = dictionary_.InternIri(iri);
  InternWords();
  const auto of = [&](ReportWords::Word word) { return words_.words[word]; };
  out.push_back({id, words_.type, words_.inconsistency});
  out.push_back({id, of(ReportWords::kRule),
                 dictionary_.Intern(Term::Literal(rule.name.empty() ? rule.label : rule.name))});
  int number = 0;
  for (const Triple& t : matched) {
    const TermId evidence = dictionary_.InternIri(absl::StrCat(iri, ":", ++number));
    out.push_back({id, of(ReportWords::kEvidence), evidence});
    out.push_back({evidence, of(ReportWords::kSubject), t.subject});
    out.push_back({evidence, of(ReportWords::kPredicate), t.predicate});
    out.push_back({evidence, of(ReportWords::kObject), t.object});
  }
  for (size_t i = 0; !flat && i < row.size(); ++i) {
    const matching::Body::Column& column = rule.body->columns()[i];
    if (!column.visible || row[i].IsNone()) continue;
    const TermId binding = dictionary_.InternIri(absl::StrCat(iri, ":variable:", column.name));
    out.push_back({id, of(ReportWords::kBinding), binding});
    out.push_back({binding, of(ReportWords::kBindingName), dictionary_.Intern(Term::Literal(column.name))});
    out.push_back({binding, of(ReportWords::kBindingValue), row[i]});
  }
}

void InconsistencyFacts::InternWords() {
  if (words_.inconsistency.IsNone()) words_ = ReportWords::Intern(dictionary_);
}

std::string InconsistencyFacts::PrefixOf(const CompiledRule& rule) {
  return absl::StrCat(std::string(kPrefix), rule.name.empty() ? NameInIri(rule.set) : rule.name, ":");
}

bool InconsistencyFacts::MayBeOf(const CompiledRule& rule, const Triple& t) const {
  return IsOfReport(t) && dictionary_.Lexical(t.subject).starts_with(PrefixOf(rule));
}

std::vector<Triple> InconsistencyFacts::FactsIn(const GraphVersion& graph) const {
  std::vector<Triple> facts;
  const auto take = [&](const QuadPattern& pattern) {
    graph.ForEach(pattern, [&](const Quad& quad) {
      const Triple fact = {quad.subject, quad.predicate, quad.object};
      if (IsOfReport(fact)) facts.push_back(fact);
      return true;
    });
  };
  take({TermId(), words_.type, words_.inconsistency, TermId()});
  for (const TermId word : words_.words) take({TermId(), word, TermId(), TermId()});
  std::sort(facts.begin(), facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return facts;
}

}  // namespace docent::rules
