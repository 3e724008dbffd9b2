#include "graph/sparql/run/evaluator.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "graph/rdf/text_bytes.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/plan/evaluation_context.h"
#include "graph/sparql/plan/lowering.h"
#include "graph/sparql/plan/planner.h"
#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/run/operators.h"

namespace docent::sparql {
namespace {

// A plan is made again when the graph has grown or shrunk by this factor: its counts are then out of date.
constexpr uint64_t kReplanFactor = 2;
constexpr uint64_t kReplanSlack = 64;  // quads by which a tiny graph may change

// Of CONSTRUCT, beside its texts: terms, and their share of a table or an array that grows.
constexpr size_t kBytesOfTriple = sizeof(TermQuad) + 64;

const Term& DefaultGraphTerm() {
  static const Term term = Term::Iri(std::string(kDefaultGraph));
  return term;
}

// The common part of PreparedQuery and PreparedExpression: slots, constants, data set, context.
class Program {
 public:
  Program(const Dictionary& dictionary, const PrepareOptions& options)
      : dictionary_(dictionary),
        strict_(options.default_graph == DefaultGraph::kStrict),
        context(dictionary, options.functions, options.memory_bytes, options.all_memory, options.memory) {
    context.cancellation = options.cancellation;
  }

  // Looks up constants that were not in the dictionary again when it has grown. True if one was
  // found.
  bool ResolveConstants(absl::Span<const Term* const> terms) {
    const bool first = context.constants.size() != terms.size();
    if (!first && unresolved_.empty()) return false;
    const size_t size = dictionary_.size();
    if (!first && size == resolved_at_) return false;
    resolved_at_ = size;
    if (first) {
      context.constants.clear();
      context.constants.reserve(terms.size());
      unresolved_.clear();
      for (size_t i = 0; i < terms.size(); ++i) {
        const std::optional<TermId> id = dictionary_.Find(*terms[i]);
        context.constants.push_back(id.value_or(kUnknownTerm));
        if (!id) unresolved_.push_back(i);
      }
      return unresolved_.size() != terms.size();
    }
    const size_t before = unresolved_.size();
    std::erase_if(unresolved_, [&](size_t i) {
      const std::optional<TermId> id = dictionary_.Find(*terms[i]);
      if (id) context.constants[i] = *id;
      return id.has_value();
    });
    return unresolved_.size() != before;
  }

  // Sets the data set's graphs, given as numbers of constants; `default_graph` is used only in strict mode.
  void SetDataset(bool is_explicit, const std::vector<int>& from, const std::vector<int>& named,
                  int default_graph, int with = -1) {
    DatasetIds& d = context.dataset;
    d.is_explicit = is_explicit;
    d.strict = strict_ || with >= 0;
    d.unnamed_graph = strict_ ? context.constants[default_graph] : TermId();
    d.default_graph = with >= 0 ? context.constants[with] : d.unnamed_graph;
    const auto set = [this](const std::vector<int>& numbers, std::vector<TermId>* ids) {
      ids->clear();
      for (const int n : numbers) {
        if (context.constants[n] != kUnknownTerm) ids->push_back(context.constants[n]);
      }
    };
    set(from, &d.default_graphs);
    set(named, &d.named_graphs);
  }

  bool SizeChangedMuch(const GraphVersion& version) const {
    const uint64_t now = version.size();
    return now > planned_size * kReplanFactor + kReplanSlack ||
           planned_size > now * kReplanFactor + kReplanSlack;
  }

 private:
  const Dictionary& dictionary_;
  const bool strict_;  // the default graph
  std::vector<size_t> unresolved_;
  size_t resolved_at_ = 0;

 public:
  EvaluationContext context;
  uint64_t planned_size = 0;
};

}  // namespace

struct PreparedQuery::Impl {
  Impl(Query&& q, const Dictionary& d, const PrepareOptions& o)
      : query(std::move(q)), dictionary(d), options(o), program(d, o) {}

  absl::Status Lower();
  absl::Status Unplan();
  absl::Status Plan(const GraphVersion& version);
  absl::Status Begin(const RunOptions& run);
  // Ends the current run, if there is one.
  void End();

  Query query;
  const Dictionary& dictionary;
  PrepareOptions options;
  Program program;
  std::vector<std::string> names;
  std::vector<int> columns;      // slots of `names`
  std::vector<int> bound_slots;  // of options.bound
  SlotSet bound;
  ConstantTerms constants;  // of the query
  std::vector<int> from, from_named;
  int default_graph = 0;
  int with = -1;
  size_t slots = 0;
  PlanNodePtr plan;
  bool lowered = false;  // `plan` is not arranged
  std::unique_ptr<Operator> root;
  std::vector<TermId> ids;  // of the current row:
  absl::Span<TermId> base, out, row;
  bool running = false;
  bool begun = false;    // the operators may hold memory of a run
  bool measure = false;  // the next plan counts rows and time
};

// Assigns slots and constants; leaves `plan` not arranged. The result is the same every time, so slots stay
// valid when it is repeated.
absl::Status PreparedQuery::Impl::Lower() {
  Lowering lowering(&program.context);
  columns.clear();
  bound_slots.clear();
  bound = SlotSet();
  from.clear();
  from_named.clear();
  columns.reserve(names.size());
  for (const std::string& name : names) columns.push_back(lowering.SlotOf(name));
  for (const std::string& name : options.bound) {
    bound_slots.push_back(lowering.SlotOf(name));
    bound.Add(bound_slots.back());
  }
  lowering.SetBound(bound);
  if (options.default_graph == DefaultGraph::kStrict) default_graph = lowering.ConstantOf(DefaultGraphTerm());
  if (query.with) with = lowering.ConstantOf(*query.with);
  for (const Term& graph : query.from) from.push_back(lowering.ConstantOf(graph));
  for (const Term& graph : query.from_named) from_named.push_back(lowering.ConstantOf(graph));
  plan = lowering.LowerQuery(*query.algebra);
  slots = lowering.slots();
  constants = lowering.TakeConstants();
  lowered = lowering.status().ok();
  return lowering.status();
}

// Returns to the lowered form, from which arranging starts.
absl::Status PreparedQuery::Impl::Unplan() {
  if (lowered) return absl::OkStatus();
  root = nullptr;
  begun = false;
  plan = nullptr;
  program.context.ForgetPlan();
  return Lower();
}

absl::Status PreparedQuery::Impl::Plan(const GraphVersion& version) {
  if (absl::Status status = Unplan(); !status.ok()) return status;
  lowered = false;
  program.planned_size = version.size();
  program.context.version = &version;
  ArrangePlan(plan, bound, program.context, {options.reorder_joins});
  if (!program.context.status.ok()) return program.context.status;
  ids.assign(2 * slots + columns.size(), TermId());
  base = absl::MakeSpan(ids.data(), slots);
  out = absl::MakeSpan(base.end(), slots);
  row = absl::MakeSpan(out.end(), columns.size());
  root = BuildOperator(*plan, {&program.context, slots, base.data(), measure});
  if (program.context.status.ok()) return absl::OkStatus();
  root = nullptr;
  return program.context.status;
}

absl::Status PreparedQuery::Impl::Begin(const RunOptions& run) {
  const bool found = program.ResolveConstants(constants);
  if (found || !root) {
    program.SetDataset(!query.from.empty() || !query.from_named.empty(), from, from_named, default_graph,
                       with);
  }
  program.context.Begin(run.version, run.cancellation, run.now_us, run.seed);
  if (!root || found || program.SizeChangedMuch(*run.version)) {
    if (absl::Status status = Plan(*run.version); !status.ok()) return status;
  } else {
    End();
  }
  begun = true;
  return absl::OkStatus();
}

void PreparedQuery::Impl::End() {
  running = false;
  if (begun) root->Forget();
  begun = false;
}

PreparedQuery::PreparedQuery(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PreparedQuery::~PreparedQuery() = default;

absl::StatusOr<std::unique_ptr<PreparedQuery>> PreparedQuery::Prepare(const Query& query,
                                                                      const Dictionary& dictionary,
                                                                      const PrepareOptions& options) {
  return Prepare(query.Clone(), dictionary, options);
}

absl::StatusOr<std::unique_ptr<PreparedQuery>> PreparedQuery::Prepare(Query&& query,
                                                                      const Dictionary& dictionary,
                                                                      const PrepareOptions& options) {
  if (!query.algebra) return absl::InvalidArgumentError("the query has errors and cannot be prepared");
  auto impl = std::make_unique<Impl>(std::move(query), dictionary, options);
  if (impl->query.form == Query::Form::kSelect) {
    impl->names.reserve(impl->query.projection.size());
    for (const Variable& v : impl->query.projection) impl->names.push_back(v.name);
  } else {
    for (const Variable* v : VariablesInScope(*impl->query.algebra)) {
      if (!v->IsHidden()) impl->names.push_back(v->name);
    }
  }
  impl->program.context.base_iri = impl->query.base_iri;
  if (absl::Status status = impl->Lower(); !status.ok()) return status;
  return std::unique_ptr<PreparedQuery>(new PreparedQuery(std::move(impl)));
}

Query::Form PreparedQuery::form() const {
  return impl_->query.form;
}
const Query& PreparedQuery::query() const {
  return impl_->query;
}
const std::vector<std::string>& PreparedQuery::variables() const {
  return impl_->names;
}

absl::Status PreparedQuery::Start(const RunOptions& run, absl::Span<const TermId> bound) {
  Impl& p = *impl_;
  p.running = false;
  if (run.version == nullptr) return absl::InvalidArgumentError("a run needs a graph version");
  if (bound.size() != p.bound_slots.size()) {
    return absl::InvalidArgumentError("the query was prepared for " + std::to_string(p.bound_slots.size()) +
                                      " bound variables, not " + std::to_string(bound.size()));
  }
  // What ends the planning is told as what ends the run: by Next and status().
  if (absl::Status status = p.Begin(run); !status.ok())
    return this->status().ok() ? status : absl::OkStatus();
  std::fill(p.base.begin(), p.base.end(), TermId());
  for (size_t i = 0; i < bound.size(); ++i) p.base[p.bound_slots[i]] = bound[i];
  p.root->Start(p.base.data());
  p.running = true;
  return absl::OkStatus();
}

bool PreparedQuery::Next() {
  Impl& p = *impl_;
  if (!p.running || !p.root->Next(p.out.data()) || !p.program.context.status.ok()) {
    p.program.context.Settle();
    p.End();
    return false;
  }
  const TermId* const out = p.out.data();
  TermId* row = p.row.data();
  for (const int column : p.columns) *row++ = out[column];
  return true;
}

void PreparedQuery::Stop() {
  impl_->End();
  impl_->program.context.Forget();
}

bool PreparedQuery::Charge(size_t bytes) {
  return impl_->program.context.Charge(bytes);
}

absl::Span<const TermId> PreparedQuery::row() const {
  return impl_->row;
}
const absl::Status& PreparedQuery::status() const {
  return impl_->program.context.status;
}
Term PreparedQuery::Decode(TermId id) const {
  return impl_->program.context.Decode(id);
}
void PreparedQuery::DecodeTo(TermId id, Term* out) const {
  impl_->program.context.DecodeTo(id, out);
}
TermId PreparedQuery::Encode(const Term& term) {
  return impl_->program.context.Encode(term);
}

absl::StatusOr<bool> PreparedQuery::Ask(const RunOptions& run, absl::Span<const TermId> bound) {
  if (absl::Status status = Start(run, bound); !status.ok()) return status;
  const bool any = Next();
  impl_->program.context.Settle();
  impl_->End();
  if (!status().ok()) return status();
  return any;
}

absl::Status PreparedQuery::Select(const RunOptions& run, absl::Span<const TermId> bound,
                                   const std::function<bool(absl::Span<const TermId> row)>& visit) {
  if (absl::Status status = Start(run, bound); !status.ok()) return status;
  while (Next()) {
    if (!visit(row())) break;
  }
  impl_->program.context.Settle();
  impl_->End();
  return status();
}

namespace {

// The label of a template's blank node in one solution. ".0" is a label of the parser (for []), others are
// the user's.
std::string TemplateLabel(const std::string& label, uint64_t solution) {
  const std::string number = std::to_string(solution);
  return label[0] == '.' ? "a" + number + "_" + label.substr(1) : "c" + number + "_" + label;
}

}  // namespace

absl::StatusOr<std::vector<TermQuad>> PreparedQuery::Construct(const RunOptions& run,
                                                               absl::Span<const TermId> bound) {
  Impl& p = *impl_;
  if (p.query.form != Query::Form::kConstruct)
    return absl::InvalidArgumentError("this is not a CONSTRUCT query");
  if (absl::Status status = Start(run, bound); !status.ok()) return status;
  std::vector<TermQuad> out;
  absl::flat_hash_set<std::vector<Term>> seen;
  absl::flat_hash_map<std::string_view, size_t> column_of;
  for (const std::string& name : p.names) column_of.emplace(name, column_of.size());
  EvaluationContext& context = p.program.context;
  for (uint64_t solution = 0; Next(); ++solution) {
    const auto instantiate = [&](const PatternTerm& t) -> std::optional<Term> {
      if (!t.IsVariable())
        return t.term().IsBlank() ? Term::Blank(TemplateLabel(t.term().lexical, solution)) : t.term();
      const auto it = column_of.find(t.variable().name);
      if (it == column_of.end() || p.row[it->second].IsNone()) return std::nullopt;
      return Decode(p.row[it->second]);
    };
    for (const TriplePattern& t : p.query.construct_template) {
      if (!context.Poll()) break;
      const std::optional<Term> s = instantiate(t.subject), r = instantiate(t.predicate),
                                o = instantiate(t.object);
      if (!s || !r || !o || s->IsLiteral() || !r->IsIri()) continue;
      const size_t text = TextBytes(*s) + TextBytes(*r) + TextBytes(*o);
      if (!context.Worked(text)) break;
      if (!seen.insert({*s, *r, *o}).second) continue;
      if (!context.Charge(2 * (kBytesOfTriple + text))) break;  // in the set, and in the answer
      out.push_back({*s, *r, *o, Term{}});
    }
  }
  if (!status().ok()) return status();
  return out;
}

std::string PreparedQuery::Explain(const GraphVersion& version) {
  Impl& p = *impl_;
  p.running = false;
  RunOptions run;
  run.version = &version;
  if (absl::Status status = p.Begin(run); !status.ok()) return std::string(status.message());
  return ExplainPlan(*p.plan, false);
}

absl::StatusOr<std::string> PreparedQuery::ExplainRun(const RunOptions& run, absl::Span<const TermId> bound) {
  Impl& p = *impl_;
  p.measure = true;
  // Making the plan anew looks at the cancellation of this run, not at that of the one before.
  p.program.context.Begin(run.version, run.cancellation, run.now_us, run.seed);
  absl::Status status = p.Unplan();
  if (status.ok()) status = Start(run, bound);
  while (status.ok() && Next()) {
    if (p.query.form == Query::Form::kAsk) break;
  }
  p.running = false;
  p.measure = false;
  if (status.ok()) status = this->status();
  std::string text = status.ok() ? ExplainPlan(*p.plan, true) : "";
  if (!status.ok()) return status;
  status = p.Unplan();
  if (!status.ok()) return status;
  return text;
}

struct PreparedExpression::Impl {
  Impl(const Dictionary& dictionary, const PrepareOptions& options)
      : program(dictionary, options), options(options) {}
  absl::Status Lower();
  absl::Status Begin(const RunOptions& run, absl::Span<const TermId> row);
  void End();

  Program program;
  PrepareOptions options;
  std::vector<std::string> variables;
  ExpressionPtr source;  // plans point into it
  PlanExpressionPtr expression;
  ConstantTerms constants;  // of `source`
  int default_graph = 0;
  SlotSet bound;
  std::vector<TermId> base;
  bool arranged = false;
};

PreparedExpression::PreparedExpression(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PreparedExpression::~PreparedExpression() = default;

absl::StatusOr<std::unique_ptr<PreparedExpression>> PreparedExpression::Prepare(
    const Expression& expression, const std::vector<std::string>& variables, const Dictionary& dictionary,
    const PrepareOptions& options) {
  auto impl = std::make_unique<Impl>(dictionary, options);
  impl->variables = variables;
  impl->source = expression.Clone();
  if (absl::Status status = impl->Lower(); !status.ok()) return status;
  return std::unique_ptr<PreparedExpression>(new PreparedExpression(std::move(impl)));
}

// The result is the same every time, as PreparedQuery's.
absl::Status PreparedExpression::Impl::Lower() {
  program.context.ForgetPlan();
  expression = nullptr;
  Lowering lowering(&program.context);
  for (const std::string& name : variables) bound.Add(lowering.SlotOf(name));
  if (options.default_graph == DefaultGraph::kStrict) default_graph = lowering.ConstantOf(DefaultGraphTerm());
  expression = lowering.LowerExpression(*source);
  constants = lowering.TakeConstants();
  base.assign(lowering.slots(), TermId());
  return lowering.status();
}

absl::Status PreparedExpression::Impl::Begin(const RunOptions& run, absl::Span<const TermId> row) {
  if (program.ResolveConstants(constants) || !arranged) program.SetDataset(false, {}, {}, default_graph);
  program.context.Begin(run.version, run.cancellation, run.now_us, run.seed);
  if (!arranged && run.version != nullptr) {
    // Counts of the first version; an EXISTS here is small.
    if (expression == nullptr) {  // an earlier run ended here
      if (absl::Status status = Lower(); !status.ok()) return status;
    }
    ArrangeExpression(*expression, bound, program.context, {options.reorder_joins});
    PrepareExpression(*expression, {&program.context, base.size(), base.data()});
    arranged = program.context.status.ok();
    if (!arranged) expression = nullptr;
    if (!arranged) return program.context.status;
  }
  std::fill(base.begin(), base.end(), TermId());
  std::copy(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(std::min(row.size(), base.size())),
            base.begin());
  return absl::OkStatus();
}

void PreparedExpression::Impl::End() {
  program.context.Settle();
  ForgetExpression(*expression);
  program.context.Forget();
}

namespace {

bool HasExists(const PlanExpression& e) {
  return e.exists != nullptr || std::any_of(e.arguments.begin(), e.arguments.end(),
                                            [](const PlanExpressionPtr& a) { return HasExists(*a); });
}

}  // namespace

absl::StatusOr<bool> PreparedExpression::Test(const RunOptions& run, absl::Span<const TermId> row) {
  if (run.version == nullptr && impl_->expression != nullptr && HasExists(*impl_->expression)) {
    return absl::InvalidArgumentError("EXISTS needs a graph version");
  }
  if (absl::Status status = impl_->Begin(run, row); !status.ok()) return status;
  const bool passes = Passes(*impl_->expression, impl_->base.data(), impl_->program.context);
  impl_->End();
  if (!impl_->program.context.status.ok()) return impl_->program.context.status;
  return passes;
}

absl::StatusOr<std::optional<Term>> PreparedExpression::Evaluate(const RunOptions& run,
                                                                 absl::Span<const TermId> row) {
  if (run.version == nullptr && impl_->expression != nullptr && HasExists(*impl_->expression)) {
    return absl::InvalidArgumentError("EXISTS needs a graph version");
  }
  if (absl::Status status = impl_->Begin(run, row); !status.ok()) return status;
  EvaluationContext& context = impl_->program.context;
  const Value value = sparql::Evaluate(*impl_->expression, impl_->base.data(), context);
  std::optional<Term> term;
  if (context.status.ok() && !value.IsError())
    term = value.id().IsNone() ? value.ToTerm() : context.Decode(value.id());
  impl_->End();
  if (!context.status.ok()) return context.status;
  return term;
}

int CompareTerms(const Term& a, const Term& b) {
  const int order = CompareForOrder(Value::OfTerm(a), Value::OfTerm(b));
  if (order != 0) return order;
  return a < b ? -1 : b < a ? 1 : 0;
}

}  // namespace docent::sparql
