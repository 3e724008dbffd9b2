// The shapes graph → shapes (SHACL section 2), with everything that is ill-formed said. Any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_READER_H_
#define DOCENT_REASONER_SHAPES_SHAPE_READER_H_

#include "graph/base/check_limits.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/graph_view.h"
#include "reasoner/shapes/shape.h"
#include "reasoner/shapes/source_map.h"

namespace docent::sparql {
class FunctionRegistry;
}

namespace docent::shapes {

struct ParsedShapes {
  ShapeSet shapes;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// Reads the shapes that have targets or are typed sh:NodeShape or sh:PropertyShape, and those that they refer to, with the
// constraints, components and targets in SPARQL that they use. A class that is a shape targets its instances; owl:Class counts
// as rdfs:Class.
//  error    an ill-formed path, list, parameter or target; a regular expression that cannot be compiled; a query that is no
//           SPARQL, or that SHACL does not allow where variables are given before (appendix A); a component that is ill-formed
//           and used; a shape that refers to itself (section 3.4.3 leaves its meaning open: it is refused, with the cycle);
//           shapes nested deeper than shape_nesting
//  warning  whatever else the graph says in words of the sh: namespace and is not evaluated: words that are not known (with the
//           nearest known), that say nothing where they stand, or that are of what is not supported (rules, JavaScript, node
//           expressions, entailment); what looks like a shape and is never used; an ill-formed component that no shape uses
// At most CheckLimits::check_diagnostics of them. `places` may be null; `functions` too: then what a query calls is looked at
// when it is evaluated.
ParsedShapes ReadShapes(const GraphView& graph, const Dictionary& dictionary, const CheckLimits& limits = {},
                        const SourceMap* places = nullptr,
                        const sparql::FunctionRegistry* functions = nullptr);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_READER_H_
