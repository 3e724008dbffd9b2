#include "reasoner/matching/body.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "graph/base/rule_limits.h"
#include "graph/base/step_costs.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "reasoner/matching/body_plan.h"
#include "reasoner/matching/comparison_form.h"

namespace docent::matching {
namespace {

using sparql::Algebra;
using sparql::Expression;
using sparql::PatternTerm;

void InternConstants(const Algebra& algebra, Dictionary& dictionary);

void InternConstants(const Expression& expression, Dictionary& dictionary) {
  if (expression.kind == Expression::Kind::kTerm) dictionary.Intern(expression.term);
  for (const auto& argument : expression.arguments) InternConstants(*argument, dictionary);
  if (expression.pattern) InternConstants(*expression.pattern, dictionary);
}

void InternConstant(const PatternTerm& term, Dictionary& dictionary) {
  if (!term.IsVariable() && !(term.term().IsIri() && term.term().lexical.empty()))
    dictionary.Intern(term.term());
}

void InternConstants(const sparql::Path& path, Dictionary& dictionary) {
  if (path.kind == sparql::Path::Kind::kIri) dictionary.Intern(path.iri);
  for (const sparql::Path& child : path.children) InternConstants(child, dictionary);
}

// Interns all constants: a prepared query keeps the ids of its constants, so they need ids before any fact
// has them.
void InternConstants(const Algebra& algebra, Dictionary& dictionary) {
  for (const sparql::TriplePattern& triple : algebra.triples) {
    InternConstant(triple.subject, dictionary);
    InternConstant(triple.predicate, dictionary);
    InternConstant(triple.object, dictionary);
  }
  InternConstant(algebra.subject, dictionary);
  InternConstant(algebra.object, dictionary);
  InternConstant(algebra.name, dictionary);
  if (algebra.kind == Algebra::Kind::kPath) InternConstants(algebra.path, dictionary);
  for (const auto& row : algebra.rows) {
    for (const auto& term : row) {
      if (term) dictionary.Intern(*term);
    }
  }
  if (algebra.expression) InternConstants(*algebra.expression, dictionary);
  for (const auto& key : algebra.group_keys) {
    if (key.expression) InternConstants(*key.expression, dictionary);
  }
  for (const auto& aggregate : algebra.aggregates) {
    if (aggregate.expression) InternConstants(*aggregate.expression, dictionary);
  }
  for (const auto& child : algebra.children) InternConstants(*child, dictionary);
}

}  // namespace

// Makes a Body from a query.
class BodyBuilder {
 public:
  BodyBuilder(Body& body, Dictionary& dictionary, const sparql::FunctionRegistry* functions)
      : body_(body), dictionary_(dictionary), functions_(functions) {}

  absl::Status Build(const sparql::Query& query) {
    const Algebra& where = WithoutModifiers(*query.algebra);
    InternConstants(where, dictionary_);
    const TriggerAnalysis analysis = AnalyseTriggers(where);
    body_.is_volatile_ = analysis.is_volatile;
    const bool plain_dataset = query.from.empty() && query.from_named.empty();
    const bool flat = plain_dataset && Flatten(where, /*outermost=*/true) && !patterns_.empty() &&
                      patterns_.size() <= Body::FlatPlan::kMaxPatterns;
    if (!flat) {
      body_.columns_.clear();
      numbers_.clear();
      for (const sparql::Variable& v : sparql::InScopeVariables(where)) {
        if (!v.IsHidden()) AddColumn(v);
      }
    }
    if (body_.columns_.size() > kRuleLimits.body_variables) {
      return absl::ResourceExhaustedError(absl::StrCat("the pattern has ", body_.columns_.size(),
                                                       " variables; the limit body_variables is ",
                                                       kRuleLimits.body_variables));
    }
    for (Body::Column& column : body_.columns_) {
      column.seedable = analysis.seedable.contains(column.name);
      column.certain = analysis.certain.contains(column.name);
    }
    body_.all_seedable_ = std::all_of(body_.columns_.begin(), body_.columns_.end(),
                                      [](const Body::Column& column) { return column.seedable; });
    CollectTests(where);
    AddTriggers(analysis);
    if (flat) NumberPatterns();
    return flat ? BuildFlat() : BuildGeneral(query, where);
  }

 private:
  // -1: none has this name.
  int16_t ColumnOf(const std::string& name) const {
    const auto known = numbers_.find(name);
    return known == numbers_.end() ? int16_t{-1} : known->second;
  }

  // Beyond the limit body_variables the number is of no use, and Build refuses the body.
  int16_t AddColumn(const sparql::Variable& variable) {
    const auto [known, is_new] =
        numbers_.try_emplace(variable.name, static_cast<int16_t>(body_.columns_.size()));
    if (is_new) body_.columns_.push_back({variable.name, !variable.IsHidden(), false});
    return known->second;
  }

  // Splits `node` into patterns_ and filters_; false if it is not a conjunction.
  bool Flatten(const Algebra& node, bool outermost) {
    switch (node.kind) {
      case Algebra::Kind::kBgp:
        for (const sparql::TriplePattern& triple : node.triples) AddPattern(triple);
        return true;
      case Algebra::Kind::kJoin:
        return std::all_of(node.children.begin(), node.children.end(),
                           [&](const auto& child) { return Flatten(*child, false); });
      case Algebra::Kind::kFilter: {
        if (!outermost) {
          // A filter of an inner group sees that group's variables only.
          const auto scope = CertainVariables(*node.children[0]);
          for (const sparql::Variable& v : sparql::MentionedVariables(*node.expression)) {
            if (!scope.contains(v.name)) return false;
          }
        }
        sparql::CollectConjuncts(*node.expression, filters_);
        return Flatten(*node.children[0], outermost);
      }
      default:
        return false;
    }
  }

  void AddPattern(const sparql::TriplePattern& triple) {
    Body::FlatPlan::Pattern pattern;
    const std::array<const PatternTerm*, 3> terms = {&triple.subject, &triple.predicate, &triple.object};
    for (int i = 0; i < 3; ++i) {
      const bool variable = terms[i]->IsVariable();
      pattern.columns[i] = variable ? AddColumn(terms[i]->variable()) : int16_t{Trigger::kNoColumn};
      pattern.constants[i] = variable ? TermId() : dictionary_.Intern(terms[i]->term());
    }
    patterns_.push_back(pattern);
  }

  std::optional<NumberTest> TestOf(const Expression& expression) const {
    const std::optional<Comparison> op = ComparisonOf(expression.kind);
    if (!op) return std::nullopt;
    const Expression& a = *expression.arguments[0];
    const Expression& b = *expression.arguments[1];
    const bool a_variable = a.kind == Expression::Kind::kVariable;
    const bool b_variable = b.kind == Expression::Kind::kVariable;
    if (!a_variable && !b_variable) return std::nullopt;
    NumberTest test{0, a_variable ? *op : Mirror(*op), Trigger::kNoColumn, TermId()};
    const int left = ColumnOf(a_variable ? a.variable.name : b.variable.name);
    if (left < 0) return std::nullopt;
    test.left = static_cast<int16_t>(left);
    if (a_variable && b_variable) {
      const int right = ColumnOf(b.variable.name);
      if (right < 0) return std::nullopt;
      test.right = static_cast<int16_t>(right);
      return test;
    }
    const Expression& other = a_variable ? b : a;
    if (other.kind != Expression::Kind::kTerm) return std::nullopt;
    test.constant = dictionary_.Intern(other.term);
    if (ViewNumber(test.constant).kind != NumberView::Kind::kNumber) return std::nullopt;
    return test;
  }

  // ?a = ?b and ?a != <iri>.
  std::optional<TermTest> TermTestOf(const Expression& expression) const {
    if (expression.kind != Expression::Kind::kEqual && expression.kind != Expression::Kind::kNotEqual) {
      return std::nullopt;
    }
    const Expression* a = expression.arguments[0].get();
    const Expression* b = expression.arguments[1].get();
    if (a->kind != Expression::Kind::kVariable) std::swap(a, b);
    if (a->kind != Expression::Kind::kVariable) return std::nullopt;
    TermTest test;
    test.equal = expression.kind == Expression::Kind::kEqual;
    test.left = static_cast<int16_t>(ColumnOf(a->variable.name));
    if (b->kind == Expression::Kind::kVariable) {
      test.right = static_cast<int16_t>(ColumnOf(b->variable.name));
      if (test.right < 0) return std::nullopt;
    } else if (b->kind == Expression::Kind::kTerm && b->term.IsIri()) {
      test.constant = dictionary_.Intern(b->term);
    } else {
      return std::nullopt;
    }
    return test.left < 0 ? std::nullopt : std::optional<TermTest>(test);
  }

  // EXISTS or NOT EXISTS of one triple pattern; each of its variables is one of the body's or occurs in it
  // once.
  std::optional<ExistsTest> ExistsTestOf(const Expression& expression) {
    const bool negated = expression.kind == Expression::Kind::kNotExists;
    if (!negated && expression.kind != Expression::Kind::kExists) return std::nullopt;
    const Algebra& inner = *expression.pattern;
    if (inner.kind != Algebra::Kind::kBgp || inner.triples.size() != 1) return std::nullopt;
    const sparql::TriplePattern& triple = inner.triples[0];
    const std::array<const PatternTerm*, 3> terms = {&triple.subject, &triple.predicate, &triple.object};
    ExistsTest test;
    test.negated = negated;
    std::vector<std::string> open;
    for (int i = 0; i < 3; ++i) {
      test.pattern.columns[i] = Trigger::kNoColumn;
      if (!terms[i]->IsVariable()) {
        test.pattern.constants[i] = dictionary_.Intern(terms[i]->term());
        continue;
      }
      const std::string& name = terms[i]->variable().name;
      test.pattern.columns[i] = static_cast<int16_t>(ColumnOf(name));
      if (test.pattern.columns[i] >= 0) continue;
      test.pattern.columns[i] = Trigger::kNoColumn;
      if (std::find(open.begin(), open.end(), name) != open.end()) return std::nullopt;
      open.push_back(name);
    }
    return test;
  }

  // Comparisons with a number in the outermost filters.
  void CollectTests(const Algebra& where) {
    for (const Algebra* node = &where; node->kind == Algebra::Kind::kFilter; node = node->children[0].get()) {
      std::vector<const Expression*> conjuncts;
      sparql::CollectConjuncts(*node->expression, conjuncts);
      for (const Expression* conjunct : conjuncts) {
        if (const auto test = TestOf(*conjunct)) body_.tests_.push_back(*test);
      }
    }
  }

  void AddTriggers(const TriggerAnalysis& analysis) {
    for (const TriggerSource& source : analysis.triggers) {
      Trigger trigger;
      trigger.polarity = source.polarity;
      trigger.required = source.required;
      const std::array<const PatternTerm*, 4> terms = {&source.pattern.subject, &source.pattern.predicate,
                                                       &source.pattern.object, &source.graph};
      QuadPattern& constants = trigger.match.constants;
      const std::array<TermId*, 4> ids = {&constants.subject, &constants.predicate, &constants.object,
                                          &constants.graph};
      for (int i = 0; i < 4; ++i) {
        if (!terms[i]->IsVariable()) {
          *ids[i] = dictionary_.Intern(terms[i]->term());
        } else if (std::find(source.seeds.begin(), source.seeds.end(), terms[i]->variable().name) !=
                   source.seeds.end()) {
          trigger.columns[i] = static_cast<int16_t>(ColumnOf(terms[i]->variable().name));
        }
      }
      trigger.match.equal = EqualPositions(terms);
      AddGuard(trigger);
      body_.triggers_.push_back(trigger);
    }
  }

  // Patterns and required triggers come from the same walk, in the same order.
  void NumberPatterns() {
    body_.patterns_ = patterns_;
    body_.has_filters_ = !filters_.empty();
    for (const Expression* filter : filters_) {
      for (const sparql::Variable& v : sparql::MentionedVariables(*filter)) {
        body_.filter_columns_.push_back(static_cast<int16_t>(ColumnOf(v.name)));
      }
    }
    int8_t next = 0;
    for (Trigger& trigger : body_.triggers_) {
      if (trigger.required) trigger.pattern = next++;
      if (trigger.pattern < 0 || !filters_.empty() || !BindsItsPattern(trigger)) continue;
      if (patterns_.size() == 1) trigger.rest = Trigger::kNothing;
      if (patterns_.size() == 2) trigger.rest = static_cast<int8_t>(1 - trigger.pattern);
    }
  }

  // True if a quad that matches the trigger may always bind all variables of its pattern.
  bool BindsItsPattern(const Trigger& trigger) const {
    const auto& columns = patterns_[static_cast<size_t>(trigger.pattern)].columns;
    for (size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] == Trigger::kNoColumn) continue;
      const Body::Column& column = body_.columns_[static_cast<size_t>(columns[i])];
      if (trigger.columns[i] != columns[i] || !column.seedable || !column.certain) return false;
    }
    return true;
  }

  // Marks the triggers that match the pattern of a NOT EXISTS in the outermost filters with the same
  // variables bound.
  void MarkRejecting(const Body::Pattern& pattern) {
    for (Trigger& trigger : body_.triggers_) {
      const QuadPattern& own = trigger.match.constants;
      const std::array<TermId, 3> constants = {own.subject, own.predicate, own.object};
      if (trigger.polarity == Polarity::kNegative && trigger.match.equal == 0 && own.graph.IsNone() &&
          constants == pattern.constants &&
          std::equal(pattern.columns.begin(), pattern.columns.end(), trigger.columns.begin())) {
        trigger.rejects = true;
      }
    }
  }

  static uint8_t EqualPositions(const std::array<const PatternTerm*, 4>& terms) {
    static constexpr std::array<std::array<int, 3>, 6> kPairs = {{{0, 1, MatchPattern::kSubjectPredicate},
                                                                  {0, 2, MatchPattern::kSubjectObject},
                                                                  {1, 2, MatchPattern::kPredicateObject},
                                                                  {0, 3, MatchPattern::kSubjectGraph},
                                                                  {1, 3, MatchPattern::kPredicateGraph},
                                                                  {2, 3, MatchPattern::kObjectGraph}}};
    uint8_t equal = 0;
    for (const auto& [a, b, flag] : kPairs) {
      if (terms[a]->IsVariable() && *terms[a] == *terms[b]) equal |= static_cast<uint8_t>(flag);
    }
    return equal;
  }

  void AddGuard(Trigger& trigger) const {
    if (trigger.columns[2] == Trigger::kNoColumn) return;
    for (const NumberTest& test : body_.tests_) {
      if (test.left != trigger.columns[2] || test.right != Trigger::kNoColumn) continue;
      trigger.match.object_guard = NumberGuard{test.op, ViewNumber(test.constant).value};
      return;
    }
  }

  absl::Status BuildFlat() {
    std::vector<Body::FlatPlan::Filter> filters;
    for (const Expression* conjunct : filters_) {
      Body::FlatPlan::Filter filter;
      filter.test = TestOf(*conjunct);
      filter.terms = TermTestOf(*conjunct);
      filter.exists = ExistsTestOf(*conjunct);
      if (filter.exists && filter.exists->negated) MarkRejecting(filter.exists->pattern);
      filter.source = conjunct->Clone();
      for (const sparql::Variable& v : sparql::MentionedVariables(*conjunct)) {
        filter.columns.push_back(static_cast<int16_t>(ColumnOf(v.name)));
      }
      filters.push_back(std::move(filter));
    }
    std::vector<std::string> names;
    for (const Body::Column& column : body_.columns_) names.push_back(column.name);
    auto plan = std::make_unique<Body::FlatPlan>(dictionary_, functions_);
    absl::Status status = plan->Build(std::move(patterns_), std::move(filters), std::move(names));
    body_.plan_ = std::move(plan);
    return status;
  }

  absl::Status BuildGeneral(const sparql::Query& query, const Algebra& where) {
    sparql::Query ask;
    ask.form = sparql::Query::Form::kAsk;
    ask.from = query.from;
    ask.from_named = query.from_named;
    ask.algebra = where.Clone();
    auto plan = Body::GeneralPlan::Make(std::move(ask), dictionary_, functions_, body_.columns_);
    if (!plan.ok()) return plan.status();
    body_.plan_ = *std::move(plan);
    return absl::OkStatus();
  }

  Body& body_;
  Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  absl::flat_hash_map<std::string, int16_t> numbers_;  // of columns, by name
  std::vector<Body::FlatPlan::Pattern> patterns_;
  std::vector<const Expression*> filters_;
};

std::optional<bool> TestNumbers(const NumberTest& test, absl::Span<const TermId> row) {
  const TermId left = row[test.left];
  const TermId right = test.right == Trigger::kNoColumn ? test.constant : row[test.right];
  if (left.IsNone() || right.IsNone()) return std::nullopt;
  return CompareNumbers(left, test.op, right);
}

Body::Body() = default;
Body::~Body() = default;

absl::StatusOr<std::unique_ptr<Body>> Body::Compile(const sparql::Query& query, Dictionary& dictionary,
                                                    const sparql::FunctionRegistry* functions) {
  std::unique_ptr<Body> body(new Body());
  if (absl::Status status = BodyBuilder(*body, dictionary, functions).Build(query); !status.ok())
    return status;
  return body;
}

int Body::ColumnOf(const std::string& name) const {
  for (size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

void Body::SeedFrom(const Trigger& trigger, const Quad& quad, std::vector<TermId>& seed) const {
  seed.assign(columns_.size(), TermId());
  const std::array<TermId, 4> terms = {quad.subject, quad.predicate, quad.object, quad.graph};
  for (int i = 0; i < 4; ++i) {
    if (trigger.columns[i] != Trigger::kNoColumn) seed[trigger.columns[i]] = terms[i];
  }
}

MatchPattern Body::Instantiate(const Trigger& trigger, absl::Span<const TermId> row) const {
  MatchPattern match = trigger.match;
  match.constants = ConstantsOf(trigger, row);
  if (!match.constants.object.IsNone()) match.object_guard.reset();
  return match;
}

absl::Status Body::Evaluate(const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit) {
  if (all_seedable_) return EvaluateSeeded(run, seed, visit);
  bool ignored = false;
  for (size_t i = 0; i < columns_.size(); ++i)
    ignored = ignored || (!seed[i].IsNone() && !columns_[i].seedable);
  if (!ignored) return EvaluateSeeded(run, seed, visit);
  std::vector<TermId> usable(seed.begin(), seed.end());
  for (size_t i = 0; i < columns_.size(); ++i) {
    if (!columns_[i].seedable) usable[i] = TermId();
  }
  return EvaluateSeeded(run, usable, visit);
}

QuadPattern Body::Bind(const Pattern& pattern, absl::Span<const TermId> row) {
  const auto at = [&](size_t i) {
    return pattern.columns[i] == Trigger::kNoColumn ? pattern.constants[i]
                                                    : row[static_cast<size_t>(pattern.columns[i])];
  };
  return {at(0), at(1), at(2), TermId()};
}

std::optional<bool> Body::DecideFrom(const Trigger& trigger, const sparql::RunOptions& run,
                                     absl::Span<const TermId> seed) const {
  if (trigger.rest == Trigger::kMore) return std::nullopt;
  const bool alone = trigger.rest == Trigger::kNothing;
  const QuadPattern bound = Bind(patterns_[alone ? 0 : static_cast<size_t>(trigger.rest)], seed);
  if (bound.subject.IsNone() || bound.predicate.IsNone() || bound.object.IsNone()) return std::nullopt;
  if (alone) return true;
  if (run.cancellation != nullptr) run.cancellation->Spend(kStepsOfLookup);
  return run.version->ContainsMatch(bound);
}

absl::Status Body::EvaluateFrom(const Trigger& trigger, const sparql::RunOptions& run,
                                absl::Span<const TermId> seed, Visitor visit) {
  if (const std::optional<bool> decided = DecideFrom(trigger, run, seed)) {
    if (*decided) visit(seed);
    return run.cancellation == nullptr ? absl::OkStatus() : run.cancellation->Check();
  }
  if (!flat() || trigger.pattern < 0) return Evaluate(run, seed, visit);
  for (const int16_t column : patterns_[static_cast<size_t>(trigger.pattern)].columns) {
    if (column != Trigger::kNoColumn && seed[column].IsNone()) return Evaluate(run, seed, visit);
  }
  if (trigger.rest >= 0) {
    const Pattern& rest = patterns_[static_cast<size_t>(trigger.rest)];
    const QuadPattern bound = Bind(rest, seed);
    const unsigned open = (bound.subject.IsNone() ? 1u : 0u) | (bound.predicate.IsNone() ? 2u : 0u) |
                          (bound.object.IsNone() ? 4u : 0u);
    if (std::has_single_bit(open)) return ScanFor(rest, bound, std::countr_zero(open), run, seed, visit);
  }
  for (const NumberTest& test : tests_) {
    if (TestNumbers(test, seed) == std::optional<bool>(false)) return absl::OkStatus();
  }
  return plan_->EvaluateRest(run, seed, uint32_t{1} << trigger.pattern, Filters::kAll, visit);
}

absl::Status Body::ScanFor(const Pattern& pattern, const QuadPattern& bound, int position,
                           const sparql::RunOptions& run, absl::Span<const TermId> seed, Visitor visit) {
  row_.assign(seed.begin(), seed.end());
  TermId& value = row_[static_cast<size_t>(pattern.columns[static_cast<size_t>(position)])];
  if (run.cancellation != nullptr) run.cancellation->Spend(kStepsOfLookup);
  for (QuadCursor c = run.version->Scan(bound); c.Valid(); c.NextTriple()) {
    if (run.cancellation != nullptr) {
      run.cancellation->Spend(1);
      if (absl::Status status = run.cancellation->Check(); !status.ok()) return status;
    }
    value = c.term(position);
    if (!visit(row_)) break;
  }
  return absl::OkStatus();
}

bool Body::FiltersDecidedBy(uint32_t patterns) const {
  return std::all_of(filter_columns_.begin(), filter_columns_.end(), [&](int16_t column) {
    for (size_t i = 0; i < patterns_.size(); ++i) {
      const auto& columns = patterns_[i].columns;
      if ((patterns & (1u << i)) && std::find(columns.begin(), columns.end(), column) != columns.end() &&
          column != Trigger::kNoColumn) {
        return true;
      }
    }
    return false;
  });
}

absl::Status Body::EvaluateRest(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                                uint32_t matched, Filters filters, Visitor visit) {
  return plan_->EvaluateRest(run, seed, matched, filters, visit);
}

absl::Status Body::EvaluateSeeded(const sparql::RunOptions& run, absl::Span<const TermId> seed,
                                  Visitor visit) {
  for (const NumberTest& test : tests_) {
    if (TestNumbers(test, seed) == std::optional<bool>(false)) return absl::OkStatus();
  }
  return plan_->Evaluate(run, seed, visit);
}

}  // namespace docent::matching
