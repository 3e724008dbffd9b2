// A prepared pattern for repeated evaluation: the body of a rule, or a standing condition.
//
// It lists its triggers (the patterns of changed quads that can matter, in index form) and
// evaluates itself with some of its columns bound. Most bodies are *flat*, a conjunction of
// triple patterns with filters. These are joined here, on ids, by index nested loops in the
// order of exact counts, and comparisons with a number reject before the join. Every other
// body goes through the SPARQL evaluator, prepared once for each set of bound columns.
//
// Patterns match the union of all graphs; a triple in two graphs is one match. Writer
// thread only. Not re-entrant: the visitor of Evaluate must not call Evaluate of the same
// body.
#ifndef DOCENT_REASONER_MATCHING_BODY_H_
#define DOCENT_REASONER_MATCHING_BODY_H_

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"
#include "reasoner/matching/pattern_index.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::matching {

// A triple pattern of a body, in ids and columns.
struct Trigger {
  static constexpr int kNoColumn = -1;
  MatchPattern match;  // constants of the query; a guard if a filter compares its object with a number
  // For subject, predicate, object, graph: the column that a matching quad binds; kNoColumn for a constant
  // and for a variable that must not be bound from here.
  std::array<int16_t, 4> columns = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};
  Polarity polarity = Polarity::kPositive;
  bool required = false;  // every solution contains a match
  // The number of this pattern in a flat body (see Body::flat); -1 inside EXISTS and NOT EXISTS.
  int8_t pattern = -1;
  // In a flat body without filters: the patterns left after its match. The pattern, kNothing or kMore.
  int8_t rest = kMore;
  static constexpr int8_t kNothing = -1, kMore = -2;
  // The only pattern of a NOT EXISTS among a flat body's filters: a match rules the solution out.
  bool rejects = false;
};

// ?a < 5, 5 <= ?a, ?a >= ?b: a comparison that may be decided on ids.
struct NumberTest {
  int16_t left = 0;  // column
  Comparison op = Comparison::kLess;
  int16_t right = Trigger::kNoColumn;  // column, or
  TermId constant;                     // a number
};

// nullopt if a column is open or ids cannot decide.
std::optional<bool> TestNumbers(const NumberTest& test, absl::Span<const TermId> row);

class Body {
 public:
  struct Column {
    std::string name;       // of the variable, without "?"
    bool visible = true;    // false: made by the parser for a blank node
    bool seedable = false;  // a seed may bind it; otherwise its value in a seed is ignored
    // Bound in every solution. For a column that is seedable but not certain (from one branch of a UNION), a
    // seed also finds solutions that leave it open, and shows the seed's value in them: good for "is there
    // one?", not for "which?".
    bool certain = false;
  };

  // Compiles `query`: its WHERE (without Project, Distinct, Reduced and OrderBy around it) and its dataset.
  // Interns all constants. Errors as of PreparedQuery::Prepare. `dictionary` and `functions` (may be null)
  // must outlive it.
  static absl::StatusOr<std::unique_ptr<Body>> Compile(const sparql::Query& query, Dictionary& dictionary,
                                                       const sparql::FunctionRegistry* functions);
  ~Body();

  const std::vector<Column>& columns() const { return columns_; }
  // -1 if there is none.
  int ColumnOf(const std::string& name) const;
  // Makes a column invisible.
  void Hide(int column) { columns_[static_cast<size_t>(column)].visible = false; }
  const std::vector<Trigger>& triggers() const { return triggers_; }
  bool is_volatile() const { return is_volatile_; }
  // A conjunction of patterns() with filters around it.
  bool flat() const { return !patterns_.empty(); }
  bool has_filters() const { return has_filters_; }
  // True if all variables of the filters occur in these patterns (a bit set) of a flat body.
  bool FiltersDecidedBy(uint32_t patterns) const;
  // A pattern of a flat body: constants, and columns (kNoColumn for a constant).
  struct Pattern {
    std::array<TermId, 3> constants;
    std::array<int16_t, 3> columns;
  };
  const std::vector<Pattern>& patterns() const { return patterns_; }

  // The seed from `quad`, which matches `trigger`; kNone in the columns that stay open.
  void SeedFrom(const Trigger& trigger, const Quad& quad, std::vector<TermId>& seed) const;
  // The pattern of quads that matter to the solution `row` through `trigger`.
  MatchPattern Instantiate(const Trigger& trigger, absl::Span<const TermId> row) const;
  // The constants of that pattern.
  static QuadPattern ConstantsOf(const Trigger& trigger, absl::Span<const TermId> row) {
    const auto at = [&](int i, TermId constant) {
      return trigger.columns[i] == Trigger::kNoColumn ? constant : row[trigger.columns[i]];
    };
    const QuadPattern& own = trigger.match.constants;
    return {at(0, own.subject), at(1, own.predicate), at(2, own.object), at(3, own.graph)};
  }

  // True if a match of the trigger under `seed` rules out every solution that agrees with `seed`.
  static bool RejectsAll(const Trigger& trigger, absl::Span<const TermId> seed) {
    if (!trigger.rejects) return false;
    for (const int16_t column : trigger.columns) {
      if (column != Trigger::kNoColumn && seed[column].IsNone()) return false;
    }
    return true;
  }

  // Calls `visit` for each solution that agrees with `seed` (one id for each column, kNone if open), until it
  // returns false. A row has one id for each column; computed values are interned. Rows may repeat. `run` as
  // for PreparedQuery.
  using Visitor = absl::FunctionRef<bool(absl::Span<const TermId> row)>;
  absl::Status Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit);
  // The same for a `seed` from a quad that is in the graph and matches `trigger`: that pattern is not looked
  // up again.
  absl::Status EvaluateFrom(const Trigger& trigger, const sparql::RunOptions& run,
                            absl::Span<const TermId> seed, Visitor visit);
  // Fast path if at most one lookup decides: true if `seed` is a solution, and the only one. nullopt:
  // evaluate it.
  std::optional<bool> DecideFrom(const Trigger& trigger, const sparql::RunOptions& run,
                                 absl::Span<const TermId> seed) const;
  // The same for a flat body if the patterns in the bit set `matched` are known to match under `seed`, or
  // must not be checked: they are skipped.
  enum class Filters : uint8_t {
    kNone,
    kBound,  // those whose variables are all bound in the row
    kAll,
  };
  absl::Status EvaluateRest(const sparql::RunOptions& run, absl::Span<const TermId> seed, uint32_t matched,
                            Filters filters, Visitor visit);

 private:
  friend class BodyBuilder;
  class Plan;
  class FlatPlan;
  class GeneralPlan;

  Body();
  // The pattern with the row's values.
  static QuadPattern Bind(const Pattern& pattern, absl::Span<const TermId> row);
  // `seed` with each value that `position` of `bound` has, if only that position is open.
  absl::Status ScanFor(const Pattern& pattern, const QuadPattern& bound, int position,
                       const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit);
  absl::Status EvaluateSeeded(const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit);

  std::vector<Column> columns_;
  std::vector<Trigger> triggers_;
  std::vector<NumberTest> tests_;  // necessary conditions of every solution
  bool is_volatile_ = false;
  bool has_filters_ = false;
  bool all_seedable_ = false;  // all columns are seedable
  std::vector<int16_t> filter_columns_;
  std::vector<Pattern> patterns_;  // empty: not flat
  std::unique_ptr<Plan> plan_;
  std::vector<TermId> row_;  // of the running ScanFor
};

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_BODY_H_
