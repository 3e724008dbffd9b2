// Evaluation plan of a Body. Private to this folder.
#ifndef DOCENT_REASONER_MATCHING_BODY_PLAN_H_
#define DOCENT_REASONER_MATCHING_BODY_PLAN_H_

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "reasoner/matching/body.h"

namespace docent::matching {

// ?a = ?b, ?a != <iri>: decided on ids if both are IRIs or blank nodes.
struct TermTest {
  int16_t left = 0;                    // column
  int16_t right = Trigger::kNoColumn;  // column, or
  TermId constant;
  bool equal = true;
};

// FILTER EXISTS or NOT EXISTS of one triple pattern: decided by one lookup.
struct ExistsTest {
  Body::Pattern pattern;  // kNoColumn without a constant: any value
  bool negated = false;
};

// nullopt if a column is open or holds a literal.
std::optional<bool> TestTerms(const TermTest& test, absl::Span<const TermId> row);

class Body::Plan {
 public:
  virtual ~Plan() = default;
  // As Body::Evaluate; `seed` has kNone in columns that are not seedable.
  virtual absl::Status Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                                Visitor visit) = 0;
  // As Body::EvaluateRest; only for flat plans.
  virtual absl::Status EvaluateRest(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                                    uint32_t /*matched*/, Filters /*filters*/, Visitor visit) {
    return Evaluate(run, seed, visit);
  }
};

// A conjunction of triple patterns and filters.
class Body::FlatPlan final : public Body::Plan {
 public:
  using Pattern = Body::Pattern;
  // A filter: decided on ids by `test` if possible, else by `expression`. One of the two may be missing.
  struct Filter {
    std::optional<NumberTest> test;
    std::optional<TermTest> terms;
    std::optional<ExistsTest> exists;  // no expression is needed
    sparql::ExpressionPtr source;      // prepared when first needed, if there is a test
    std::unique_ptr<sparql::PreparedExpression> expression;
    std::vector<int16_t> columns;  // of its variables
  };
  static constexpr size_t kMaxPatterns = 32;

  FlatPlan(const Dictionary& dictionary, const sparql::FunctionRegistry* functions)
      : dictionary_(dictionary), functions_(functions) {}
  // Prepares the filters that need the evaluator. `names`: the columns.
  absl::Status Build(std::vector<Pattern> patterns, std::vector<Filter> filters,
                     std::vector<std::string> names);
  absl::Status Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                        Visitor visit) override {
    return EvaluateRest(run, seed, 0, Filters::kAll, visit);
  }
  absl::Status EvaluateRest(const sparql::RunOptions& run, absl::Span<const TermId> seed, uint32_t matched,
                            Filters filters, Visitor visit) override;

 private:
  struct Run;
  uint32_t PickNext(const GraphVersion& version, uint32_t open, bool& impossible) const;
  bool Join(Run& run, uint32_t open);
  // False: a filter rejects the bound part of the row.
  bool TestBound(int16_t column) const;
  bool IsBound(const Filter& filter) const;
  bool TestSeeded(Run& run) const;
  bool Leaf(Run& run);
  bool Exists(const ExistsTest& test, const GraphVersion& version) const;
  absl::Status Prepare(Filter& filter);

  const Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  std::vector<Pattern> patterns_;
  std::vector<Filter> filters_;
  std::vector<std::string> names_;
  std::vector<TermId> row_;  // of the running evaluation
};

// The plan for all other bodies: the SPARQL evaluator.
class Body::GeneralPlan final : public Body::Plan {
 public:
  // Prepares the unseeded form at once, to report errors here. `columns` must outlive the plan.
  static absl::StatusOr<std::unique_ptr<GeneralPlan>> Make(sparql::Query query, Dictionary& dictionary,
                                                           const sparql::FunctionRegistry* functions,
                                                           const std::vector<Column>& columns);
  absl::Status Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit) override;

 private:
  struct Variant {
    std::vector<int16_t> bound;    // columns, ascending
    std::vector<int16_t> columns;  // of the prepared query's rows → ours
    std::unique_ptr<sparql::PreparedQuery> query;
  };
  GeneralPlan(sparql::Query query, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
              const std::vector<Column>& columns)
      : query_(std::move(query)), dictionary_(dictionary), functions_(functions), columns_(columns) {}
  absl::StatusOr<Variant*> VariantFor(absl::Span<const TermId> seed);

  sparql::Query query_;
  Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  const std::vector<Column>& columns_;
  std::vector<Variant> variants_;
  std::vector<TermId> row_;
};

}  // namespace docent::matching

#endif  // DOCENT_REASONER_MATCHING_BODY_PLAN_H_
