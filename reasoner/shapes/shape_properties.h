// Shape properties: the predicates of the facts that a set of shapes reads; a change of other facts needs no
// validation. Private to this folder. Any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_PROPERTIES_H_
#define DOCENT_REASONER_SHAPES_SHAPE_PROPERTIES_H_

#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/shape.h"

namespace docent::shapes {

// Sets `properties`, in order, and `any_property` if queries or sh:closed may read any fact.
void CollectProperties(const Dictionary& dictionary, ShapeSet* set);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_PROPERTIES_H_
