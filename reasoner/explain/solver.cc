#include "reasoner/explain/solver.h"

#include <algorithm>
#include <limits>

#include "absl/strings/str_cat.h"
#include "graph/base/step_costs.h"

namespace docent::explain {
namespace {

constexpr size_t kPartRows = 10000;        // of one evaluation of a part
constexpr size_t kStepsBetweenLooks = 16;  // at the clock: a step of many goals takes long

}  // namespace

Solver::Solver(const GraphVersion& version, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
               const sparql::RunOptions& run, size_t steps)
    : version_(version), dictionary_(dictionary), functions_(functions), run_(run), step_limit_(steps) {}
Solver::~Solver() = default;

std::vector<TermId> SeedOf(const Clause& clause, const Row& outer) {
  std::vector<TermId> seed(clause.names.size());
  for (size_t i = 0; i < seed.size(); ++i) {
    const int variable = outer.clause->Find(clause.names[i]);
    if (variable >= 0) seed[i] = outer.values[variable];
  }
  return seed;
}

absl::Status Solver::Solve(const Clause& clause, absl::Span<const TermId> seed, const SolveOptions& options,
                           absl::FunctionRef<bool(const Solution&)> visit) {
  options_ = options;
  visit_ = &visit;
  status_ = absl::OkStatus();
  values_.clear();
  links_.clear();
  frames_.clear();
  goals_.clear();
  pending_.clear();
  trail_.clear();
  missing_.clear();
  missing_limit_reached_ = rules_skipped_ = false;
  missing_in_parts_ = 0;
  PushFrame(clause, -1, 0, 0);
  for (size_t i = 0; i < seed.size(); ++i) {
    if (!seed[i].IsNone()) values_[i] = seed[i];
  }
  Step();
  visit_ = nullptr;
  return status_;
}

int Solver::Root(int cell) const {
  while (links_[cell] >= 0) cell = links_[cell];
  return cell;
}

TermId Solver::TermOf(const AtomTerm& term, int base) const {
  return term.variable < 0 ? term.constant : Value(base + term.variable);
}

bool Solver::Bind(int cell, TermId value) {
  const int root = Root(cell);
  if (!values_[root].IsNone()) return values_[root] == value;
  values_[root] = value;
  trail_.push_back({Undo::Kind::kValue, root});
  return true;
}

bool Solver::Alias(int a, int b) {
  a = Root(a);
  b = Root(b);
  if (a == b) return true;
  if (!values_[a].IsNone()) return Bind(b, values_[a]);
  if (!values_[b].IsNone()) return Bind(a, values_[b]);
  // the older one is kept: names of the query take precedence over names of rules
  const int newer = std::max(a, b);
  links_[newer] = std::min(a, b);
  trail_.push_back({Undo::Kind::kLink, newer});
  return true;
}

bool Solver::Unify(const AtomTerm& a, int a_base, const AtomTerm& b, int b_base) {
  if (a.variable >= 0 && b.variable >= 0) return Alias(a_base + a.variable, b_base + b.variable);
  if (a.variable >= 0) return Bind(a_base + a.variable, b.constant);
  if (b.variable >= 0) return Bind(b_base + b.variable, a.constant);
  return a.constant == b.constant;
}

bool Solver::BindQuad(const Atom& atom, int base, const Quad& quad) {
  const std::array<TermId, 4> terms = {quad.subject, quad.predicate, quad.object, quad.graph};
  for (int i = 0; i < 4; ++i) {
    if (atom.terms[i].variable >= 0 && !Bind(base + atom.terms[i].variable, terms[i])) return false;
  }
  return true;
}

void Solver::Rewind(size_t mark) {
  while (trail_.size() > mark) {
    const Undo undo = trail_.back();
    trail_.pop_back();
    switch (undo.kind) {
      case Undo::Kind::kValue:
        values_[undo.index] = TermId();
        break;
      case Undo::Kind::kLink:
        links_[undo.index] = -1;
        break;
      case Undo::Kind::kGoal:
        goals_[undo.index].done = goals_[undo.index].matched = false;
        break;
      case Undo::Kind::kPending:
        pending_[undo.index].done = false;
        break;
    }
  }
}

QuadPattern Solver::PatternOf(const Goal& goal) const {
  const int base = frames_[goal.frame].base;
  return {TermOf(goal.atom->terms[0], base), TermOf(goal.atom->terms[1], base),
          TermOf(goal.atom->terms[2], base), TermOf(goal.atom->terms[3], base)};
}

void Solver::PushFrame(const Clause& clause, int parent, int depth, uint32_t rule) {
  const int number = static_cast<int>(frames_.size());
  frames_.push_back({&clause, static_cast<int>(values_.size()), parent, depth, rule});
  values_.resize(values_.size() + clause.names.size());
  links_.resize(values_.size(), -1);
  for (const Atom& atom : clause.atoms) goals_.push_back({number, &atom, parent, false, {}, false});
  for (size_t i = 0; i < clause.tests.size(); ++i) pending_.push_back({Pending::Kind::kTest, number, i});
  for (size_t i = 0; i < clause.assignments.size(); ++i)
    pending_.push_back({Pending::Kind::kAssignment, number, i});
  for (size_t i = 0; i < clause.tables.size(); ++i) pending_.push_back({Pending::Kind::kTable, number, i});
  for (size_t i = 0; i < clause.parts.size(); ++i) pending_.push_back({Pending::Kind::kPart, number, i});
}

void Solver::PopFrame() {
  const Frame frame = frames_.back();
  frames_.pop_back();
  values_.resize(frame.base);
  links_.resize(frame.base);
  const int number = static_cast<int>(frames_.size());
  while (!goals_.empty() && goals_.back().frame == number) goals_.pop_back();
  while (!pending_.empty() && pending_.back().frame == number) pending_.pop_back();
}

// False: end the search.
bool Solver::Step() {
  if (++steps_ > step_limit_) {
    exhausted_ = true;
    return false;
  }
  if (run_.cancellation != nullptr) {
    run_.cancellation->Spend(kStepsOfLookup * (goals_.size() + 1));
    status_ = steps_ % kStepsBetweenLooks == 0 ? run_.cancellation->CheckNow() : run_.cancellation->Check();
    if (!status_.ok()) return false;
  }
  const size_t mark = Mark();
  bool go_on = true;
  if (Settle()) {
    int best = -1;
    uint64_t fewest = std::numeric_limits<uint64_t>::max();
    for (size_t i = 0; i < goals_.size(); ++i) {
      if (goals_[i].done) continue;
      const uint64_t count = version_.Count(PatternOf(goals_[i]));
      if (count < fewest) {
        fewest = count;
        best = static_cast<int>(i);
      }
    }
    int table = -1, part = -1, reached = -1;
    for (size_t i = 0; i < pending_.size(); ++i) {
      if (pending_[i].done) continue;
      if (pending_[i].kind == Pending::Kind::kTable && table < 0) table = static_cast<int>(i);
      if (pending_[i].kind == Pending::Kind::kPart && part < 0) part = static_cast<int>(i);
      if (pending_[i].kind == Pending::Kind::kPart && reached < 0 && IsReached(pending_[i]))
        reached = static_cast<int>(i);
    }
    if (table >= 0 && (best < 0 || fewest > 1)) {
      go_on = TryTable(table);
    } else if (reached >= 0 && fewest > 1) {
      go_on = TryPart(reached);
    } else if (best >= 0) {
      go_on = StepAtom(best);
    } else if (part >= 0) {
      go_on = TryPart(part);
    } else {
      go_on = Leaf();
    }
  }
  Rewind(mark);
  return go_on && status_.ok();
}

bool Solver::StepAtom(int goal) {
  const size_t mark = Mark();
  goals_[goal].done = true;
  trail_.push_back({Undo::Kind::kGoal, goal});
  bool go_on = TryMatches(goal);
  if (go_on && !missing_.empty()) go_on = TryMissingAlready(goal);
  if (go_on && options_.abductive) {
    const bool room = missing_.size() < static_cast<size_t>(options_.missing);
    missing_limit_reached_ = missing_limit_reached_ || !room;
    const bool given = IsGivenAxiom(goals_[goal]);
    schema_skipped_ = schema_skipped_ || (given && room);
    if (room && !given && IsTellable(goals_[goal])) go_on = TryMissing(goal);  // first: rules may not end
    if (go_on && !given && options_.rules != nullptr) go_on = TryRules(goal, room);
  }
  Rewind(mark);
  return go_on;
}

bool Solver::TryMatches(int goal) {
  const int base = frames_[goals_[goal].frame].base;
  const Atom& atom = *goals_[goal].atom;
  const bool any_graph = atom.terms[3].variable < 0 && atom.terms[3].constant.IsNone();
  for (QuadCursor c = version_.Scan(PatternOf(goals_[goal])); c.Valid();
       any_graph ? c.NextTriple() : c.Next()) {
    const Quad quad = c.quad();
    const size_t mark = Mark();
    bool go_on = true;
    if (BindQuad(atom, base, quad)) {
      goals_[goal].match = quad;
      if (any_graph) goals_[goal].match.graph = TermId();
      goals_[goal].matched = true;
      go_on = Step();
      goals_[goal].matched = false;
    }
    Rewind(mark);
    if (!go_on) return false;
  }
  return true;
}

bool Solver::TryTable(int pending) {
  const size_t mark = Mark();
  pending_[pending].done = true;
  trail_.push_back({Undo::Kind::kPending, pending});
  const Frame frame = frames_[pending_[pending].frame];
  const Table& table = frame.clause->tables[pending_[pending].index];
  bool go_on = true;
  for (const std::vector<TermId>& row : table.rows) {
    const size_t inner = Mark();
    bool fits = true;
    for (size_t i = 0; i < row.size() && fits; ++i) {
      fits = row[i].IsNone() || Bind(frame.base + table.variables[i], row[i]);
    }
    if (fits) go_on = Step();
    Rewind(inner);
    if (!go_on) break;
  }
  Rewind(mark);
  return go_on;
}

absl::StatusOr<std::vector<std::vector<TermId>>> Solver::RowsOf(const Part& part, int base) {
  std::vector<sparql::Variable> scope = sparql::InScopeVariables(*part.pattern);
  std::vector<int> variables = part.variables;
  if (part.graph.variable >= 0) {
    scope.push_back({std::string(kGraphOfPart)});
    variables.push_back(part.graph.variable);
  }
  std::string key = absl::StrCat(reinterpret_cast<uintptr_t>(&part));
  sparql::PrepareOptions options;
  options.functions = functions_;
  std::vector<TermId> bound;
  for (size_t i = 0; i < scope.size(); ++i) {
    const TermId value = Value(base + variables[i]);
    if (value.IsNone() || scope[i].IsHidden()) continue;
    options.bound.push_back(scope[i].name);
    bound.push_back(value);
    absl::StrAppend(&key, " ", i);
  }
  std::unique_ptr<sparql::PreparedQuery>& prepared = parts_[key];
  if (prepared == nullptr) {
    sparql::Query query;
    query.form = sparql::Query::Form::kAsk;
    query.algebra = InItsGraph(part, dictionary_, std::string(kGraphOfPart));
    auto made = sparql::PreparedQuery::Prepare(std::move(query), dictionary_, options);
    if (!made.ok()) return made.status();
    prepared = *std::move(made);
  }
  std::vector<std::vector<TermId>> rows;
  absl::Status status = prepared->Select(run_, bound, [&](absl::Span<const TermId> row) {
    std::vector<TermId>& ids = rows.emplace_back(scope.size());
    for (size_t i = 0; i < prepared->variables().size(); ++i) {
      const auto place = std::find_if(scope.begin(), scope.end(), [&](const sparql::Variable& v) {
        return v.name == prepared->variables()[i];
      });
      if (place == scope.end() || row[i].IsNone()) continue;
      TermId& id = ids[static_cast<size_t>(place - scope.begin())];
      id = row[i].tag() == TermId::Tag::kLocal ? dictionary_.Intern(prepared->Decode(row[i])) : row[i];
    }
    return rows.size() < kPartRows;
  });
  prepared->Stop();
  if (!status.ok()) return status;
  return rows;
}

// A path beside a gap with one end bound: the gap is searched from there.
bool Solver::IsReached(const Pending& pending) const {
  const Frame& frame = frames_[pending.frame];
  const Part& part = frame.clause->parts[pending.index];
  if (!options_.abductive || !part.beside_gap) return false;
  return !part.pattern->subject.IsVariable() || !part.pattern->object.IsVariable() ||
         std::any_of(part.variables.begin(), part.variables.end(),
                     [&](int v) { return !Value(frame.base + v).IsNone(); });
}

bool Solver::TryPart(int pending) {
  const size_t mark = Mark();
  pending_[pending].done = true;
  trail_.push_back({Undo::Kind::kPending, pending});
  const Frame frame = frames_[pending_[pending].frame];
  const Part& part = frame.clause->parts[pending_[pending].index];
  if (options_.abductive) {
    const bool one_gap = part.beside_gap && (missing_in_parts_ == 0 || missing_in_parts_ == 2);
    missing_in_parts_ = one_gap ? 2 : 1;
    if (part.beside_gap && !IsReached(pending_[pending])) {  // the gap could be anywhere
      missing_in_parts_ = 1;
      Rewind(mark);
      return true;
    }
  }
  auto rows = RowsOf(part, frame.base);
  bool go_on = true;
  if (!rows.ok()) {
    status_ = rows.status();
    go_on = false;
  } else if (rows->empty()) {
    if (missing_.empty()) failed_part_ = &part;
  } else {
    for (const std::vector<TermId>& row : *rows) {
      const size_t inner = Mark();
      bool fits = true;
      for (size_t i = 0; i < row.size() && fits; ++i) {
        const int variable = i < part.variables.size() ? part.variables[i] : part.graph.variable;
        fits = row[i].IsNone() || Bind(frame.base + variable, row[i]);
      }
      if (fits) go_on = Step();
      Rewind(inner);
      if (!go_on) break;
    }
  }
  Rewind(mark);
  return go_on;
}

sparql::PreparedExpression* Solver::Prepared(const sparql::Expression& e,
                                             const std::vector<std::string>& names) {
  auto& prepared = expressions_[&e];
  if (prepared == nullptr) {
    sparql::PrepareOptions options;
    options.functions = functions_;
    auto made = sparql::PreparedExpression::Prepare(e, names, dictionary_, options);
    if (!made.ok()) {
      status_ = made.status();
      return nullptr;
    }
    prepared = *std::move(made);
  }
  return prepared.get();
}

bool Solver::Holds(const Test& test, const Clause& clause, absl::Span<const TermId> values) {
  std::vector<std::string> names;
  for (int v : test.variables) names.push_back(clause.names[v]);
  sparql::PreparedExpression* prepared = Prepared(*test.expression, names);
  if (prepared == nullptr) return false;
  auto holds = prepared->Test(run_, values);
  if (!holds.ok()) status_ = holds.status();
  return holds.ok() && *holds;
}

bool Solver::Holds(const OpenTest& test, absl::Span<const TermId> values) {
  std::vector<TermId> of_test;
  for (int v : test.test->variables) of_test.push_back(values[v]);
  return Holds(*test.test, *test.row.clause, of_test);
}

// Decides the tests that the last binding made decidable. False: one does not hold.
bool Solver::Settle() {
  bool changed = true;
  while (changed) {
    changed = false;
    for (size_t i = 0; i < pending_.size(); ++i) {
      if (pending_[i].done) continue;
      const bool was = changed;
      changed = false;
      if (!SettleOne(pending_[i], changed)) return false;
      if (changed) {
        pending_[i].done = true;
        trail_.push_back({Undo::Kind::kPending, static_cast<int>(i)});
      }
      changed = changed || was;
    }
  }
  return status_.ok();
}

bool Solver::SettleOne(Pending& pending, bool& changed) {
  if (pending.kind != Pending::Kind::kTest && pending.kind != Pending::Kind::kAssignment) return true;
  const Frame& frame = frames_[pending.frame];
  const bool is_test = pending.kind == Pending::Kind::kTest;
  const std::vector<int>& variables = is_test ? frame.clause->tests[pending.index].variables
                                              : frame.clause->assignments[pending.index].variables;
  std::vector<TermId> values;
  for (int v : variables) {
    values.push_back(Value(frame.base + v));
    if (values.back().IsNone()) return true;
  }
  changed = true;
  if (is_test) return Holds(frame.clause->tests[pending.index], *frame.clause, values);
  const Assignment& assignment = frame.clause->assignments[pending.index];
  std::vector<std::string> names;
  for (int v : variables) names.push_back(frame.clause->names[v]);
  sparql::PreparedExpression* prepared = Prepared(*assignment.expression, names);
  if (prepared == nullptr) return false;
  auto value = prepared->Evaluate(run_, values);
  if (!value.ok()) {
    status_ = value.status();
    return false;
  }
  return !value->has_value() || Bind(frame.base + assignment.variable, dictionary_.Intern(**value));
}

MissingFact Solver::FactOf(const Atom& atom, int base) const {
  MissingFact fact;
  for (int i = 0; i < 4; ++i) {
    const AtomTerm& term = atom.terms[i];
    fact.terms[i] = TermOf(term, base);
    if (term.variable >= 0 && fact.terms[i].IsNone()) fact.open[i] = Root(base + term.variable);
  }
  return fact;
}

Row Solver::RowOf(const Frame& frame) const {
  Row row{frame.clause, {}, {}};
  for (size_t v = 0; v < frame.clause->names.size(); ++v) {
    const int cell = Root(frame.base + static_cast<int>(v));
    row.values.push_back(values_[cell]);
    row.open.push_back(values_[cell].IsNone() ? cell : MissingFact::kBound);
  }
  return row;
}

std::vector<AbsenceOf> Solver::Absences() const {
  std::vector<AbsenceOf> absences;
  for (const Frame& frame : frames_) {
    for (const Absence& absence : frame.clause->absences) {
      AbsenceOf& of = absences.emplace_back(AbsenceOf{&absence, RowOf(frame)});
      for (const Clause& alternative : absence.alternatives) {
        of.open = of.open || std::any_of(alternative.names.begin(), alternative.names.end(),
                                         [&](const std::string& name) {
                                           const int outer = frame.clause->Find(name);
                                           return outer >= 0 && of.row.values[outer].IsNone();
                                         });
      }
    }
  }
  return absences;
}

// True if the forbidden pattern has a match.
bool Solver::IsMatched(const AbsenceOf& of) {
  if (inner_ == nullptr) {
    inner_ = std::make_unique<Solver>(version_, dictionary_, functions_, run_, step_limit_);
  }
  bool matched = false;
  for (const Clause& alternative : of.absence->alternatives) {
    status_ = inner_->Solve(alternative, SeedOf(alternative, of.row), SolveOptions(), [&](const Solution&) {
      matched = true;
      return false;
    });
    if (matched || !status_.ok()) break;
  }
  exhausted_ = exhausted_ || inner_->exhausted();
  return matched || !status_.ok();
}

// Everything is matched, missing or left to a filter.
bool Solver::Leaf() {
  Solution solution;
  for (const int goal : missing_) {
    const MissingFact fact = FactOf(*goals_[goal].atom, frames_[goals_[goal].frame].base);
    const bool there =
        std::all_of(fact.open.begin(), fact.open.end(), [](int o) { return o == MissingFact::kBound; }) &&
        version_.Count({fact.terms[0], fact.terms[1], fact.terms[2], fact.terms[3]}) > 0;
    if (there) return true;  // bound after it was taken as missing: found with fewer changes
    const bool of_rule = frames_[goals_[goal].frame].depth > 0;  // a question may ask for forbidden facts
    if (of_rule && options_.rules->IsForbidden(PatternOf(goals_[goal]))) return true;
    if (std::find(solution.missing.begin(), solution.missing.end(), fact) == solution.missing.end()) {
      solution.missing.push_back(fact);
    }
  }
  if (solution.missing.size() != static_cast<size_t>(options_.missing)) return true;
  std::vector<AbsenceOf> absences = Absences();
  if (options_.abductive) {
    solution.absences = std::move(absences);
  } else if (std::any_of(absences.begin(), absences.end(),
                         [this](const AbsenceOf& of) { return IsMatched(of); })) {
    return status_.ok();
  }
  for (const Pending& pending : pending_) {
    if (pending.done || pending.kind != Pending::Kind::kTest) continue;
    const Frame& frame = frames_[pending.frame];
    OpenTest open{&frame.clause->tests[pending.index], RowOf(frame)};
    // These stay unbound: the filter is evaluated with unbound variables.
    if (options_.missing == 0 && !Holds(open, open.row.values)) return status_.ok();
    solution.tests.push_back(std::move(open));
  }
  solution.row = RowOf(frames_[0]);
  for (const Frame& frame : frames_) {
    for (size_t v = 0; v < frame.clause->names.size(); ++v) {
      const int cell = Root(frame.base + static_cast<int>(v));
      if (values_[cell].IsNone()) solution.names.try_emplace(cell, frame.clause->written[v]);
    }
    if (frame.parent >= 0) {
      const Goal& parent = goals_[frame.parent];
      const Inference inference{frame.rule, FactOf(*parent.atom, frames_[parent.frame].base)};
      std::erase(solution.inferences,
                 inference);  // several patterns may need it: the last is listed below all of them
      solution.inferences.push_back(inference);
    }
  }
  for (const Goal& goal : goals_) {
    if (goal.matched) solution.facts.push_back(goal.match);
  }
  return (*visit_)(solution);
}

}  // namespace docent::explain
