#include "reasoner/rules/inconsistency.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "kb_server/base/text.h"
#include "kb_server/rdf/document_name.h"
#include "kb_server/rdf/vocabulary.h"

namespace docent {
namespace {

// FNV-1a, 64 bits.
uint64_t Hash(std::string_view text) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

}  // namespace

void InconsistencyFacts::Make(const CompiledRule& rule, absl::Span<const TermId> row,
                              std::vector<Triple>& out) {
  std::vector<Triple> matched;
  std::string text = absl::StrCat(rule.set, "\n", rule.name.empty() ? rule.text : rule.name);
  for (size_t i = 0; i < rule.body->patterns().size(); ++i) matched.push_back(rule.Premise(i, row));
  const auto add_text = [&](TermId id) {
    absl::StrAppend(&text, "\n", id.IsNone() ? "" : ToNTriples(dictionary_.Decode(id)));
  };
  if (matched.empty()) {
    for (const TermId id : row) add_text(id);
  }
  for (const Triple& t : matched) {
    for (const TermId id : {t.subject, t.predicate, t.object}) add_text(id);
  }
  const std::string name = rule.name.empty() ? NameInIri(rule.set) : rule.name;
  const std::string iri =
      absl::StrCat("urn:docent:inconsistency:", name, ":", absl::Hex(Hash(text), absl::kZeroPad16));
  const TermId id = dictionary_.InternIri(iri);
  if (inconsistency_.IsNone()) InternWords();
  reports_.insert(id);
  out.push_back({id, type_, inconsistency_});
  out.push_back(
      {id, words_[kRule], dictionary_.Intern(Term::Literal(rule.name.empty() ? rule.label : rule.name))});
  int number = 0;
  for (const Triple& t : matched) {
    const TermId evidence = dictionary_.InternIri(absl::StrCat(iri, ":", ++number));
    reports_.insert(evidence);
    out.push_back({id, words_[kEvidence], evidence});
    out.push_back({evidence, words_[kSubject], t.subject});
    out.push_back({evidence, words_[kPredicate], t.predicate});
    out.push_back({evidence, words_[kObject], t.object});
  }
}

void InconsistencyFacts::InternWords() {
  type_ = dictionary_.InternIri(kRdfType);
  inconsistency_ = dictionary_.InternIri(DocentIri("Inconsistency"));
  words_[kRule] = dictionary_.InternIri(DocentIri("rule"));
  words_[kEvidence] = dictionary_.InternIri(DocentIri("evidence"));
  const auto rdf = [&](const char* word) { return dictionary_.InternIri(Concat(kRdfNs, word)); };
  words_[kSubject] = rdf("subject");
  words_[kPredicate] = rdf("predicate");
  words_[kObject] = rdf("object");
}

void InconsistencyFacts::Find(const GraphVersion& graph) {
  reports_.clear();
  const std::optional<TermId> type = dictionary_.FindIri(kRdfType),
                              graph_id = dictionary_.FindIri(kInferredGraph),
                              inconsistency = dictionary_.FindIri(DocentIri("Inconsistency"));
  if (!type || !graph_id || !inconsistency) return;
  std::vector<TermId> found;
  graph.ForEach({TermId(), *type, *inconsistency, *graph_id}, [&](const Quad& quad) {
    found.push_back(quad.subject);
    return true;
  });
  if (found.empty()) return;
  InternWords();
  for (const TermId report : found) {
    reports_.insert(report);
    graph.ForEach({report, words_[kEvidence], TermId(), *graph_id}, [&](const Quad& quad) {
      reports_.insert(quad.object);
      return true;
    });
  }
}

}  // namespace docent
