// Shape properties: the predicates whose facts a set of shapes looks at, so that a change of others needs no validation.
// Private to this folder. Any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_PROPERTIES_H_
#define DOCENT_REASONER_SHAPES_SHAPE_PROPERTIES_H_

#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/shape.h"

namespace docent::shapes {

// Sets `properties`, in order, and `any_property` where queries or sh:closed may look at any fact.
void CollectProperties(const Dictionary& dictionary, ShapeSet* set);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_PROPERTIES_H_
