#include "reasoner/explain/why_not.h"

#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/count_form.h"
#include "reasoner/explain/example_picker.h"
#include "reasoner/explain/possible_values.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::explain {
namespace {

constexpr size_t kCandidates = 500;  // partial matches of one size that are examined
constexpr size_t kTried = 100;       // sets of one size that are tried
constexpr size_t kNodes = 5000;      // sets of one size that are kept
constexpr size_t kConflicts = 16;    // of one set of changes, searched at once
constexpr size_t kSubsetsUpTo = 6;   // changes; of larger sets only subsets with one change less are tried

std::string KeyOf(const Solution& solution) {
  std::vector<std::string> parts;
  for (const MissingFact& fact : solution.missing) {
    std::string& part = parts.emplace_back();
    for (int i = 0; i < 4; ++i) absl::StrAppend(&part, fact.terms[i].bits(), ",", fact.open[i], ";");
  }
  std::sort(parts.begin(), parts.end());
  for (const AbsenceOf& of : solution.absences) {
    std::string& part = parts.emplace_back(absl::StrCat("-", reinterpret_cast<uintptr_t>(of.absence)));
    for (size_t v = 0; v < of.row.values.size(); ++v)
      absl::StrAppend(&part, ",", of.row.values[v].bits(), ",", of.row.open[v]);
  }
  return absl::StrJoin(parts, "|");
}

// The triples to assert and to withdraw, as a key.
std::string KeyOf(const Repair& repair) {
  std::vector<std::string> parts;
  const auto triple = [](const Quad& quad) {
    return absl::StrCat(quad.subject.bits(), " ", quad.predicate.bits(), " ", quad.object.bits());
  };
  for (const Quad& quad : repair.add) parts.push_back(triple(quad));
  for (const auto& withdrawn : repair.Withdrawals()) parts.push_back(absl::StrCat("-", triple(withdrawn[0])));
  std::sort(parts.begin(), parts.end());
  return absl::StrJoin(parts, "|");
}

// Number of changes of the type of a thing.
size_t KindChanges(const Repair& repair) {
  size_t changes = 0;
  for (const ToTell& tell : repair.tell)
    changes += !tell.fact.predicate.IsVariable() && tell.fact.predicate.term().lexical == kRdfType ? 1 : 0;
  for (const InTheWay& way : repair.in_the_way) {
    for (const TermQuad& quad : way.withdraw) {
      const bool itself = quad.subject == way.fact.subject && quad.object == way.fact.object;
      changes += quad.predicate.lexical == kRdfType && !itself ? 1 : 0;
    }
  }
  return changes;
}

bool Overlap(const Conflict& a, const Conflict& b) {
  return std::any_of(a.ways.begin(), a.ways.end(), [&](const Repair& way) { return b.IsHitBy(way); });
}

}  // namespace

WhyNotFinder::WhyNotFinder(Parts parts)
    : parts_(std::move(parts)),
      steps_kept_(parts_.run.cancellation == nullptr ? 0 : parts_.run.cancellation->steps_left() / 2),
      display_(parts_.prefixes),
      solver_(*parts_.version, *parts_.dictionary, parts_.functions, parts_.run,
              parts_.limits.explain_steps) {}

SolveOptions WhyNotFinder::Telling() const {
  SolveOptions options;
  options.rules = parts_.rules;
  options.tell_derived = pass_.tell_derived;
  options.tell_schema = pass_.tell_schema;
  if (pass_.tell_schema) options.rule_depth = 1;  // many axioms imply an axiom
  if (pass_.direct) options.rule_depth = 0;
  return options;
}

absl::StatusOr<bool> WhyNotFinder::MakesTrue(const std::vector<Quad>& add, const std::vector<Quad>& remove) {
  bool holds = false;
  absl::Status status = parts_.hypothesis->With(add, remove, [&](const GraphVersion& graph, const Delta&) {
    sparql::RunOptions run = parts_.run;
    run.version = &graph;
    auto answer = ask_->Ask(run);
    if (!answer.ok()) return answer.status();
    holds = *answer;
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return holds;
}

absl::StatusOr<std::vector<Conflict>> WhyNotFinder::ConflictsOn(const GraphVersion& graph, Prover& prover,
                                                                const Node& node) {
  const Root& root = roots_[node.root];
  ConflictFinder::Parts parts;
  parts.base = parts_.version;
  parts.graph = &graph;
  parts.dictionary = parts_.dictionary;
  parts.prover = &prover;
  parts.functions = parts_.functions;
  parts.run = parts_.run;
  parts.run.version = &graph;
  parts.display = &display_;
  parts.telling = Telling();
  parts.room = parts_.limits.explain_changes - static_cast<int>(node.repair.size());
  parts.steps = parts_.limits.explain_steps - std::min(parts_.limits.explain_steps, solver_.steps());
  ConflictFinder finder(parts);
  const size_t proving = prover.steps();
  auto conflicts = finder.Find(root.absences, root.examples, root.names, kConflicts);
  solver_.Spend(finder.steps() + prover.steps() - proving);
  if (solver_.exhausted()) LeaveOut(0);
  return conflicts;
}

// True if the changes make the condition true; else gives the conflicts of the root's match.
absl::StatusOr<WhyNotFinder::Trial> WhyNotFinder::Try(const Node& node) {
  Trial trial;
  const auto look = [&](const GraphVersion& graph, const Delta&) {
    sparql::RunOptions run = parts_.run;
    run.version = &graph;
    auto answer = ask_->Ask(run);
    if (!answer.ok()) return answer.status();
    trial.holds = *answer;
    if (trial.holds || roots_[node.root].absences.empty()) return absl::OkStatus();
    Prover prover(graph, *parts_.dictionary, *parts_.rules, parts_.functions, run, parts_.limits,
                  parts_.prefixes);
    auto conflicts = ConflictsOn(graph, prover, node);
    if (conflicts.ok()) trial.conflicts = *std::move(conflicts);
    return conflicts.status();
  };
  if (absl::Status status = parts_.hypothesis->With(node.repair.add, node.repair.remove, look); !status.ok())
    return status;
  return trial;
}

// Reduces the repair to a smallest proper subset of its changes that is enough. Assertions of one triple in
// several graphs count as one change.
absl::StatusOr<bool> WhyNotFinder::Minimise(Repair& repair) {
  const std::vector<std::vector<Quad>> removals = repair.Withdrawals();
  const size_t told = repair.add.size();
  const size_t count = told + removals.size();
  const uint32_t full = (1u << count) - 1;
  std::vector<uint32_t> subsets;
  for (uint32_t subset = 1; subset < full; ++subset) {
    if (count <= kSubsetsUpTo || static_cast<size_t>(__builtin_popcount(subset)) + 1 == count)
      subsets.push_back(subset);
  }
  std::stable_sort(subsets.begin(), subsets.end(),
                   [](uint32_t a, uint32_t b) { return __builtin_popcount(a) < __builtin_popcount(b); });
  for (const uint32_t subset : subsets) {
    std::vector<Quad> add, remove;
    for (size_t i = 0; i < count; ++i) {
      if ((subset >> i & 1) == 0) continue;
      if (i < told) {
        add.push_back(repair.add[i]);
      } else {
        remove.insert(remove.end(), removals[i - told].begin(), removals[i - told].end());
      }
    }
    if (OutOfTime()) return false;
    auto holds = MakesTrue(add, remove);
    if (!holds.ok()) return holds.status();
    if (!*holds) continue;
    Repair less;
    for (size_t i = 0; i < told; ++i) {
      if ((subset >> i & 1) != 0) less.tell.push_back(repair.tell[i]);
    }
    for (InTheWay way : repair.in_the_way) {
      std::erase_if(way.withdraw, [&](const TermQuad& quad) {
        return std::none_of(remove.begin(), remove.end(), [&](const Quad& kept) {
          return parts_.dictionary->Decode(kept.subject) == quad.subject &&
                 parts_.dictionary->Decode(kept.predicate) == quad.predicate &&
                 parts_.dictionary->Decode(kept.object) == quad.object;
        });
      });
      if (!way.withdraw.empty()) less.in_the_way.push_back(std::move(way));
    }
    // conditions are about the variables of the facts to assert
    const bool open = std::any_of(less.tell.begin(), less.tell.end(), [](const ToTell& tell) {
      return tell.fact.subject.IsVariable() || tell.fact.predicate.IsVariable() ||
             tell.fact.object.IsVariable();
    });
    if (open) less.conditions = repair.conditions;
    less.add = std::move(add);
    less.remove = std::move(remove);
    repair = std::move(less);  // by another match: facts of the former one need not matter
    return Minimise(repair);
  }
  return true;
}

bool WhyNotFinder::IsState(const Term& predicate) const {
  const auto property = parts_.dictionary->Find(predicate);
  const auto type = parts_.dictionary->FindIri(kRdfType);
  const auto state = parts_.dictionary->FindIri(DocentIri("StateProperty"));
  return property && type && state && parts_.version->Count({*property, *type, *state, TermId()}) > 0;
}

// Order: fewest changes; then changes of state before changes of type; then facts that replace an existing
// value; then the order of the alternatives; then the text.
void WhyNotFinder::Rank(std::vector<Node>& nodes) const {
  using Key = std::tuple<size_t, size_t, size_t, size_t, size_t, size_t, size_t, std::string>;
  std::vector<std::pair<Key, Node>> keyed;
  for (Node& node : nodes) {
    const Repair& repair = node.repair;
    size_t fixed = 0, open = 0, withdrawn = 0;
    std::string text;
    for (const ToTell& tell : repair.tell) {
      fixed += !tell.fact.predicate.IsVariable() && IsState(tell.fact.predicate.term()) ? 0 : 1;
      open += (tell.fact.subject.IsVariable() ? 2 : 0) + (tell.fact.object.IsVariable() ? 1 : 0);
      absl::StrAppend(&text, display_.Fact(tell.fact), "\n");
    }
    for (const InTheWay& way : repair.in_the_way) {
      absl::StrAppend(&text, display_.Fact(way.fact), "\n");
      for (const TermQuad& quad : way.withdraw) {
        withdrawn += IsState(quad.predicate) ? 0 : quad.predicate.lexical == kRdfType ? 2 : 1;
        absl::StrAppend(&text, display_.Fact(quad), "\n");
      }
    }
    for (const auto& [name, value] : repair.bindings) absl::StrAppend(&text, name, display_.Of(value), "\n");
    Key key{repair.size(), KindChanges(repair),           fixed,          open, repair.inferred.size(),
            withdrawn,     roots_[node.root].alternative, std::move(text)};
    keyed.emplace_back(std::move(key), std::move(node));
  }
  std::stable_sort(keyed.begin(), keyed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  nodes.clear();
  for (auto& [key, node] : keyed) nodes.push_back(std::move(node));
}

// Partial matches with exactly this number of missing facts.
absl::Status WhyNotFinder::Gather(const Clause& clause, int missing) {
  SolveOptions options = Telling();
  options.abductive = true;
  options.missing = missing;
  // Solutions are collected first: building a repair uses the solver's filters, which cannot run during its
  // search.
  std::vector<Solution> solutions;
  absl::flat_hash_set<std::string> keys;
  absl::Status status = solver_.Solve(clause, {}, options, [&](const Solution& solution) {
    if (keys.insert(KeyOf(solution)).second) solutions.push_back(solution);
    return solutions.size() < kCandidates;
  });
  if (!status.ok()) return status;
  if (solutions.size() == kCandidates || solver_.rules_skipped()) LeaveOut(std::max(1, missing));
  if (missing == parts_.limits.explain_changes && solver_.missing_limit_reached()) LeaveOut(missing + 1);
  if (solver_.missing_in_parts() > 0) LeaveOut(solver_.missing_in_parts());
  for (const Solution& solution : solutions) {
    if (solver_.exhausted() || OutOfTime()) {
      LeaveOut(0);
      break;
    }
    if (status = Plant(solution); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// Makes a root of a partial match, if its missing facts can be tried.
absl::Status WhyNotFinder::Plant(const Solution& solution) {
  Dictionary& dictionary = *parts_.dictionary;
  const auto examples = ExamplePicker(*parts_.version, dictionary, solver_).Pick(solution);
  if (!examples) {
    LeaveOut(std::max(1, static_cast<int>(solution.missing.size())));  // other values might work
    return absl::OkStatus();
  }
  Node node{roots_.size(), {}};
  Repair& repair = node.repair;
  const auto alternative = static_cast<size_t>(solution.row.clause - clauses_.data());
  Root root{alternative, solution.absences, *examples, DistinctNames(solution), {}};
  if (!AddMissing(solution, root.examples, root.names, *parts_.version, dictionary, display_, repair))
    return absl::OkStatus();
  for (const Quad& quad : solution.facts) {
    TermQuad fact{dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                  dictionary.Decode(quad.object), Term()};
    if (std::find(repair.holds.begin(), repair.holds.end(), fact) == repair.holds.end())
      repair.holds.push_back(std::move(fact));
  }
  for (const Inference& inference : solution.inferences) {
    repair.inferred.emplace_back(parts_.rules->rules()[inference.rule].label,
                                 PatternOf(inference.fact, dictionary, root.names));
  }
  const Clause& clause = *solution.row.clause;
  for (size_t v = 0; v < clause.names.size(); ++v) {
    if (clause.written[v].empty() || solution.row.values[v].IsNone()) continue;
    repair.bindings.emplace_back(clause.written[v], dictionary.Decode(solution.row.values[v]));
  }
  for (const AbsenceOf& of : solution.absences) {
    if (!of.open) continue;
    repair.conditions.push_back(
        absl::StrCat("there is no ", AbsenceText(*of.absence, of.row, root.names, dictionary, display_)));
  }
  roots_.push_back(std::move(root));
  if (!repair.add.empty()) {
    Push(std::move(node));
    return absl::OkStatus();
  }
  // no fact is missing: it is known that the condition does not hold
  auto conflicts = ConflictsOn(*parts_.version, *parts_.prover, node);
  if (conflicts.ok()) Expand(node, *conflicts);
  return conflicts.status();
}

// A conflict of the root that no change of the node breaks.
const Conflict* WhyNotFinder::Unhit(const Node& node) const {
  const std::vector<Conflict>& conflicts = roots_[node.root].conflicts;
  const auto found = std::find_if(conflicts.begin(), conflicts.end(),
                                  [&](const Conflict& conflict) { return !conflict.IsHitBy(node.repair); });
  return found == conflicts.end() ? nullptr : &*found;
}

// A lower bound of the size of sets that hit all known conflicts of the root: conflicts without a common way
// each need a change of their own.
int WhyNotFinder::AtLeast(const Node& node) const {
  std::vector<const Conflict*> apart;
  for (const Conflict& conflict : roots_[node.root].conflicts) {
    if (conflict.IsHitBy(node.repair)) continue;
    if (std::none_of(apart.begin(), apart.end(),
                     [&](const Conflict* other) { return Overlap(conflict, *other); }))
      apart.push_back(&conflict);
  }
  return static_cast<int>(node.repair.size() + apart.size());
}

void WhyNotFinder::Push(Node node) {
  const auto size = static_cast<int>(node.repair.size());
  if (AtLeast(node) > parts_.limits.explain_changes) return LeaveOut(parts_.limits.explain_changes + 1);
  if (!pushed_.insert(absl::StrCat(node.root, " ", KeyOf(node.repair))).second) return;
  if (nodes_[size].size() >= kNodes) return LeaveOut(size);
  nodes_[size].push_back(std::move(node));
}

// Expands the node by the conflict with the fewest ways.
void WhyNotFinder::Expand(const Node& node, const std::vector<Conflict>& conflicts) {
  for (const Conflict& conflict : conflicts) {
    if (conflict.lasts) roots_[node.root].conflicts.push_back(conflict);
  }
  const auto fewest =
      std::min_element(conflicts.begin(), conflicts.end(),
                       [](const Conflict& a, const Conflict& b) { return a.ways.size() < b.ways.size(); });
  if (fewest != conflicts.end()) Expand(node, *fewest);  // else the match itself is gone
}

// The sets with one of the ways added.
void WhyNotFinder::Expand(const Node& node, const Conflict& conflict) {
  schema_skipped_ = schema_skipped_ || conflict.schema_skipped;
  if (conflict.left_out != Conflict::kNothing)
    LeaveOut(static_cast<int>(node.repair.size()) + conflict.left_out);
  for (const Repair& way : conflict.ways) {
    Node child = node;
    if (Join(way, child.repair)) Push(std::move(child));
  }
}

bool WhyNotFinder::IsNew(const Repair& repair) {
  return seen_.insert(KeyOf(repair)).second;
}

// Tries one set of changes. `expand`: larger sets are needed, too.
absl::Status WhyNotFinder::Visit(const Node& node, bool expand, std::vector<Repair>& found) {
  auto trial = Try(node);
  if (!trial.ok()) return trial.status();
  if (!trial->holds) {
    const bool by_example =
        std::any_of(node.repair.tell.begin(), node.repair.tell.end(), [](const ToTell& tell) {
          return tell.fact.subject.IsVariable() || tell.fact.predicate.IsVariable() ||
                 tell.fact.object.IsVariable();
        });
    if (by_example) LeaveOut(static_cast<int>(node.repair.size()));  // other values might work
    if (expand) Expand(node, trial->conflicts);
    return absl::OkStatus();
  }
  Repair repair = node.repair;
  const absl::StatusOr<bool> minimal = Minimise(repair);
  if (!minimal.ok()) return minimal.status();
  if (!*minimal) {
    LeaveOut(0);
    return absl::OkStatus();
  }
  if (!IsNew(repair)) return absl::OkStatus();
  const absl::StatusOr<bool> may_be = MayBe(repair);
  if (!may_be.ok()) return may_be.status();
  if (*may_be)
    found.push_back(std::move(repair));
  else
    ++forbidden_;
  return absl::OkStatus();
}

absl::StatusOr<bool> WhyNotFinder::MayBe(const Repair& repair) const {
  if (!HasPossibleValues(repair, *parts_.version, *parts_.dictionary)) return false;
  if (!parts_.may_change) return true;
  std::vector<TermQuad> add, remove;
  for (const ToTell& tell : repair.tell) add.push_back(tell.example);
  for (const InTheWay& way : repair.in_the_way)
    remove.insert(remove.end(), way.withdraw.begin(), way.withdraw.end());
  return parts_.may_change(add, remove);
}

absl::Status WhyNotFinder::SearchSize(int size, size_t sets, WhyNotAnswer& answer) {
  for (const Clause& clause : clauses_) {
    if (absl::Status status = Gather(clause, size); !status.ok()) return status;
  }
  std::vector<Node> nodes = std::move(nodes_[size]);
  Rank(nodes);
  std::vector<Repair> found;
  size_t tried = 0;
  for (const Node& node : nodes) {
    if (!found.empty() && KindChanges(node.repair) > KindChanges(found[0])) break;
    if (const Conflict* unhit = Unhit(node); unhit != nullptr) {
      if (found.empty()) Expand(node, *unhit);
      continue;
    }
    if (++tried > kTried) {
      LeaveOut(size);
      break;
    }
    if (absl::Status status = Visit(node, found.empty(), found); !status.ok()) return status;
    if (solver_.exhausted() || OutOfTime()) {
      LeaveOut(0);
      break;
    }
  }
  // one change less than a found set is smaller than the size in progress
  size_t smallest = static_cast<size_t>(size);
  for (const Repair& repair : found) smallest = std::min(smallest, repair.size());
  std::erase_if(found, [&](const Repair& repair) { return repair.size() > smallest; });
  answer.more = found.size() - std::min(found.size(), sets);
  found.resize(std::min(found.size(), sets));
  answer.repairs = std::move(found);
  return absl::OkStatus();
}

absl::Status WhyNotFinder::Search(const Pass& pass, size_t sets, WhyNotAnswer& answer) {
  const int most = parts_.limits.explain_changes;
  pass_ = pass;
  roots_.clear();
  pushed_.clear();
  nodes_.assign(static_cast<size_t>(most) + 1, {});
  for (int size = 0; size <= most && answer.repairs.empty() && !solver_.exhausted() && !OutOfTime(); ++size) {
    if (absl::Status status = SearchSize(size, sets, answer); !status.ok()) return status;
  }
  schema_skipped_ = schema_skipped_ || solver_.schema_skipped();
  return absl::OkStatus();
}

absl::StatusOr<WhyNotAnswer> WhyNotFinder::Find(const sparql::Query& ask, size_t sets) {
  sparql::PrepareOptions prepare;
  prepare.functions = parts_.functions;
  prepare.default_graph =
      parts_.default_graph.IsNone() ? sparql::DefaultGraph::kUnion : sparql::DefaultGraph::kStrict;
  auto prepared = sparql::PreparedQuery::Prepare(ask, *parts_.dictionary, prepare);
  if (!prepared.ok()) return prepared.status();
  ask_ = *std::move(prepared);
  const sparql::Algebra& where = matching::WithoutModifiers(*ask.algebra);
  const sparql::AlgebraPtr written = WithoutCounts(where);
  auto clauses =
      ToClauses(written ? *written : where, *parts_.dictionary, parts_.default_graph, PathForm::kWithGap);
  if (!clauses.ok()) return clauses.status();
  clauses_ = *std::move(clauses);

  WhyNotAnswer answer;
  // Facts about things come before axioms, whatever the number: one axiom makes many facts true.
  for (const Pass pass : {Pass{false, false}, Pass{true, false}, Pass{true, false, true}, Pass{false, true},
                          Pass{true, true}}) {
    if (!answer.repairs.empty() || (pass.tell_schema && !schema_skipped_)) break;
    if (OutOfTime()) {
      LeaveOut(0);
      break;
    }
    if (solver_.exhausted()) solver_.Refresh();
    if (absl::Status status = Search(pass, sets, answer); !status.ok()) return status;
    if (solver_.exhausted()) LeaveOut(0);
  }
  answer.whole = answer.repairs.empty()
                     ? left_out_ == Conflict::kNothing
                     : answer.repairs.back().size() < static_cast<size_t>(std::max(left_out_, 0));
  answer.forbidden = forbidden_;
  if (solver_.failed_part() != nullptr && answer.repairs.empty()) {
    answer.failed_part = display_.Pattern(*InItsGraph(*solver_.failed_part(), *parts_.dictionary, "g"), {});
  }
  return answer;
}

}  // namespace docent::explain
