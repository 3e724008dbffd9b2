// Query evaluator on graph versions. A query is prepared once (variables → slots, constants → ids, operators
// built) and run many times, on any version, usually without allocation: standing conditions and rules do
// that thousands of times a second.
//
//   auto ask = PreparedQuery::Prepare(parsed.query, dictionary, {.bound = {"robot"}});
//   absl::StatusOr<bool> holds = (*ask)->Ask({.version = &version, .now_us = now}, {robot_id});
//
// One thread at a time uses a PreparedQuery; many of them may read one version and one dictionary together.
// Semantics: bottom-up as in SPARQL 1.1 section 18.6. If evaluating an operand with the bindings of the other
// is provably the same, it is an index nested loop; else operands are joined by hash.
#ifndef DOCENT_GRAPH_SPARQL_RUN_EVALUATOR_H_
#define DOCENT_GRAPH_SPARQL_RUN_EVALUATOR_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"

namespace docent {
class MemoryBudget;
class MemoryUse;
}  // namespace docent

namespace docent::sparql {

// The graphs that a pattern outside GRAPH matches, if the query has no FROM.
enum class DefaultGraph : uint8_t {
  kUnion,   // all graphs merged; a triple that stands in several counts once. GRAPH ?g ranges over all graphs
  kStrict,  // docent:default alone. GRAPH ?g ranges over all other graphs (the W3C dataset)
};

struct PrepareOptions {
  DefaultGraph default_graph = DefaultGraph::kUnion;
  // Variables that get a value in every run (initial bindings). They act as if the term were written in their
  // place in the whole WHERE (except in sub-SELECTs that do not project them).
  std::vector<std::string> bound;
  const FunctionRegistry* functions = nullptr;        // must outlive the query; null: casts and builtins only
  bool reorder_joins = true;                          // false: textual order (tests compare the two)
  size_t memory_bytes = Limits{}.query_memory_bytes;  // of hash tables, sorts, groups, computed terms
  MemoryBudget* all_memory =
      nullptr;  // counts the memory of all queries' runs; null: none; must outlive the query
  // The request's: counts plan and runs in place of the two above, and must outlive the query. Null: the two above do.
  MemoryUse* memory = nullptr;
  Cancellation* cancellation = nullptr;  // ends the preparation; null: none
};

// Settings of one run. The pointers must outlive the run.
struct RunOptions {
  const GraphVersion* version = nullptr;  // required
  Cancellation* cancellation = nullptr;   // may be null
  TimeMicros now_us = 0;                  // NOW()
  uint64_t seed = 0;                      // RAND(), UUID(), STRUUID(), BNODE()
};

class PreparedQuery {
 public:
  // UNIMPLEMENTED, with the place, for a SERVICE that ResolveServices has not replaced;
  // INVALID_ARGUMENT for an unknown function or a variable in `bound` that the query does not have.
  // `dictionary` must outlive the result; `query` need not.
  static absl::StatusOr<std::unique_ptr<PreparedQuery>> Prepare(const Query& query,
                                                                const Dictionary& dictionary,
                                                                const PrepareOptions& options = {});
  // The same without a copy of the query.
  static absl::StatusOr<std::unique_ptr<PreparedQuery>> Prepare(Query&& query, const Dictionary& dictionary,
                                                                const PrepareOptions& options = {});
  ~PreparedQuery();
  PreparedQuery(const PreparedQuery&) = delete;
  PreparedQuery& operator=(const PreparedQuery&) = delete;

  Query::Form form() const;
  const Query& query() const;
  // The names of a row's columns. SELECT: its projection. Others: all visible variables of WHERE,
  // in order of first occurrence.
  const std::vector<std::string>& variables() const;

  // Begins a run, with one value for each of `PrepareOptions::bound`, in order. Ends the run before, if any.
  absl::Status Start(const RunOptions& run, absl::Span<const TermId> bound = {});
  // Moves to the next solution of WHERE, for every query form. False: no more, or an error; see status().
  bool Next();
  // Ends the run early or late and releases its memory, computed terms too. Call it when the query is kept
  // for a later run.
  void Stop();
  // The current solution, one id for each of variables(); kNone if unbound. Valid until Next.
  absl::Span<const TermId> row() const;
  // OK; CANCELLED or DEADLINE_EXCEEDED; RESOURCE_EXHAUSTED naming the limit. After an error the rows given so
  // far are not the whole answer.
  const absl::Status& status() const;

  // Counts the caller's memory for the answer as the run's own. False: beyond a limit; status() reports it.
  bool Charge(size_t bytes);

  // The term of an id of a row. Computed values (BIND, aggregates) have TermId::Tag::kLocal and are known
  // only here, until the next Start or Stop.
  Term Decode(TermId id) const;
  // Decodes into *out and reuses its memory: faster for many rows.
  void DecodeTo(TermId id, Term* out) const;
  // The id of a term in rows: the dictionary's, an inline id, or a local one. Equal terms give equal ids.
  TermId Encode(const Term& term);

  // The whole answer in one call.
  absl::StatusOr<bool> Ask(const RunOptions& run, absl::Span<const TermId> bound = {});
  // Calls `visit(row)` for each solution until it returns false.
  absl::Status Select(const RunOptions& run, absl::Span<const TermId> bound,
                      const std::function<bool(absl::Span<const TermId> row)>& visit);
  // CONSTRUCT: the distinct triples, without graph, in order of first occurrence. Template triples that are
  // not RDF (literal as subject, unbound variable) are left out (section 16.2). Blank nodes of the template
  // get labels "c<solution>_<label>".
  absl::StatusOr<std::vector<TermQuad>> Construct(const RunOptions& run, absl::Span<const TermId> bound = {});

  // The plan as an indented tree with the estimated rows of each operator and pattern, for people. Planned on `version`.
  std::string Explain(const GraphVersion& version);
  // Runs the query to its end, and gives the plan with estimated and actual rows and the time of each
  // operator (with its children): `docent query --explain`.
  absl::StatusOr<std::string> ExplainRun(const RunOptions& run, absl::Span<const TermId> bound = {});

 private:
  struct Impl;
  explicit PreparedQuery(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// A single expression, for rule and workflow engines (a FILTER after their own join, an argument of a
// command). One thread.
class PreparedExpression {
 public:
  // `variables`: the columns of the rows. EXISTS is evaluated on the run's version.
  static absl::StatusOr<std::unique_ptr<PreparedExpression>> Prepare(
      const Expression& expression, const std::vector<std::string>& variables, const Dictionary& dictionary,
      const PrepareOptions& options = {});
  ~PreparedExpression();

  // The effective boolean value (section 17.2.2); an error in the expression is false, as in FILTER.
  absl::StatusOr<bool> Test(const RunOptions& run, absl::Span<const TermId> row);
  // The value; nullopt if the expression is an error.
  absl::StatusOr<std::optional<Term>> Evaluate(const RunOptions& run, absl::Span<const TermId> row);

 private:
  struct Impl;
  explicit PreparedExpression(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// SPARQL 1.1 ORDER BY (section 15.1) as a total order: unbound < blank < IRI < literal; literals that `<`
// compares by value, then by term. For "the first in term order" of bindings.
int CompareTerms(const Term& a, const Term& b);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_EVALUATOR_H_
