#include "reasoner/rules/inconsistency.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
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
                              std::vector<Triple>& out) const {
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
  const std::string name = rule.name.empty() ? rule.set : rule.name;
  const std::string iri =
      absl::StrCat("urn:docent:inconsistency:", name, ":", absl::Hex(Hash(text), absl::kZeroPad16));
  const TermId id = dictionary_.InternIri(iri);
  const TermId of_rule = dictionary_.InternIri(DocentIri("rule")),
               with = dictionary_.InternIri(DocentIri("evidence"));
  const auto rdf = [&](const char* word) { return dictionary_.InternIri(std::string(kRdfNs) + word); };
  out.push_back({id, rdf("type"), dictionary_.InternIri(DocentIri("Inconsistency"))});
  out.push_back({id, of_rule, dictionary_.Intern(Term::Literal(rule.name.empty() ? rule.label : rule.name))});
  int number = 0;
  for (const Triple& t : matched) {
    const TermId evidence = dictionary_.InternIri(absl::StrCat(iri, ":", ++number));
    out.push_back({id, with, evidence});
    out.push_back({evidence, rdf("subject"), t.subject});
    out.push_back({evidence, rdf("predicate"), t.predicate});
    out.push_back({evidence, rdf("object"), t.object});
  }
}

}  // namespace docent
