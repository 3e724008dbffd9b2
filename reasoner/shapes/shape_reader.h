// Reader of a shapes graph (SHACL section 2); it reports everything that is ill-formed. Any thread.
#ifndef DOCENT_REASONER_SHAPES_SHAPE_READER_H_
#define DOCENT_REASONER_SHAPES_SHAPE_READER_H_

#include <string>
#include <vector>

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

// The entailment regimes that the data follow (IRIs), and what it is where shapes name another one (sh:entailment): an error where
// something is validated.
struct Regimes {
  std::vector<std::string> followed = {};
  Diagnostic::Severity otherwise = Diagnostic::Severity::kWarning;
};

struct ParsedShapes {
  ShapeSet shapes;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// Reads the shapes that have targets or are typed sh:NodeShape or sh:PropertyShape, and those that they refer
// to, with the constraints, components and targets in SPARQL that they use. A class that is a shape targets
// its instances; owl:Class counts as rdfs:Class.
//  error    an ill-formed path, list, parameter or target; a regular expression that cannot be compiled; a
//           query that is not SPARQL, or that SHACL does not allow with given variables (appendix A); an
//           ill-formed component that is used; shapes nested deeper than shape_nesting; a shape that refers to
//           itself (section 3.4.3 leaves its meaning open: it is refused, with the cycle)
//  warning  other triples with words of the sh: namespace that are not evaluated: unknown words (with the
//           nearest known), words without effect at their node, or of unsupported features (rules, JavaScript,
//           node expressions); unused nodes that look like shapes; unused ill-formed components
//  either   a sh:entailment of a regime that is not among `regimes`
// At most CheckLimits::check_diagnostics of them. `places` may be null; `functions` too: then the functions of
// a query are checked at its evaluation.
ParsedShapes ReadShapes(const GraphView& graph, const Dictionary& dictionary, const CheckLimits& limits = {},
                        const SourceMap* places = nullptr,
                        const sparql::FunctionRegistry* functions = nullptr, const Regimes& regimes = {});

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SHAPE_READER_H_
