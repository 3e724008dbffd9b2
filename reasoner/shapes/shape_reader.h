// The shapes graph → shapes (SHACL section 2), with everything that is ill-formed said. Any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_READER_H_
#define DOCENT_REASONER_SHAPES_SHAPE_READER_H_

#include "graph/base/check_limits.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/graph_view.h"
#include "reasoner/shapes/shape.h"
#include "reasoner/shapes/source_map.h"

namespace docent::shapes {

struct ParsedShapes {
  ShapeSet shapes;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// Reads the shapes that have targets or are typed sh:NodeShape or sh:PropertyShape, and those that they refer to; what
// nothing refers to is not looked at. A class that is a shape targets its instances; owl:Class counts as rdfs:Class.
//  error    an ill-formed path, list, parameter or target; a regular expression that cannot be compiled; a shape that
//           refers to itself (section 3.4.3 leaves its meaning open: it is refused, with the cycle); shapes nested
//           deeper than shape_nesting
//  warning  words of SHACL that are not SHACL Core (sh:sparql …) and are therefore not checked; unknown words of the sh:
//           namespace, with the nearest known
// At most CheckLimits::check_diagnostics of them. `places` may be null.
ParsedShapes ReadShapes(const GraphView& graph, const Dictionary& dictionary, const CheckLimits& limits = {},
                        const SourceMap* places = nullptr);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_READER_H_
