// Inputs and outputs of the engine, as plain values: it never touches the graph, the conditions or a
// robot.
//
// One Step per round of a turn: the turn gives a ConditionView (levels and edges of the conditions that the
// engine armed) and a RobotDirectory, and carries out the EngineOutput. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_PORTS_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_PORTS_H_

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/store/decisions.h"
#include "graph/store/notification.h"
#include "graph/store/quad.h"

namespace docent::sparql {
struct Query;
}  // namespace docent::sparql

namespace docent::engine {

// Chosen by the engine, unique within a data folder.
using ConditionHandle = uint64_t;

// Variable name (without "?" or "$") → value.
using TermBinding = std::map<std::string, Term>;

// A part of a condition that must have held for some time, with the same values of its variables.
struct LastingPart {
  std::string ask;                     // SPARQL ASK
  std::vector<std::string> variables;  // that every solution of it binds
  TimeMicros at_least_us = 0;
  std::shared_ptr<const sparql::Query> query;  // of `ask`; null: to be parsed

  friend bool operator==(const LastingPart&, const LastingPart&) = default;
};

// A condition to be kept true or false from now on.
struct ConditionRequest {
  ConditionHandle handle = 0;
  std::string ask;  // SPARQL ASK
  // Not empty: also tell which bindings of these variables appear and disappear.
  std::vector<std::string> key_variables;
  // Bindings that are there already when it is armed do not count as appeared (events).
  bool only_new = false;
  // It holds, and has a solution, only while all these parts of the solution have held for their time. Time is
  // counted from the turn in which the condition is armed.
  std::vector<LastingPart> lasting;
  std::shared_ptr<const sparql::Query> query;  // of `ask`; null: to be parsed (it comes from a snapshot)
};

// An edge since the last Step, at most one a condition. A condition that was armed since then and holds
// already counts as risen, unless it was armed with only_new.
struct ConditionEdge {
  ConditionHandle handle = 0;
  bool rose = false;
  bool fell = false;
  std::vector<TermBinding> appeared;     // of the key variables, in term order
  std::vector<TermBinding> disappeared;  // before those that appeared: one that is in both was told again
  // More bindings than are kept (the limit condition_matches): nothing more is told of it.
  bool overflowed = false;
  bool moved = false;  // ConditionView::OpensAt answers otherwise than before

  bool OnlyMoved() const {
    return moved && !rose && !fell && !overflowed && appeared.empty() && disappeared.empty();
  }
};

// Levels and edges of armed conditions at this round's graph.
class ConditionView {
 public:
  virtual ~ConditionView() = default;
  virtual const std::vector<ConditionEdge>& edges() const = 0;
  virtual bool Holds(ConditionHandle handle) const = 0;
  // Solutions in term order, `fixed` variables bound beforehand; at most `limit`.
  virtual absl::StatusOr<std::vector<TermBinding>> Solutions(ConditionHandle handle, const TermBinding& fixed,
                                                             size_t limit) const = 0;
  // Of a condition with parts that must have held for some time: when it may hold if nothing else changes. nullopt: it holds, has
  // no match, or has no such parts.
  virtual std::optional<TimeMicros> OpensAt(ConditionHandle) const { return std::nullopt; }
  // Whether the answer may be another one once this fact is told or withdrawn. True where that is not known.
  virtual bool MayChange(ConditionHandle, const TermQuad&) const { return true; }
  // The told and inferred facts that make the condition hold under `binding`, as N-Triples, one a line.
  virtual std::string Evidence(ConditionHandle handle, const TermBinding& binding) const = 0;
};

// What of a robot an operation occupies while it is carried out: resources that the robot's maker names, for example base,
// screen and voice. Empty: the whole robot.
using Occupation = std::set<std::string>;

// The class that an invoke asks for by ext:capability, in place of the name of an operation: "<IRI>". nullopt: it is a name.
inline std::optional<std::string_view> CapabilityOf(std::string_view operation) {
  if (!operation.starts_with('<') || operation.size() < 2) return std::nullopt;
  return operation.substr(1, operation.size() - 2);
}

// A robot that offers an operation, as the graph has it.
struct RobotOffer {
  RobotId robot;
  std::string incarnation;  // of the robot's adapter
  bool idempotent = false;  // the operation may be done twice
  bool offline = false;     // its lease ran out
  // The parts that the operation takes, in order; nullopt: the robot did not describe them.
  std::optional<std::vector<std::string>> inputs;
  std::map<std::string, std::string> input_types =
      {};  // part → IRI of its class or datatype, where it is told
  Occupation occupies;
  bool busy = false;  // it says that it carries something out; a command of ours may be the reason
  // Why it takes no command whatever it does for us, for people: "is charging"; empty: it takes some.
  std::string out_of_service;
  std::string operation = {};  // of a capability: the robot's operation that is of this class
};

// Robots that are kept for somebody (docent:Reservation), as the graph has it.
struct Reservation {
  std::string iri;
  std::set<RobotId> robots;
  std::string
      kept_for;  // IRI of a run, with those nested in it, or of a workflow, for its runs; empty: for none
  int priority = 0;
  TimeMicros since_us = 0;
  TimeMicros until_us = 0;  // 0: until it is released, or the run ends
  std::string reason;       // for people; may be empty
};

class RobotDirectory {
 public:
  virtual ~RobotDirectory() = default;
  // Of this robot; the one that counts before the others in front: of the highest priority, of these the oldest. The reference
  // lives as that of Offers.
  virtual const std::vector<Reservation>& ReservationsOf(const RobotId& robot) const;
  // In term order of the robots' IRIs, one of each robot. Of a capability ("<IRI>"): one of each operation that is of the
  // class or of one below it, the most general first. The reference lives until the directory learns of a new graph.
  virtual const std::vector<RobotOffer>& Offers(const std::string& operation) const = 0;
  // Whether any answer may differ from the one of the round before.
  virtual bool changed() const = 0;
};

// An event that a turn tells.
struct ToldEvent {
  Term event;
  std::set<std::string> operations;
};
// Which events of the graph left, and which were told after that.
struct EventNews {
  std::vector<Term> gone;
  std::vector<ToldEvent> told;
};

// Transitions about an activator begin so: "activator/WORKFLOW", the workflow's name as a segment (graph/rdf/docent_iris.h).
inline constexpr std::string_view kActivatorSubject = "activator";
// A fact that is looked for; an absent position matches anything.
struct FactPattern {
  std::optional<Term> subject;
  std::optional<Term> predicate;
  std::optional<Term> object;
  std::string source;  // graph; empty: every graph in which clients, robots and runs tell
};

struct FactMatches {
  std::vector<TermQuad> told;  // in term order
  bool inferred = false;       // a rule derived one that matches, whatever the source
};

// The graph as of this round.
class FactView {
 public:
  virtual ~FactView() = default;
  // RESOURCE_EXHAUSTED: more than `limit` match.
  virtual absl::StatusOr<FactMatches> Match(const FactPattern& pattern, size_t limit) const = 0;
  // All solutions of a SELECT, in its order, a name of `columns` for each column. `given` are values of variables of the query.
  // RESOURCE_EXHAUSTED naming the limit: it has more solutions than assign_solutions, or takes too long.
  virtual absl::StatusOr<std::vector<TermBinding>> Select(const sparql::Query& query,
                                                          const TermBinding& given,
                                                          const std::vector<std::string>& columns) const = 0;
  // Whether an ASK holds. RESOURCE_EXHAUSTED: it takes too long.
  virtual absl::StatusOr<bool> Holds(const sparql::Query& ask) const = 0;
};

// A fact that a run tells or withdraws; the graph of the quad is its source.
struct FactWrite {
  bool tells = true;
  TermQuad quad;
  uint64_t lifetime_ms = 0;  // 0: until it is withdrawn
  std::string by = {};       // RUN/NODE that tells it, of segments
  RunId run = {};            // that writes it
  bool continues = false;    // it belongs to the same telling as the one before
  bool run_ended = false;  // it is withdrawn since its run has ended: behind all that runs tell in this round
};

class RobotRanking {
 public:
  virtual ~RobotRanking() = default;
  // Of the robots, of which there is at least one, the one to be preferred. `select`: workflow/cawl/robot_choice.h; empty: the
  // default query. `values`: of the query's variables.
  virtual RobotId Best(const std::string& select, const std::vector<RobotId>& able,
                       const TermBinding& values) const = 0;
};

inline const std::vector<Reservation>& RobotDirectory::ReservationsOf(const RobotId&) const {
  static const std::vector<Reservation> kNone;
  return kNone;
}

// A run that began within another one.
struct NestedRun {
  RunId run;
  std::string by;  // the invocation that it is of, "RUN/NODE/NUMBER"; to undo what a run did: "RUN"
};

struct EngineOutput {
  std::vector<Notification> notifications;
  std::vector<Quad> add;  // run facts, in graph docent:runs
  std::vector<Quad> remove;
  std::vector<FactWrite> writes;  // in their order; first those of EngineInput::untold
  std::vector<ConditionRequest> arm;
  std::vector<ConditionHandle> disarm;
  std::vector<Transition> transitions;
  std::vector<RobotCommand> commands;
  std::vector<CommandId> cancels;
  std::vector<CommandId> recalls;  // commands that are not to begin, where the robot has not begun them
  std::vector<RunId> started;      // by this turn's RunRequests, in their order
  std::vector<NestedRun> nested;   // in the order in which they began
  std::vector<RunId> undeployed;   // runs that are cancelled with their workflow
  std::vector<RunId> steered;  // that RunRequests paused or resumed, without those that are nested in them
  bool asks_again = false;     // runs are left that go on in the next round
  absl::Status refused;        // an error: the turn cannot be, and the caller rolls it back

  bool quiet() const {
    return !asks_again && add.empty() && remove.empty() && writes.empty() && notifications.empty() &&
           arm.empty() && transitions.empty() && commands.empty() && cancels.empty() && recalls.empty();
  }
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_PORTS_H_
