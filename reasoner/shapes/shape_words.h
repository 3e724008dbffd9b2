// The words of the sh: namespace, and the kinds of nodes at which they have an effect. Other uses in a shapes
// graph are not evaluated, and reported. Private to this folder. Pure functions and values; one thread a
// value.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_WORDS_H_
#define DOCENT_REASONER_SHAPES_SHAPE_WORDS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/term_id.h"

namespace docent::shapes {

// Roles of a node in the shapes graph; a node may have several.
enum class NodeRole : uint8_t {
  kShape = 1,
  kConstraint = 2,  // the value of sh:sparql
  kComponent = 4,   // sh:ConstraintComponent, or a type of targets
  kParameter = 8,
  kValidator = 16,
  kTarget = 32,
  kRule = 64,  // the value of sh:rule, read by `docent rules use`
};

class NodeRoles {
 public:
  void Add(TermId node, NodeRole role) { roles_[node] |= static_cast<uint8_t>(role); }
  // As bits; 0: no evaluated triple leads to the node.
  uint8_t Of(TermId node) const {
    const auto found = roles_.find(node);
    return found == roles_.end() ? 0 : found->second;
  }

 private:
  absl::flat_hash_map<TermId, uint8_t> roles_;
};

enum class WordUse : uint8_t {
  kSays,          // it is evaluated at nodes of these roles
  kElsewhere,     // it is evaluated, but only at nodes of other roles
  kNotEvaluated,  // a word of SHACL that is not evaluated here
  kUnknown,
};
// Use of "minCount" at a node of these roles (bits).
WordUse UseOf(std::string_view word, uint8_t roles);
// The nodes at which it has an effect: "a sh:SPARQLConstraint, the value of sh:sparql". Empty for an unknown
// word.
std::string PlaceOfWord(std::string_view word);
// The remedy for a word that is not evaluated.
std::string_view AdviceFor(std::string_view word);
// True for a word that shows that its node is meant as a shape.
bool MakesAShape(std::string_view word);
// All words that have an effect at a shape, for hints.
const std::vector<std::string>& ShapeWords();

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_WORDS_H_
