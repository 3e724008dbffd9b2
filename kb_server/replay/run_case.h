// A recorded run as a value: the state of the server before it, the batches of the turns of its life, and its course, that is
// what the run did. Enough to live its life again, with this document or another one, without the server that recorded it.
//
// A case without a state is a world that is put together of facts, documents and held robots, in which one run alone lives: of a
// simulation, of a node that is tried, or of a file that an older version saved. Values; any thread.
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

using Holds = std::map<RobotId, RunId>;

struct CaseTurn {
  uint64_t offset = 0;
  TimeMicros time_us = 0;
  WriteBatch batch;  // documents are texts
  // When the recorded stages had something due by themselves, after this turn.
  std::optional<TimeMicros> due_us;
  // Times of which the recorded graph said from this turn on that they are asked for (docent:TimeTrigger), or no longer.
  std::vector<std::string> asked, asked_no_more;
  std::optional<Holds> held;  // of a world, from this turn on, where that changed

  friend bool operator==(const CaseTurn&, const CaseTurn&) = default;
};

// What a rule with ext:for asks, by its ASK, has held with this binding since then.
struct HeldSince {
  std::string ask;
  std::map<std::string, Term> binding;
  TimeMicros since_us = 0;

  friend bool operator==(const HeldSince&, const HeldSince&) = default;
};

struct RunCase {
  RunId run;
  uint64_t number = 0;  // of the run, among those of its data folder
  std::string workflow;
  std::string flow;
  bool asked = false;  // started by a request; else by the activator
  // Arguments of the request, or what the activator bound its key variables to.
  NamedTerms values;
  Document document;            // that ran
  std::vector<CaseTurn> turns;  // the first one starts the run
  uint64_t last_turn = 0;       // up to which it was recorded
  bool ended = false;           // by then
  Course course;
  // Recorded runs that were nested in it → their paths (run_tree.h).
  std::map<RunId, std::string> nested;

  // Before the first turn: what kb_server/writer/server_state.h encodes. Empty: the case is a world.
  std::string state;
  // Documents that are put before the first turn. Of a world: rules, services and other workflows.
  std::vector<Document> documents;
  // Of a world, before the first turn.
  std::vector<TermQuad> facts;                             // that neither rules nor runs made
  std::vector<std::pair<TimeMicros, TermQuad>> lifetimes;  // of those that end by themselves: when
  std::vector<HeldSince> held_since;        // of the activator that is deployed for the workflow
  Holds held;                               // robots that other runs hold, each by an outermost run
  std::map<RobotId, TimeMicros> last_used;  // when a run took the robot last

  friend bool operator==(const RunCase&, const RunCase&) = default;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_RUN_CASE_H_
