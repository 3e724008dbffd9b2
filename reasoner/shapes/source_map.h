// Map from triples to file and line, for reports on files. Filled once, then read by any thread.
#ifndef DOCENT_REASONER_SHAPES_SOURCE_MAP_H_
#define DOCENT_REASONER_SHAPES_SOURCE_MAP_H_

#include <string>

#include "absl/container/flat_hash_map.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/term_id.h"
#include "graph/store/quad.h"

namespace docent::shapes {

struct SourcePlace {
  std::string file;
  SourceSpan span;
};

class SourceMap {
 public:
  // Adds the places of subject and object of a triple; its graph is ignored. The first place is kept.
  void Add(const Quad& quad, const SourcePlace& subject, const SourcePlace& object) {
    triples_.try_emplace(Quad{quad.subject, quad.predicate, quad.object, TermId()}, object);
    subjects_.try_emplace(quad.subject, subject);
    predicates_.try_emplace(Quad{quad.subject, quad.predicate, TermId(), TermId()}, object);
  }
  // The place of the triple's object (kNone: any object), or the first description of a node. Null if it is
  // not known.
  const SourcePlace* Find(TermId subject, TermId predicate, TermId object = TermId()) const {
    const auto& map = object.IsNone() ? predicates_ : triples_;
    auto it = map.find(Quad{subject, predicate, object, TermId()});
    return it == map.end() ? nullptr : &it->second;
  }
  const SourcePlace* Find(TermId subject) const {
    auto it = subjects_.find(subject);
    return it == subjects_.end() ? nullptr : &it->second;
  }

 private:
  absl::flat_hash_map<Quad, SourcePlace> triples_, predicates_;
  absl::flat_hash_map<TermId, SourcePlace> subjects_;
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SOURCE_MAP_H_
