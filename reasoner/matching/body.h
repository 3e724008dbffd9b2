// A pattern made ready to be asked again and again: the body of a rule, or a standing condition.
//
// It knows its triggers (which changed quads can matter to it, in index form) and evaluates itself with some
// of its columns bound. Most bodies are *flat*, a conjunction of triple patterns with filters: those are
// joined here, on ids, by index nested loops in the order of exact counts, and a comparison with a number
// rejects before anything is joined. Every other body goes through the SPARQL evaluator, prepared once for
// each set of bound columns.
//
// Patterns match the union of all graphs; a triple that stands in two graphs is one match.
// Writer thread only. Not re-entrant: while Evaluate runs, its visitor must not call Evaluate of the same
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
  MatchPattern match;  // constants of the query; the guard where a filter compares its object with a number
  // For subject, predicate, object, graph: the column that a matching quad gives a value for; kNoColumn for a
  // constant and for a variable that must not be bound from here.
  std::array<int16_t, 4> columns = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};
  Polarity polarity = Polarity::kPositive;
  bool required = false;  // every solution contains a match
  // Which of a flat body's patterns this is (see Body::flat); -1 for those inside EXISTS and NOT EXISTS.
  int8_t pattern = -1;
  // Of a flat body without filters: what is left where it has matched. The pattern, kNothing or kMore.
  int8_t rest = kMore;
  static constexpr int8_t kNothing = -1, kMore = -2;
  // It is all that a NOT EXISTS of a flat body's filters asks for: what it matches is in no solution.
  bool rejects = false;
};

// ?a < 5, 5 <= ?a, ?a >= ?b: a comparison that ids may be able to decide.
struct NumberTest {
  int16_t left = 0;  // column
  Comparison op = Comparison::kLess;
  int16_t right = Trigger::kNoColumn;  // column, or
  TermId constant;                     // a number
};

// nullopt where a column is open or ids cannot decide.
std::optional<bool> TestNumbers(const NumberTest& test, absl::Span<const TermId> row);

class Body {
 public:
  struct Column {
    std::string name;       // of the variable, without "?"
    bool visible = true;    // false: made by the parser for a blank node
    bool seedable = false;  // may be given as a seed; the others are ignored in a seed
    // Bound in every solution. A seed in a column that is seedable but not certain (of one branch of a UNION)
    // also finds solutions that leave it open, and shows it in them: good for "is there one?", not for
    // "which?".
    bool certain = false;
  };

  // Of `query`: its WHERE (Project, Distinct, Reduced and OrderBy around it left out) and its dataset.
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
  // All variables of the filters occur in these patterns (a bit set) of a flat body.
  bool FiltersDecidedBy(uint32_t patterns) const;
  // Of a flat body: constants, and columns (kNoColumn where constant).
  struct Pattern {
    std::array<TermId, 3> constants;
    std::array<int16_t, 3> columns;
  };
  const std::vector<Pattern>& patterns() const { return patterns_; }

  // The seed that `quad`, which matches `trigger`, gives: none in the columns that stay open.
  void SeedFrom(const Trigger& trigger, const Quad& quad, std::vector<TermId>& seed) const;
  // What a quad must look like to matter to the solution `row` through `trigger`.
  MatchPattern Instantiate(const Trigger& trigger, absl::Span<const TermId> row) const;
  // The constants of that.
  static QuadPattern ConstantsOf(const Trigger& trigger, absl::Span<const TermId> row) {
    const auto at = [&](int i, TermId constant) {
      return trigger.columns[i] == Trigger::kNoColumn ? constant : row[trigger.columns[i]];
    };
    const QuadPattern& own = trigger.match.constants;
    return {at(0, own.subject), at(1, own.predicate), at(2, own.object), at(3, own.graph)};
  }

  // Whether a match of the trigger under `seed` leaves no solution that agrees with `seed`.
  static bool RejectsAll(const Trigger& trigger, absl::Span<const TermId> seed) {
    if (!trigger.rejects) return false;
    for (const int16_t column : trigger.columns) {
      if (column != Trigger::kNoColumn && seed[column].IsNone()) return false;
    }
    return true;
  }

  // Calls `visit` for each solution that agrees with `seed` (one id a column, none where open), until it
  // returns false. A row has one id a column; computed values are interned. Rows may repeat. `run` as for
  // PreparedQuery.
  using Visitor = absl::FunctionRef<bool(absl::Span<const TermId> row)>;
  absl::Status Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit);
  // The same where `seed` comes from a quad that is in the graph and matches `trigger`: that is not looked up again.
  absl::Status EvaluateFrom(const Trigger& trigger, const sparql::RunOptions& run,
                            absl::Span<const TermId> seed, Visitor visit);
  // The same where one lookup at most decides: whether `seed` is a solution, and there is no other. nullopt: evaluate it.
  std::optional<bool> DecideFrom(const Trigger& trigger, const sparql::RunOptions& run,
                                 absl::Span<const TermId> seed) const;
  // The same for a flat body of which the patterns in the bit set `matched` are known to match under `seed`,
  // or are not to be asked: they are not looked at.
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
  // What it asks for with the row's values in it.
  static QuadPattern Bind(const Pattern& pattern, absl::Span<const TermId> row);
  // `seed` with each value that `position` of `bound` has, where that is all that is open.
  absl::Status ScanFor(const Pattern& pattern, const QuadPattern& bound, int position,
                       const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit);
  absl::Status EvaluateSeeded(const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit);

  std::vector<Column> columns_;
  std::vector<Trigger> triggers_;
  std::vector<NumberTest> tests_;  // necessary conditions of every solution
  bool is_volatile_ = false;
  bool has_filters_ = false;
  bool all_seedable_ = false;  // columns
  std::vector<int16_t> filter_columns_;
  std::vector<Pattern> patterns_;  // empty: not flat
  std::unique_ptr<Plan> plan_;
  std::vector<TermId> row_;  // of the running ScanFor
};

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_BODY_H_
