// A recorded run as a value: the facts before it, what became of them in each turn of its life, the answers of robots and the
// requests of operators, and its course, that is what the run did. Enough to play its life again, with this document or
// another one, without the server that recorded it.
//
// Facts of the case are those that neither rules nor the run itself made; those of the graphs that the server writes about
// runs and documents are left out. Values; any thread.
#ifndef DOCENT_KB_SERVER_REPLAY_RUN_CASE_H_
#define DOCENT_KB_SERVER_REPLAY_RUN_CASE_H_

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/store/decisions.h"
#include "graph/store/write_batch.h"

namespace docent::server {

using NamedTerms = std::vector<std::pair<std::string, Term>>;

// One thing that a run or one of its nodes did.
struct Decision {
  enum class Kind : uint8_t {
    kState,    // the node or the run came into another state
    kCommand,  // it sent a command, or a notification
    kCancel    // it cancelled one
  };
  Kind kind = Kind::kState;
  uint64_t turn = 0;  // offset of the recorded turn; in a replay that of the last one that it has come to
  TimeMicros time_us = 0;
  std::string node;  // path (run_tree.h); empty: the run itself
  // kState
  std::string from;
  std::string to;
  std::string cause;
  // kCommand, kCancel
  CommandId command;
  std::string operation;  // kNotifies: a notification, whose target stands for the robot
  RobotId robot;
  NamedTerms arguments;

  friend bool operator==(const Decision&, const Decision&) = default;
};
inline constexpr char kNotifies[] = "ext:notify";

struct Course {
  std::vector<Decision> decisions;  // in their order
  std::string state;                // of the run, in the end; empty: it has not started
  std::string reason;
  std::map<std::string, Term> variables;  // in the end
  std::map<std::string, Term> results;

  friend bool operator==(const Course&, const Course&) = default;
};

// A request of an operator.
struct CaseRequest {
  std::string run;     // path of the run that it is about; empty: the run itself
  RunRequest request;  // `target` is set where the request is about a robot

  friend bool operator==(const CaseRequest&, const CaseRequest&) = default;
};

using Holds = std::map<RobotId, RunId>;

struct CaseTurn {
  uint64_t offset = 0;
  TimeMicros time_us = 0;
  std::vector<QuadOperation> changes;
  std::vector<Document> documents;     // rules, services and other workflows that it brought or removed
  std::vector<CommandReport> reports;  // for commands and notifications of the run
  std::vector<CaseRequest> requests;
  std::optional<Holds> held;  // from this turn on, where that changed

  bool empty() const {
    return changes.empty() && documents.empty() && reports.empty() && requests.empty() && !held;
  }
  friend bool operator==(const CaseTurn&, const CaseTurn&) = default;
};

struct RunCase {
  RunId run;
  uint64_t number = 0;  // of the run, among those of its data folder
  std::string workflow;
  std::string flow;
  bool asked = false;  // started by a request; else by the activator
  // Arguments of the request, or what the activator bound its key variables to.
  NamedTerms values;
  Document document;                // that ran
  std::vector<Document> documents;  // rules, services and other workflows before the first turn
  std::vector<TermQuad> facts;      // likewise
  Holds held;                       // likewise: robots that other runs hold, each by an outermost run
  std::vector<CaseTurn> turns;      // the first one starts the run
  uint64_t last_turn = 0;           // up to which it was recorded
  bool ended = false;               // by then
  Course course;

  friend bool operator==(const RunCase&, const RunCase&) = default;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_RUN_CASE_H_
