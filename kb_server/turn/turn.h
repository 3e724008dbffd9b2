// One batch in, one new graph version out: the whole product in one function.
//
//   store → rules → conditions → engine, again until the engine is quiet
//
// A turn decides; it makes nothing durable, visible or heard. The caller (kb_server/writer/writer.h) appends the
// record to the log, and only then publishes the version, answers the client and sends the commands. Replay
// calls the same function with the batches of the log. Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_TURN_H_
#define DOCENT_KB_SERVER_TURN_TURN_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/limits.h"
#include "graph/log/turn_record.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"
#include "kb_server/robots/robot_directory.h"
#include "kb_server/turn/condition_port.h"
#include "kb_server/turn/documents.h"
#include "kb_server/turn/event_shelf.h"
#include "kb_server/turn/robot_ranking.h"
#include "reasoner/conditions/standing_conditions.h"
#include "reasoner/rules/rule_engine.h"
#include "workflow/engine/engine.h"

namespace docent::server {

// Changes when the same log may lead to other decisions than before.
inline constexpr char kEngineVersion[] = "25";

// The state of the stages, in the order in which a batch passes them.
struct Stages {
  // `start`: the graph to begin with; null: empty.
  Stages(Dictionary* dictionary_in, const sparql::FunctionRegistry* functions_in, const Limits& limits_in,
         GraphVersionPtr start = nullptr)
      : limits(limits_in),
        dictionary(*dictionary_in),
        functions(functions_in),
        writer(std::move(start)),
        applier(*dictionary_in, limits_in),
        events(dictionary_in),
        rules(*dictionary_in, limits_in, functions_in),
        standing_conditions(*dictionary_in, functions_in),
        conditions(dictionary_in, &standing_conditions, &rules),
        robots(dictionary_in),
        ranking(dictionary_in, functions, limits_in),
        engine(dictionary_in, limits_in) {}

  const Limits limits;
  Dictionary& dictionary;
  const sparql::FunctionRegistry* const functions;
  GraphWriter writer;
  BatchApplier applier;
  EventShelf events;
  rules::RuleEngine rules;
  conditions::StandingConditions standing_conditions;
  ConditionPort conditions;
  GraphRobotDirectory robots;
  GraphRobotRanking ranking;
  engine::Engine engine;
  Documents documents;
  // Whether each turn makes an immutable version. It is quicker without; the caller freezes those that it needs.
  bool freezes = true;
  // Ends a turn early, as an error: one that nobody waits for any more, or that makes more steps than the limits allow (which
  // RunTurn tells it). Null: no such limits; so while the log is replayed, whose turns were decided.
  Cancellation* cancellation = nullptr;

  void Commit();
  void Rollback();
  // When the next clock tick is due, if ever.
  std::optional<TimeMicros> NextDeadline() const;
};

struct TurnResult {
  log::TurnRecord record;
  GraphVersionPtr version;  // null unless Stages::freezes
  Delta delta;              // everything that changed in the graph, net
  size_t told_again =
      0;                // facts of events that left and came back in this turn, so that `delta` has them not
  size_t inferred = 0;  // facts that rules added or withdrew
  std::vector<CommandId> cancels;  // commands to be ended
  std::vector<CommandId> recalls;  // commands that are not to begin, where the robot has not begun them
  std::vector<Notification> notifications;
  std::vector<AdapterAddress> addresses;  // of adapters that are elsewhere now, or back
  std::vector<RunId> started;             // by the batch's run requests
  std::vector<engine::NestedRun> nested;  // runs that began within others, in their order
  std::vector<RunId> undeployed;          // cancelled with their workflow
  std::vector<RunId> steered;             // paused or resumed by them
  bool documents_changed = false;
};

// INVALID_ARGUMENT (what the batch says is wrong, with its place), RESOURCE_EXHAUSTED (a limit, named),
// FAILED_PRECONDITION, NOT_FOUND: nothing has changed. `offset`: of the record that this turn will be.
// `record_bytes`: becomes what the log is to keep of the turn, which is refused if that is too much for the
// log; null for a turn that the log has already.
absl::StatusOr<TurnResult> RunTurn(Stages* stages, WriteBatch batch, uint64_t offset,
                                   std::string* record_bytes = nullptr);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_TURN_H_
