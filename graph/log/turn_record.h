// One record of the log: the input of a turn and its decisions. Inferred facts are not recorded; replay
// derives them.
//
// Replay runs `batch` through the same stages, derives transitions and commands, and compares them with the
// recorded ones (DecisionDifference). Under the same `engine_version` a difference is an error; after an
// upgrade the recorded decisions stand. Values; any thread.
#ifndef DOCENT_GRAPH_LOG_TURN_RECORD_H_
#define DOCENT_GRAPH_LOG_TURN_RECORD_H_

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/store/decisions.h"
#include "graph/store/write_batch.h"

namespace docent::log {

// A fact that a run told. It follows from the input; it stands here for those who ask where the fact comes from.
struct RunTelling {
  std::string by;  // RUN/NODE, of segments (graph/rdf/docent_iris.h)
  TermQuad quad;

  friend bool operator==(const RunTelling&, const RunTelling&) = default;
};

struct TurnRecord {
  uint64_t offset = 0;         // place in the log, from 1; assigned by the log, not stored in the bytes
  TimeMicros time_us = 0;      // the turn's time
  std::string engine_version;  // version of the code that decided
  WriteBatch batch;
  std::vector<Transition> transitions;  // in the order of the decisions
  std::vector<RobotCommand> commands;   // likewise
  std::vector<RunTelling> told;         // likewise; none in records of older versions

  friend bool operator==(const TurnRecord&, const TurnRecord&) = default;
};

// nullopt if both records hold the same transitions and commands in the same order. Otherwise a text for the
// error message: one line "recorded: …" and one line "derived: …" for each of the first few differences.
// Inputs, times and engine versions are not compared.
std::optional<std::string> DecisionDifference(const TurnRecord& recorded, const TurnRecord& derived);

// For people, on one line: "BoothGuide-1/Move2Booth waiting → running (because …)".
std::string ToDisplay(const Transition& transition);
// For people, on one line: id, robot, operation(arguments), guard, deadline.
std::string ToDisplay(const RobotCommand& command);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_TURN_RECORD_H_
