// The words of the sh: namespace: which of them say something, and at what kind of node. What a shapes graph says beyond that
// is not evaluated, and told. Private to this folder. Pure functions and values; one thread a value.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_WORDS_H_
#define DOCENT_REASONER_SHAPES_SHAPE_WORDS_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/term_id.h"

namespace docent::shapes {

// What a node of the shapes graph is read as; one may be several.
enum class NodeRole : uint8_t {
  kShape = 1,
  kConstraint = 2,  // the value of sh:sparql
  kComponent = 4,   // sh:ConstraintComponent, or a type of targets
  kParameter = 8,
  kValidator = 16,
  kTarget = 32,
  kRule = 64,  // the value of sh:rule: `docent rules use` reads it
};

class NodeRoles {
 public:
  void Add(TermId node, NodeRole role) { roles_[node] |= static_cast<uint8_t>(role); }
  // As bits; 0: nothing that is read leads to the node.
  uint8_t Of(TermId node) const {
    const auto found = roles_.find(node);
    return found == roles_.end() ? 0 : found->second;
  }

 private:
  absl::flat_hash_map<TermId, uint8_t> roles_;
};

enum class WordUse : uint8_t {
  kSays,          // it is evaluated at nodes of these roles
  kElsewhere,     // it is evaluated, but at nodes of other roles
  kNotEvaluated,  // of SHACL, and not evaluated here
  kUnknown,
};
// Of "minCount" at a node of these roles (bits).
WordUse UseOf(std::string_view word, uint8_t roles);
// Where it says something: "a sh:SPARQLConstraint, the value of sh:sparql". Empty of an unknown word.
std::string PlaceOfWord(std::string_view word);
// What to do about a word that is not evaluated.
std::string_view AdviceFor(std::string_view word);
// A word that says something of the shape it stands at, so that it is no accident.
bool MakesAShape(std::string_view word);
// All words that say something at a shape, for guesses.
const std::vector<std::string>& ShapeWords();

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_WORDS_H_
