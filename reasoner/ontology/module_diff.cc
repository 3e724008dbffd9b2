#include "reasoner/ontology/module_diff.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <tuple>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_format.h"
#include "graph/base/fingerprint.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::ontology {
namespace {

// splitmix64's finaliser (Steele et al. 2014), so that sums of mixed values do not cancel each other out.
uint64_t Mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// Colours of blank nodes: each round includes triples one step further away.
class Colours {
 public:
  explicit Colours(const std::vector<TermQuad>& quads) {
    for (const TermQuad& q : quads) {
      for (const Term* term : {&q.subject, &q.object}) {
        if (term->IsBlank()) colours_.try_emplace(term->lexical, 1);
      }
    }
    // The same number of rounds for every graph, so that colours of two graphs are comparable.
    for (int round = 0; round < kRounds && !colours_.empty(); ++round) Refine(quads);
  }

  // The triple with blank nodes named by their colours.
  TermQuad Normalise(const TermQuad& quad) const {
    TermQuad out{quad.subject, quad.predicate, quad.object, Term()};
    for (Term* term : {&out.subject, &out.object}) {
      if (term->IsBlank()) term->lexical = absl::StrFormat("n%016x", colours_.at(term->lexical));
    }
    return out;
  }

 private:
  static constexpr int kRounds = 16;

  uint64_t ColourOf(const Term& term) const {
    if (term.IsBlank()) return colours_.at(term.lexical);
    return Fingerprint(term.language.empty() ? ToNTriples(term)
                                             : Concat(term.lexical, "@", LowerLanguage(term.language)));
  }

  void Refine(const std::vector<TermQuad>& quads) {
    absl::flat_hash_map<std::string, uint64_t> next;
    for (const auto& [label, colour] : colours_) next[label] = Mix(colour);
    for (const TermQuad& q : quads) {
      if (!q.subject.IsBlank() && !q.object.IsBlank()) continue;
      const uint64_t predicate = Fingerprint(q.predicate.lexical);
      if (q.subject.IsBlank()) next[q.subject.lexical] += Mix(ColourOf(q.object) ^ Mix(predicate));
      if (q.object.IsBlank()) next[q.object.lexical] += Mix(ColourOf(q.subject) ^ Mix(predicate + 1));
    }
    colours_ = std::move(next);
  }

  absl::flat_hash_map<std::string, uint64_t> colours_;
};

bool Before(const TermQuad& a, const TermQuad& b) {
  return std::tie(a.subject, a.predicate, a.object) < std::tie(b.subject, b.predicate, b.object);
}

std::vector<TermQuad> Normalised(const std::vector<TermQuad>& quads) {
  const Colours colours(quads);
  std::vector<TermQuad> out;
  for (const TermQuad& quad : quads) out.push_back(colours.Normalise(quad));
  std::sort(out.begin(), out.end(), Before);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

ModuleDiff DiffModules(const std::vector<TermQuad>& before, const std::vector<TermQuad>& after) {
  const std::vector<TermQuad> old_triples = Normalised(before), new_triples = Normalised(after);
  ModuleDiff diff;
  std::set_difference(old_triples.begin(), old_triples.end(), new_triples.begin(), new_triples.end(),
                      std::back_inserter(diff.removed), Before);
  std::set_difference(new_triples.begin(), new_triples.end(), old_triples.begin(), old_triples.end(),
                      std::back_inserter(diff.added), Before);
  return diff;
}

ModuleVersion VersionOf(const std::vector<TermQuad>& quads) {
  ModuleVersion version;
  const std::string ontology = Concat(kOwlNs, "Ontology");
  for (const TermQuad& q : quads) {
    if (q.predicate.lexical == kRdfType && q.object.lexical == ontology && q.subject.IsIri()) {
      version.ontology = q.subject.lexical;
      break;
    }
  }
  for (const TermQuad& q : quads) {
    if (version.ontology.empty() || q.subject.lexical != version.ontology) continue;
    if (q.predicate.lexical == Concat(kOwlNs, "versionIRI")) version.version_iri = q.object.lexical;
    if (q.predicate.lexical == Concat(kOwlNs, "versionInfo")) version.version_info = q.object.lexical;
  }
  return version;
}

}  // namespace docent::ontology
