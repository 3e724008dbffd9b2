// Reader of the SPARQL parts of a shapes graph: constraints of shapes (SHACL section 5), constraint
// components (section 6), and targets (SHACL Advanced Features, section 3). Private to this folder. One
// thread.
#ifndef DOCENT_REASONER_SHAPES_SPARQL_READER_H_
#define DOCENT_REASONER_SHAPES_SPARQL_READER_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/graph_view.h"
#include "reasoner/shapes/shape.h"
#include "reasoner/shapes/shape_query.h"
#include "reasoner/shapes/shape_words.h"

namespace docent::sparql {
class FunctionRegistry;
}

namespace docent::shapes {

class SparqlReader {
 public:
  // Reports a mistake at a node of the shapes graph, at its value for the word `local` ("": at the node).
  using Tell = std::function<void(TermId node, std::string_view local, std::string message, std::string hint,
                                  Diagnostic::Severity severity)>;

  // All arguments must outlive it. `functions`: the functions that calls may use; null: unchecked. `roles`
  // receives the roles of the nodes read.
  SparqlReader(const GraphView& graph, const Dictionary& dictionary,
               const sparql::FunctionRegistry* functions, NodeRoles& roles, Tell tell);

  // Reads the constraints of `shape` (whose path is read) from sh:sparql and from components of the shapes
  // graph.
  void ReadConstraints(Shape* shape);
  // Reads its values for sh:target.
  void ReadTargets(Shape* shape);
  // Reports mistakes in components and target types that no shape uses.
  void CheckUnused();
  // True if a query that was read mentions $shapesGraph.
  bool asks_shapes_graph() const { return asks_shapes_graph_; }

 private:
  struct Parameter {
    TermId path;
    std::string variable;
    bool optional = false;
  };
  struct Problem {
    TermId node;
    std::string local, message, hint;
  };
  // A component or a type of targets, with its parameters.
  struct Declared {
    TermId node;
    std::vector<Parameter> parameters;
    std::vector<Problem> problems;  // if not empty, it is ill-formed
    bool used = false;
  };
  // Values by the names of parameters.
  using ArgumentList = std::vector<std::pair<std::string, TermId>>;

  TermId Id(std::string_view iri) const { return dictionary_.FindIri(iri).value_or(kAbsentTerm); }
  TermId Sh(std::string_view local) const { return Id(Shacl(local)); }
  std::string Show(TermId id) const { return ToDisplay(dictionary_.Decode(id)); }
  std::vector<TermId> Values(TermId node, std::string_view local) const {
    return graph_.Objects(node, Sh(local));
  }
  bool IsTrue(TermId node, std::string_view local) const;
  void Error(TermId node, std::string_view local, std::string message, std::string hint) const {
    tell_(node, local, std::move(message), std::move(hint),
          lenient_ ? Diagnostic::Severity::kWarning : Diagnostic::Severity::kError);
  }
  void Warn(TermId node, std::string_view local, std::string message, std::string hint) const {
    tell_(node, local, std::move(message), std::move(hint), Diagnostic::Severity::kWarning);
  }

  std::vector<TermId> InstancesOf(std::string_view local) const;
  std::vector<Declared> ReadDeclared(std::string_view type);
  void ReadParameters(Declared* declared);
  std::vector<TermId> Messages(TermId node);
  using Prefixes = std::vector<std::pair<std::string, std::string>>;
  // nullopt: ill-formed, and reported.
  std::optional<Prefixes> PrefixesOf(TermId node);
  // The query at `word` of `node`; null: ill-formed, and reported. `path`: null if there is none.
  std::shared_ptr<ShapeQuery> ReadQuery(TermId node, std::string_view word, const GivenVariables& given,
                                        const Path* path);
  void ReadSparql(Shape* shape, TermId node);
  void ReadOwn(Shape* shape, Declared* component);
  // The arguments at `node`, an element for each constraint; empty: it does not use them.
  std::vector<ArgumentList> ArgumentsAt(TermId node, Declared* declared);
  TermId ValidatorFor(const Shape& shape, const Declared& component);
  static GivenVariables GivenOf(const Declared& declared, bool constraint, bool ask);
  void CheckQueries(const Declared& declared, bool constraint);

  const GraphView& graph_;
  const Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  NodeRoles& roles_;
  const Tell tell_;
  bool asks_shapes_graph_ = false;
  bool lenient_ = false;  // no shape uses it: mistakes are warnings
  std::vector<Declared> components_, target_types_;
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_SPARQL_READER_H_
