// What the nodes of a run do themselves: facts that they tell and withdraw. The turn applies them after the round, in their
// order, so that rules and conditions see them in the next round of the same turn.
#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"
#include "graph/base/run_limits.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/engine/run_stepper.h"

namespace docent::engine {
namespace {

std::string Show(const TermQuad& fact) {
  return absl::StrCat(ToDisplay(fact.subject), " ", ToDisplay(fact.predicate), " ", ToDisplay(fact.object));
}

// "told 3 facts: …" with the first of them.
std::string Summary(const char* did, size_t facts, const TermQuad* first) {
  if (facts == 0) return absl::StrCat(did, " nothing");
  return absl::StrCat(did, " ", facts, facts == 1 ? " fact: " : " facts, the first: ", Show(*first));
}

// ?x twice in one fact is one value.
bool Agrees(const cawl::Constraint& fact, const TermQuad& quad) {
  const std::pair<const cawl::Word*, const Term*> places[] = {
      {&fact.subject, &quad.subject}, {&fact.verb, &quad.predicate}, {&fact.object, &quad.object}};
  for (const auto& [word, term] : places) {
    for (const auto& [other, other_term] : places) {
      const bool same = word->kind == cawl::Word::Kind::kFree && other->kind == cawl::Word::Kind::kFree &&
                        word->name == other->name;
      if (same && *term != *other_term) return false;
    }
  }
  return true;
}

bool SameValues(const std::vector<std::string>& names, const TermBinding& a, const TermBinding& b) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    const auto one = a.find(name), other = b.find(name);
    return one == a.end() || other == b.end() ? one == a.end() && other == b.end()
                                              : one->second == other->second;
  });
}

bool Matches(const FactPattern& pattern, const TermQuad& quad) {
  return (!pattern.subject || *pattern.subject == quad.subject) &&
         (!pattern.predicate || *pattern.predicate == quad.predicate) &&
         (!pattern.object || *pattern.object == quad.object) &&
         (pattern.source.empty() || pattern.source == quad.graph.lexical);
}

}  // namespace

bool RunStepper::IsOpening(size_t index) const {
  return !flow_.nodes[index].actions.empty() && !run_.nodes[index].actions.begun;
}

// This run, or one that belongs to the same outermost run.
bool RunStepper::WroteInThisRound() const {
  return core_.writing_trees.contains(core_.RootOf(run_));
}

// The actions at="open", then the invocations, which begin in a world that has what was told. `at_once`: the condition opens
// the node in this round. True if something changed.
bool RunStepper::GoOnOpening(size_t index, bool at_once) {
  const Progress progress = DoActions(index, false);
  if (progress != Progress::kDone) return progress == Progress::kEnded;
  if (absl::Status made = MakeInvocations(index); !made.ok()) {
    NodeImpossible(index, made);
    return true;
  }
  for (size_t i = 0; i < run_.nodes[index].invocations.size(); ++i) {
    if (run_.nodes[index].invocations[i].state != WorkState::kPending) continue;  // done before
    TryDispatch(index, i, at_once && !WroteInThisRound());
    if (!GoesOn() || run_.nodes[index].state != WorkState::kRunning) return true;
  }
  SettleGuard(index);
  return true;
}

// The bindings of forEach, each with the number of the match that it comes from: of the condition's matches, times the
// solutions of assignments. Without forEach: one, of the first match. RESOURCE_EXHAUSTED: they are more than a node can have
// invocations.
absl::StatusOr<std::vector<std::pair<size_t, TermBinding>>> RunStepper::EachBinding(size_t index) const {
  const std::vector<std::string>& for_each = flow_.nodes[index].for_each;
  const std::vector<TermBinding>& matches = run_.nodes[index].actions.bindings;
  std::vector<std::pair<size_t, TermBinding>> all;
  if (for_each.empty()) return std::vector<std::pair<size_t, TermBinding>>{{0, TermBinding()}};
  for (size_t i = 0; i < matches.size(); ++i) all.emplace_back(i, matches[i]);
  if (matches.empty()) all.emplace_back(0, TermBinding());
  std::set<const std::vector<TermBinding>*> lists;
  for (const std::string& name : for_each) {
    const bool matched = !matches.empty() && matches[0].contains(name);
    const auto list = run_.actions.solutions.find(name);
    if (matched || list == run_.actions.solutions.end() || !lists.insert(list->second.get()).second) continue;
    std::vector<std::pair<size_t, TermBinding>> more;
    for (const auto& [match, binding] : all) {
      for (const TermBinding& solution : *list->second) {
        if (more.size() == kRunLimits.node_invocations) return TooManyBindings();
        more.emplace_back(match, binding).second.insert(solution.begin(), solution.end());
      }
    }
    all = std::move(more);
  }
  if (lists.empty()) return all;
  std::set<std::vector<Term>> seen;
  std::erase_if(all, [&](const auto& binding) {
    std::vector<Term> key;
    for (const std::string& name : for_each) {
      const auto value = binding.second.find(name);
      key.push_back(value == binding.second.end() ? Term() : value->second);
    }
    return !seen.insert(std::move(key)).second;
  });
  return all;
}

absl::Status RunStepper::TooManyBindings() {
  return absl::ResourceExhaustedError(absl::StrCat("ext:forEach has more than ", kRunLimits.node_invocations,
                                                   " matches; the limit node_invocations is ",
                                                   kRunLimits.node_invocations));
}

// Of what has not been done for a value before the node began again.
absl::StatusOr<std::vector<TermBinding>> RunStepper::BindingsOf(size_t index) const {
  auto all = EachBinding(index);
  if (!all.ok()) return all.status();
  std::vector<TermBinding> bindings;
  for (auto& [match, binding] : *all) {
    const bool begun = run_.nodes[index].actions.begun;
    const cawl::Node& syntax = flow_.nodes[index];
    const bool is_each = !syntax.for_each.empty();
    if (!begun && is_each && !syntax.invokes.empty() && DoneFor(index, binding, 0) != nullptr) continue;
    if (begun && is_each) AddResults(index, bindings.size(), &binding);
    bindings.push_back(std::move(binding));
  }
  return bindings;
}

// What the invocations of one value of forEach made of variables, but of those that the node's own ext:assign at="done" sets.
// `number`: of the value, in the order of EachBinding.
void RunStepper::AddResults(size_t index, size_t number, TermBinding* binding) const {
  const cawl::Node& syntax = flow_.nodes[index];
  const std::vector<InvocationState>& invocations = run_.nodes[index].invocations;
  const TermBinding value = *binding;
  for (size_t i = 0; i < syntax.invokes.size(); ++i) {
    const size_t expected = number * syntax.invokes.size() + i;
    const bool there =
        expected < invocations.size() && SameValues(syntax.for_each, invocations[expected].binding, value);
    const InvocationState* done = there ? &invocations[expected] : DoneFor(index, value, i);
    if (done == nullptr) continue;
    for (const auto& [name, result] : done->results) (*binding)[name] = result;
  }
  for (const cawl::Action& action : syntax.actions) {
    if (action.when != cawl::Action::When::kDone) continue;
    for (const cawl::Text& output : action.computed.outputs) {
      const auto own = value.find(output.value);
      if (own == value.end())
        binding->erase(output.value);
      else
        (*binding)[output.value] = own->second;
    }
  }
}

// The invocation for the binding's values of forEach that is done from before the node began again; null: none.
const InvocationState* RunStepper::DoneFor(size_t index, const TermBinding& binding, size_t invoke) const {
  for (const InvocationState& old : run_.nodes[index].invocations) {
    if (old.state == WorkState::kDone && old.invoke == invoke &&
        SameValues(flow_.nodes[index].for_each, old.binding, binding))
      return &old;
  }
  return nullptr;
}

// The matches, with those of values that are done and match no longer.
std::vector<TermBinding> RunStepper::WithDoneValues(size_t index, std::vector<TermBinding> matches) const {
  const std::vector<std::string>& names = flow_.nodes[index].for_each;
  const std::vector<InvocationState>& done = run_.nodes[index].invocations;
  if (names.empty() || done.empty() || matches.empty()) return matches;
  const bool matched = std::all_of(names.begin(), names.end(),
                                   [&](const std::string& name) { return matches.front().contains(name); });
  if (!matched) return matches;
  const auto find = [&names](std::vector<TermBinding>& in, const TermBinding& value) {
    return std::find_if(in.begin(), in.end(),
                        [&](const TermBinding& other) { return SameValues(names, other, value); });
  };
  std::vector<TermBinding> all;
  for (const InvocationState& old : done) {
    if (find(all, old.binding) != all.end()) continue;
    const auto still = find(matches, old.binding);
    all.push_back(still == matches.end() ? old.binding : *still);
  }
  for (const TermBinding& match : matches) {
    if (find(all, match) == all.end()) all.push_back(match);
  }
  return all;
}

absl::Status RunStepper::MakeInvocations(size_t index) {
  const cawl::Node& syntax = flow_.nodes[index];
  NodeState& node = run_.nodes[index];
  std::vector<InvocationState> invocations;
  node.actions.begun = true;
  auto bindings = EachBinding(index);
  if (!bindings.ok()) return bindings.status();
  const size_t count = bindings->size() * syntax.invokes.size();
  if (count > kRunLimits.node_invocations) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "it would have ", count, " invocations: ", syntax.invokes.size(), " for each of ", bindings->size(),
        " bindings; the limit node_invocations is ", kRunLimits.node_invocations));
  }
  if (count > 1) {
    if (const std::string full = core_.WhyNoNodes(count); !full.empty())
      return absl::ResourceExhaustedError(full);
  }
  core_.nodes_live += count;
  run_.counted += count;
  core_.bounds.Worked(count);
  for (auto& [match, binding] : *bindings) {
    for (size_t i = 0; i < syntax.invokes.size(); ++i) {
      if (const InvocationState* done = DoneFor(index, binding, i)) {
        invocations.push_back(*done);
        continue;
      }
      InvocationState invocation;
      invocation.invoke = i;
      invocation.binding = binding;
      if (!node.wanted_robot.empty()) invocation.binding["robot"] = Term::Iri(node.wanted_robot.value());
      invocation.attempt = node.first_attempt;
      if (node.guard && match < node.actions.bindings.size())
        invocation.match = MatchOf(node.guard->armed.ask, node.actions.bindings[match]);
      invocations.push_back(std::move(invocation));
    }
  }
  node.invocations = std::move(invocations);
  if (syntax.actions.empty() || syntax.for_each.empty()) node.actions.bindings.clear();
  return absl::OkStatus();
}

// Those at="open" or at="done" that are not done yet. kWaits: an assignment comes after what the run wrote in this round, and
// sees it in the next one; or a notification is not delivered yet. kEnded: the node has come to an end.
RunStepper::Progress RunStepper::DoActions(size_t index, bool when_done) {
  const std::vector<cawl::Action>& actions = flow_.nodes[index].actions;
  const int iteration = run_.nodes[index].iteration;
  while (true) {
    if (!run_.nodes[index].actions.awaited.empty()) return Progress::kWaits;
    const size_t next = run_.nodes[index].actions.next[when_done];
    if (next == actions.size()) return Progress::kDone;
    const cawl::Action& action = actions[next];
    const bool due = action.when == (when_done ? cawl::Action::When::kDone : cawl::Action::When::kOpen);
    if (due && action.kind == cawl::Action::Kind::kAssign && WroteInThisRound()) {
      core_.awaiting.insert(run_.id);
      return Progress::kWaits;
    }
    ++run_.nodes[index].actions.next[when_done];
    if (!due) continue;
    if (const absl::Status done = DoAction(index, action); !done.ok()) {
      NodeImpossible(index, done);
      return Progress::kEnded;
    }
    const NodeState& node = run_.nodes[index];
    if (!GoesOn() || node.state != WorkState::kRunning || node.iteration != iteration)
      return Progress::kEnded;
  }
}

absl::Status RunStepper::DoAction(size_t index, const cawl::Action& action) {
  switch (action.kind) {
    case cawl::Action::Kind::kTell:
      return Tell(index, action);
    case cawl::Action::Kind::kWithdraw:
      return Withdraw(index, action);
    case cawl::Action::Kind::kAssign:
      return Assign(index, action);
    case cawl::Action::Kind::kNotify:
      return Notify(index, action);
    case cawl::Action::Kind::kReserve:
      return Reserve(index, action);
    case cawl::Action::Kind::kRelease:
      return ReleaseReservation(index, action);
    case cawl::Action::Kind::kFail:
      return Fail(index, action);
  }
  return absl::OkStatus();
}

absl::Status RunStepper::Fail(size_t index, const cawl::Action& action) {
  const auto bindings = BindingsOf(index);
  const bool matched = bindings.ok() && !bindings->empty();
  const absl::StatusOr<std::string> reason = TextOf(action.reason, matched ? &bindings->front() : nullptr);
  return reason.ok() ? absl::FailedPreconditionError(*reason) : reason.status();
}

// Those at="failure", of a node that has failed for good. What of them cannot be: why, for people.
std::string RunStepper::DoOnFailure(size_t index) {
  std::string faults;
  for (const cawl::Action& action : flow_.nodes[index].actions) {
    if (action.when != cawl::Action::When::kFailure) continue;
    if (const absl::Status done = DoAction(index, action); !done.ok())
      absl::StrAppend(&faults, "; at=\"failure\": ", done.message());
  }
  return faults;
}

// Whether so many facts more may be written in this turn. What a turn writes may start other runs that write: that comes to an
// end before the turn as a whole is refused.
absl::Status RunStepper::MayWrite(size_t facts) {
  const int most = core_.limits.engine_rounds_per_turn * 3 / 4;
  if (core_.turn_round >= most) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "nothing more is written in this turn, which has gone on for ", core_.turn_round,
        " rounds; does what is told start again what tells it? (the limit engine_rounds_per_turn is ",
        core_.limits.engine_rounds_per_turn, ")"));
  }
  if (facts > kWorkflowLimits.facts_written_per_turn - core_.facts_written) {
    return absl::ResourceExhaustedError(
        absl::StrCat("runs would tell and withdraw more than ", kWorkflowLimits.facts_written_per_turn,
                     " facts in one turn; the limit is facts_written_per_turn"));
  }
  core_.facts_written += facts;
  return absl::OkStatus();
}

absl::StatusOr<Term> RunStepper::ValueOf(const cawl::Word& word, const TermBinding* binding) const {
  if (word.kind == cawl::Word::Kind::kTerm) return word.term;
  if (std::optional<Term> value = Value(word.name, binding)) return *std::move(value);
  return absl::FailedPreconditionError(absl::StrCat("variable $", word.name, " has no value"));
}

absl::StatusOr<TermQuad> RunStepper::FactOf(const cawl::Constraint& fact, const TermBinding* binding) const {
  TermQuad quad;
  quad.graph = Term::Iri(RunIri(run_.id));
  const std::pair<const cawl::Word*, Term*> places[] = {
      {&fact.subject, &quad.subject}, {&fact.verb, &quad.predicate}, {&fact.object, &quad.object}};
  for (const auto& [word, term] : places) {
    absl::StatusOr<Term> value = ValueOf(*word, binding);
    if (!value.ok()) return value.status();
    *term = *std::move(value);
  }
  if (absl::Status status = CheckQuad(quad, core_.limits.term_bytes); !status.ok()) {
    return absl::Status(status.code(),
                        absl::StrCat(status.message(), " (in the fact ", fact.subject.text.value, " ",
                                     fact.verb.text.value, " ", fact.object.text.value, ")"));
  }
  return quad;
}

// The facts of one binding, each once.
absl::StatusOr<std::vector<TermQuad>> RunStepper::FactsOf(const cawl::Action& action,
                                                          const TermBinding& binding) const {
  std::vector<TermQuad> facts;
  std::set<TermQuad, TripleLess> known;
  for (const cawl::Constraint& fact : action.facts) {
    absl::StatusOr<TermQuad> quad = FactOf(fact, &binding);
    if (!quad.ok())
      return WithMessage(quad.status(), absl::StrCat("it cannot tell: ", quad.status().message()));
    if (known.insert(*quad).second) facts.push_back(*std::move(quad));
  }
  return facts;
}

// All facts of all bindings, or none. What several bindings tell is told once, unless it may be an event: a binding that gives a
// type to a node to which one before it has given one is a telling of its own, with all its facts.
absl::Status RunStepper::Tell(size_t index, const cawl::Action& action) {
  std::vector<std::pair<TermQuad, bool>> facts;  // and whether it continues the telling
  std::set<TermQuad, TripleLess> known;          // of the telling
  std::set<Term> typed;
  const auto bindings = BindingsOf(index);
  if (!bindings.ok()) return bindings.status();
  for (const TermBinding& binding : *bindings) {
    absl::StatusOr<std::vector<TermQuad>> own = FactsOf(action, binding);
    if (!own.ok()) return own.status();
    std::set<Term> types;
    for (const TermQuad& fact : *own) {
      if (fact.predicate.lexical == kRdfType) types.insert(fact.subject);
    }
    const bool again =
        std::any_of(types.begin(), types.end(), [&typed](const Term& node) { return typed.contains(node); });
    if (again) {
      known.clear();
      typed.clear();
    }
    typed.merge(types);
    for (TermQuad& fact : *own) {
      const bool continues = !known.empty();
      if (known.insert(fact).second) facts.emplace_back(std::move(fact), continues);
    }
  }
  if (absl::Status may = MayWrite(facts.size()); !may.ok()) return may;
  core_.Say(Subject(index), "running", "running",
            Summary("told", facts.size(), facts.empty() ? nullptr : &facts.front().first));
  for (auto& [fact, continues] : facts) Write(true, std::move(fact), &action, Subject(index), continues);
  if (!facts.empty() && !action.until_run_ends) NoteTold(index, action);
  if (!facts.empty() && action.when == cawl::Action::When::kOpen) WritesAtOpen(index);
  return absl::OkStatus();
}

// What is done at="failure" is of the failure: it is not to be undone with the run.
void RunStepper::NoteTold(size_t index, const cawl::Action& action) {
  if (action.when != cawl::Action::When::kFailure) run_.told_for_good.insert(flow_.nodes[index].name.value);
}

void RunStepper::Write(bool tells, TermQuad fact, const cawl::Action* action, std::string by,
                       bool continues) {
  if (tells && action->until_run_ends)
    run_.actions.until_end.insert(fact);
  else
    run_.actions.until_end.erase(fact);
  core_.written[run_.id].push_back(core_.output->writes.size());
  core_.writing_trees.insert(core_.RootOf(run_));
  const int64_t lifetime_ms = tells ? action->lifetime_ms.value_or(0) : 0;
  core_.output->writes.push_back(
      {tells, std::move(fact), static_cast<uint64_t>(lifetime_ms), std::move(by), run_.id, continues});
}

absl::Status RunStepper::Withdraw(size_t index, const cawl::Action& action) {
  std::vector<TermQuad> facts;
  bool of_others = false;
  const auto bindings = BindingsOf(index);
  if (!bindings.ok()) return bindings.status();
  for (const TermBinding& binding : *bindings) {
    for (const cawl::Constraint& fact : action.facts) {
      absl::StatusOr<std::vector<TermQuad>> found =
          ToldFacts(fact, PatternOf(index, fact, action.any_source, &binding), &of_others);
      if (!found.ok())
        return WithMessage(found.status(), absl::StrCat("it cannot withdraw: ", found.status().message()));
      facts.insert(facts.end(), found->begin(), found->end());
    }
  }
  if (absl::Status may = MayWrite(facts.size()); !may.ok()) return may;
  std::string said = Summary("withdrew", facts.size(), facts.empty() ? nullptr : facts.data());
  if (facts.empty() && of_others)
    absl::StrAppend(&said, ": what matches was told by others, and source=\"any\" would take it away");
  core_.Say(Subject(index), "running", "running", std::move(said));
  for (TermQuad& fact : facts) Write(false, std::move(fact), &action);
  if (!facts.empty()) NoteTold(index, action);
  if (!facts.empty() && action.when == cawl::Action::When::kOpen) WritesAtOpen(index);
  return absl::OkStatus();
}

// ?name that the node's condition does not bind matches anything.
absl::StatusOr<FactPattern> RunStepper::PatternOf(size_t index, const cawl::Constraint& fact, bool any_source,
                                                  const TermBinding* binding) const {
  const std::optional<cawl::Condition>& condition = flow_.nodes[index].condition;
  const std::vector<std::string> bound = condition ? cawl::BoundBy(*condition) : std::vector<std::string>();
  FactPattern pattern;
  if (!any_source) pattern.source = RunIri(run_.id);
  const std::pair<const cawl::Word*, std::optional<Term>*> places[] = {
      {&fact.subject, &pattern.subject}, {&fact.verb, &pattern.predicate}, {&fact.object, &pattern.object}};
  for (const auto& [word, term] : places) {
    if (word->kind == cawl::Word::Kind::kFree &&
        std::find(bound.begin(), bound.end(), word->name) == bound.end())
      continue;
    absl::StatusOr<Term> value = ValueOf(*word, binding);
    if (!value.ok()) return value.status();
    *term = *std::move(value);
  }
  return pattern;
}

// The told facts that match, with what this run has written in the same round.
absl::StatusOr<std::vector<TermQuad>> RunStepper::ToldFacts(const cawl::Constraint& fact,
                                                            const absl::StatusOr<FactPattern>& wanted,
                                                            bool* of_others) const {
  if (!wanted.ok()) return wanted.status();
  const FactPattern& pattern = *wanted;
  if (core_.input->facts == nullptr) return absl::FailedPreconditionError("there is no graph");
  const size_t limit = kWorkflowLimits.facts_written_per_turn;
  absl::StatusOr<FactMatches> found = core_.input->facts->Match(pattern, limit);
  if (!found.ok()) return found.status();
  std::vector<TermQuad> told = std::move(found->told);
  std::erase_if(told, [&](const TermQuad& quad) { return !Agrees(fact, quad); });
  if (const auto written = core_.written.find(run_.id); written != core_.written.end()) {
    for (const size_t at : written->second) {
      const FactWrite& write = core_.output->writes[at];
      if (!Matches(pattern, write.quad) || !Agrees(fact, write.quad)) continue;
      std::erase(told, write.quad);
      if (write.tells) told.push_back(write.quad);
    }
  }
  if (!told.empty()) return told;
  FactPattern anywhere = pattern;
  anywhere.source.clear();
  const absl::StatusOr<FactMatches> others = core_.input->facts->Match(anywhere, limit);
  if (!others.ok() || !others->told.empty()) {
    *of_others = true;
  } else if (others->inferred) {
    return absl::FailedPreconditionError(absl::StrCat("nothing told matches ", fact.subject.text.value, " ",
                                                      fact.verb.text.value, " ", fact.object.text.value,
                                                      "; rules derive it: withdraw what it follows from"));
  }
  return told;
}

// The run ends, and what it told with lifetime="run" with it: as soon as each command of the run, and of those nested in it, has
// its final report. Until then a robot may still be where the fact says that it is.
void RunStepper::WithdrawUntilEnd() {
  const auto facts = std::exchange(run_.actions.until_end, {});
  if (!facts.empty()) core_.WithdrawWhenEnded(run_.id, {facts.begin(), facts.end()});
}

void Engine::Core::WithdrawWhenEnded(const RunId& run, std::vector<TermQuad> facts) {
  if (const std::optional<CommandId> last = ledger.LastEndingOf(run))
    return ledger.Keep(*last, run, std::move(facts));
  for (TermQuad& fact : facts)
    output->writes.push_back({.tells = false, .quad = std::move(fact), .run = run, .run_ended = true});
}

}  // namespace docent::engine
