#include "reasoner/rules/inconsistency.h"

#include <algorithm>
#include <array>
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

bool InconsistencyFacts::AreNamedBy(std::string_view predicate, std::string_view object) {
  if (predicate == kRdfType) return object == DocentIri("Inconsistency");
  constexpr std::array kOwn = {"rule", "evidence", "binding", "bindingName", "bindingValue"};
  return std::any_of(kOwn.begin(), kOwn.end(),
                     [&](const char* word) { return predicate == DocentIri(word); });
}

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
  const std::string name = rule.name.empty() ? NameInIri(rule.set) : rule.name;
  const std::string iri =
      absl::StrCat(std::string(kPrefix), name, ":", absl::Hex(Fingerprint(text), absl::kZeroPad16));
  const TermId id = dictionary_.InternIri(iri);
  InternWords();
  out.push_back({id, type_, inconsistency_});
  out.push_back(
      {id, words_[kRule], dictionary_.Intern(Term::Literal(rule.name.empty() ? rule.label : rule.name))});
  int number = 0;
  for (const Triple& t : matched) {
    const TermId evidence = dictionary_.InternIri(absl::StrCat(iri, ":", ++number));
    out.push_back({id, words_[kEvidence], evidence});
    out.push_back({evidence, words_[kSubject], t.subject});
    out.push_back({evidence, words_[kPredicate], t.predicate});
    out.push_back({evidence, words_[kObject], t.object});
  }
  for (size_t i = 0; !flat && i < row.size(); ++i) {
    const matching::Body::Column& column = rule.body->columns()[i];
    if (!column.visible || row[i].IsNone()) continue;
    const TermId binding = dictionary_.InternIri(absl::StrCat(iri, ":variable:", column.name));
    out.push_back({id, words_[kBinding], binding});
    out.push_back({binding, words_[kBindingName], dictionary_.Intern(Term::Literal(column.name))});
    out.push_back({binding, words_[kBindingValue], row[i]});
  }
}

void InconsistencyFacts::InternWords() {
  if (!inconsistency_.IsNone()) return;
  type_ = dictionary_.InternIri(kRdfType);
  inconsistency_ = dictionary_.InternIri(DocentIri("Inconsistency"));
  words_[kRule] = dictionary_.InternIri(DocentIri("rule"));
  words_[kEvidence] = dictionary_.InternIri(DocentIri("evidence"));
  words_[kBinding] = dictionary_.InternIri(DocentIri("binding"));
  words_[kBindingName] = dictionary_.InternIri(DocentIri("bindingName"));
  words_[kBindingValue] = dictionary_.InternIri(DocentIri("bindingValue"));
  const auto rdf = [&](const char* word) { return dictionary_.InternIri(Concat(kRdfNs, word)); };
  words_[kSubject] = rdf("subject");
  words_[kPredicate] = rdf("predicate");
  words_[kObject] = rdf("object");
}

}  // namespace docent::rules
