// The state of a server after one turn, as a snapshot keeps it: what a replay of the log up to there would
// make.
//
// Taking it is a copy that costs the writer as much as there are live runs, lifetimes and remembered
// requests; graph and dictionary are shared. Encoding it is for another thread. Restored, it decides like the
// original: the same terms have the same ids, the inferred facts are there, conditions are armed in the same
// order.
#ifndef DOCENT_KB_SERVER_WRITER_SERVER_STATE_H_
#define DOCENT_KB_SERVER_WRITER_SERVER_STATE_H_

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/pace.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/turn/turn.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {

struct ServerState {
  uint64_t offset = 0;     // of the log record that made it
  TimeMicros time_us = 0;  // of that turn
  GraphVersionPtr graph;
  uint64_t terms = 0;  // entries of the dictionary that it may use
  std::vector<std::pair<TimeMicros, Quad>> lifetimes;
  EventShelf::Events events;
  std::map<Documents::Key, Documents::Entry> documents;
  VersionHistory versions;  // of documents
  engine::EngineState engine;
  std::vector<LastingSince> times;  // of conditions that must have held for some time
  std::vector<RememberedRequestPtr> requests;
};

// Writer thread, between turns; `graph` is the frozen version of the stages.
ServerState TakeState(const Stages& stages, const RequestMemory& requests, GraphVersionPtr graph,
                      TimeMicros time_us);

// Any thread. `dictionary` is the one of the stages. With a `pace` it rests now and then.
absl::StatusOr<std::string> EncodeState(const ServerState& state, const Dictionary& dictionary,
                                        Pace* pace = nullptr);

// Fresh stages in a state.
struct RestoredState {
  std::unique_ptr<Stages> stages;
  uint64_t offset = 0;
  TimeMicros time_us = 0;
  std::vector<RememberedRequestPtr> requests;
};
// From what EncodeState made of it. Terms that `dictionary` knows keep the ids that they have there; it may
// be empty. DATA_LOSS for bytes that do not decode; FAILED_PRECONDITION for those of a newer format.
absl::StatusOr<RestoredState> DecodeState(std::string_view bytes, Dictionary* dictionary,
                                          const sparql::FunctionRegistry* functions, const Limits& limits);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_SERVER_STATE_H_
