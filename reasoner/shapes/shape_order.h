// References between shapes: cycles and depth. Pure function; private to this folder.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_ORDER_H_
#define DOCENT_REASONER_SHAPES_SHAPE_ORDER_H_

#include <vector>

#include "reasoner/shapes/shape.h"

namespace docent::shapes {

struct ShapeOrder {
  std::vector<ShapeIndex> cycle;  // each refers to the next, the last to the first; empty: none
  int depth = 0;                  // of the longest chain of references
  ShapeIndex deepest = 0;         // the start of that chain
};
ShapeOrder OrderShapes(const ShapeSet& shapes);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_ORDER_H_
