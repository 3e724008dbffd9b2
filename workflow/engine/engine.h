// The workflow engine: runs of CAWL flows, driven by conditions that rise, reports of robots, requests and
// time.
//
// It is a deterministic state machine: the same documents, Steps and answers of the two ports give the same
// outputs, so a replay of the log comes to the same decisions. It reads no clock, touches no graph and sends
// nothing; it returns what is to be done. Semantics: docs/reference/cawl.md; Choi et al. (IJDSN
// 2014), section 4.
//
// A turn: Deploy/PutServices (if it brings documents), then Step until the output is quiet, then Commit, or
// Rollback at any point, which puts everything back as it was at the last Commit. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_ENGINE_H_
#define DOCENT_WORKFLOW_ENGINE_ENGINE_H_

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/write_batch.h"
#include "workflow/cawl/ast.h"
#include "workflow/engine/state/ports.h"
#include "workflow/rsel/ast.h"
#include "workflow/rsel/service_registry.h"

namespace docent::engine {

// What one Step reads. `reports` and `requests` are given in the first round of a turn only.
struct EngineInput {
  TimeMicros now_us = 0;
  Revision revision;        // of the version that the turn makes
  bool clock_tick = false;  // it is a turn of the clock: runs that had more to do than a turn allows go on
  const std::vector<CommandReport>* reports = nullptr;
  const std::vector<RunRequest>* requests = nullptr;
  const EventNews* events = nullptr;  // null: none
  const ConditionView* conditions = nullptr;
  const RobotDirectory* robots = nullptr;
  const FactView* facts = nullptr;
  const RobotRanking* ranking = nullptr;  // null: robots are taken in the order of their IRIs
  // What Steps before wrote and the graph does not have yet; taken. Null: nothing.
  std::vector<FactWrite>* untold = nullptr;
};

// A command without a final report.
struct CommandUnderWay {
  RobotCommand command;
  bool ending = false;    // it was cancelled
  bool recalled = false;  // it is not to begin, where the robot has not begun it

  friend bool operator==(const CommandUnderWay&, const CommandUnderWay&) = default;
};

// A run of a recorded life that is lived again, with the document that it ran or another one.
struct PlayedRun {
  uint64_t number = 0;  // of the run, which is nested in none
  cawl::DocumentPtr document;
  std::string flow;                      // of the document
  std::optional<TermBinding> variables;  // that it begins with; nullopt: those that it is started with
  // Numbers of the recorded runs that were nested in it, in the order in which they began.
  std::vector<uint64_t> nested;
};

struct EngineState;  // engine_state.h

class Engine {
 public:
  struct Core;  // engine_core.h

  // `dictionary` must outlive the engine, which interns the terms of run facts in it.
  Engine(Dictionary* dictionary, const Limits& limits);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // Arms the document's activator; replaces the document of the same name, whose live runs go on unchanged
  // and whose bindings that already started a run do not start another. `document` is correct
  // (cawl::ParseCawl). INVALID_ARGUMENT: the activator's condition can never be asked; nothing has changed.
  absl::Status Deploy(cawl::DocumentPtr document);
  // False: no such workflow. Live runs go on, or are cancelled with the next Step. Firings that wait are dropped.
  bool Undeploy(const std::string& workflow, bool cancel_runs = false);
  // False: no such workflow. A disabled one starts no run, neither by its activator nor on request; what its activator's
  // condition has gained meanwhile and still has starts its runs when it is enabled. It stays so when it is deployed again.
  bool SetEnabled(const std::string& workflow, bool enabled);
  bool IsEnabled(const std::string& workflow) const;
  // Registers robot services; with errors nothing changed.
  Diagnostics PutServices(rsel::DocumentPtr document);
  // FAILED_PRECONDITION: another document's process contains one of its processes, unless `force`: ServiceRegistry::Remove.
  absl::Status RemoveServices(const std::string& document, bool force = false);

  // Checks a request before it becomes part of a turn's input: NOT_FOUND, INVALID_ARGUMENT,
  // RESOURCE_EXHAUSTED.
  // `robots`: refuses a robot that does not offer what it is to do, and a start without a value that the flow needs. Null: neither is
  // asked, as of a request that the log has.
  absl::Status CheckRequest(const RunRequest& request, const RobotDirectory* robots = nullptr) const;

  // One round. Deterministic.
  EngineOutput Step(const EngineInput& input);

  void Commit();
  void Rollback();

  // The whole state, between turns: after Commit or Rollback.
  EngineState Save() const;
  // Into a fresh engine. The caller arms what ArmedConditions says.
  void Restore(EngineState state);
  // Whose condition that is, for people: "run BoothGuide-1, node Move2Booth", "activator of BoothGuide"; empty: nobody's.
  std::string PlaceOf(ConditionHandle handle) const;

  // The events with which a condition waits: for a robot that is busy, or for other events that it needs, too.
  std::set<Term> AwaitedEvents() const;

  // When a clock tick is needed, if ever.
  std::optional<TimeMicros> NextDeadline() const;
  // Whether runs that had more to do than a turn allows wait for a turn of the clock.
  bool AwaitsTick() const;
  // Commands without a final report: those that are to end, then the others, oldest run first. After a restart their
  // adapters are asked about them.
  std::vector<CommandUnderWay> OpenCommands() const;
  // Notifications that are neither delivered nor given up, in order of their ids. After a restart they are sent again.
  std::vector<Notification> OpenNotifications() const;
  // The outermost run that holds the robot; null: it is free. Until the next change.
  const RunId* HolderOf(const RobotId& robot) const;
  // From the next Step on, runs that this engine does not have hold these robots, and no others; a robot that one of its own
  // runs holds stays with that run. It is neither saved nor journaled: for an engine that has one run of a recorded life.
  void HoldForOthers(std::map<RobotId, RunId> holds);

  // The run with this number, when something starts it, begins with the flow of this document, whatever is deployed. Runs
  // nested in it get the recorded numbers one after the other, and no other run gets one of these: so the ids of all others
  // stay what they were. For a replay; neither saved nor journaled.
  void PlayInstead(PlayedRun played);

  const rsel::ServiceRegistry& services() const;
  std::vector<cawl::DocumentPtr> workflows() const;               // by name
  cawl::DocumentPtr FindWorkflow(const std::string& name) const;  // null: none
  size_t live_runs() const;

 private:
  std::unique_ptr<Core> core_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_ENGINE_H_
