// State of one validation: focus nodes, value nodes, constraints (SHACL sections 3.4 and 4). Private to this
// folder; one thread.
#ifndef DOCENT_REASONER_SHAPES_EVALUATION_H_
#define DOCENT_REASONER_SHAPES_EVALUATION_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "graph/sparql/regex/regex.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/store/graph_writer.h"
#include "reasoner/shapes/validator.h"

namespace docent::shapes {

// A prepared query of a shape. Before it runs it gets values for the variables that it mentions, in this
// order: parameters, ?this, ?value, ?currentShape, ?shapesGraph.
struct PreparedShapeQuery {
  std::unique_ptr<sparql::PreparedQuery> query;
  std::vector<std::string> names;  // of these variables
  std::vector<TermId> values;
  int this_at = -1, value_at = -1, shape_at = -1;             // their places among the names
  int this_column = -1, value_column = -1, path_column = -1;  // of a result row
  int message_column = -1, failure_column = -1;
};

class Evaluation {
 public:
  Evaluation(const ShapeSet& shapes, const GraphView& data, Dictionary& dictionary,
             const ValidateOptions& options);

  absl::StatusOr<ValidationReport> Run();

 private:
  // Destination of results: a report, or only a flag (does the node conform?).
  struct Sink {
    std::vector<ValidationResult>* results = nullptr;  // null: only `any` is set
    bool any = false;
    bool done() const { return any && results == nullptr; }
  };
  // The subject of a check: one constraint of one shape, with its nodes.
  struct Place {
    const Shape& shape;
    const Constraint& constraint;
    TermId focus;
    const std::vector<TermId>& values;  // ascending
    Sink& sink;
  };

  // The focus nodes of a shape's targets (section 2.1.3), ascending.
  std::vector<TermId> FocusNodes(const Shape& shape);
  void Check(const Shape& shape, TermId focus, Sink& sink);
  bool Conforms(ShapeIndex shape, TermId node);
  void CheckConstraint(const Place& place);

  // constraint_checks.cc: one function for each group of components
  void CheckValueType(const Place& place);
  void CheckCount(const Place& place);
  void CheckRange(const Place& place);
  void CheckString(const Place& place);
  void CheckUniqueLang(const Place& place);
  void CheckEquals(const Place& place);
  void CheckDisjoint(const Place& place);
  void CheckLess(const Place& place);
  void CheckLogic(const Place& place);
  void CheckNode(const Place& place);
  void CheckProperty(const Place& place);
  void CheckQualified(const Place& place);
  void CheckClosed(const Place& place);
  void CheckOthers(const Place& place);

  // query_checks.cc: constraints and targets in SPARQL
  using Prepared = PreparedShapeQuery;
  void CheckQuery(const Place& place);
  void AddTargetsOf(const ShapeQuery& query, std::vector<TermId>* nodes);
  Prepared* Prepare(const ShapeQuery& query);
  Prepared* Start(const Place& place, TermId value);
  void SetDataset(sparql::Query* query) const;
  sparql::RunOptions RunNow(const ShapeQuery& query);
  // The name of the shapes graph, for $shapesGraph.
  TermId ShapesGraph();
  void Fail(const ShapeQuery& query, const absl::Status& status);
  void ReportRow(const Place& place, const Prepared& prepared);
  std::vector<std::pair<std::string, std::string>> GivenTexts(const Place& place) const;
  void AddOfQuery(const Place& place, ValidationResult result,
                  const std::vector<std::pair<std::string, std::string>>& values,
                  std::optional<Term> message);

  // Adds a result about `value` (kNone: about the focus node), with our message if the shape has none.
  void Report(const Place& place, TermId value, const std::string& message);
  void Add(const Place& place, ValidationResult result, const std::string& message);

  // value_paths.cc: the distinct nodes that a path reaches from `node`.
  std::vector<TermId> ValueNodes(const Path& path, TermId node);
  void Step(const Path& path, bool backwards, const std::vector<TermId>& from, std::vector<TermId>* to);
  void StepSequence(const Path& path, bool backwards, const std::vector<TermId>& from,
                    std::vector<TermId>* to);
  void StepRepeated(const Path& path, bool backwards, const std::vector<TermId>& from,
                    std::vector<TermId>* to);

  bool IsInstance(TermId node, TermId cls);
  const absl::flat_hash_set<TermId>& ClassAndSubclasses(TermId cls);
  // True if the value matches sh:pattern; also false if the evaluation must end.
  bool MatchesPattern(TermId value, const Constraint& constraint);
  TermId Id(std::string_view iri) const { return dictionary_.FindIri(iri).value_or(kAbsentTerm); }
  std::string Show(TermId id) const { return ToDisplay(dictionary_.Decode(id)); }
  std::string ShowPath(const Shape& shape) const;

  // False once the evaluation must end; status_ gives the reason.
  bool Poll();
  bool Charge(size_t bytes);

  const ShapeSet& shapes_;
  const GraphView& data_;
  Dictionary& dictionary_;
  const ValidateOptions& options_;
  const TermId type_, sub_class_of_;
  absl::Status status_;
  size_t memory_ = 0;
  ValidationReport report_;
  absl::flat_hash_set<TermId> nodes_;  // checked against a shape
  absl::flat_hash_map<std::pair<ShapeIndex, TermId>, bool> conforms_;
  std::map<TermId, absl::flat_hash_set<TermId>> classes_;
  absl::flat_hash_map<const Constraint*, std::unique_ptr<sparql::Regex>> regexes_;
  absl::flat_hash_map<const ShapeQuery*, std::unique_ptr<Prepared>> prepared_;
  std::map<const Shape*, std::vector<TermId>> of_queries_;  // targets
  // The data, and the shapes as one graph beside them; null: no query needs it.
  std::unique_ptr<GraphWriter> with_shapes_;
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_EVALUATION_H_
