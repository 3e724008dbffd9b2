// Run events of a turn, for watchers. Pure.
#ifndef DOCENT_KB_SERVER_WRITER_RUN_EVENTS_H_
#define DOCENT_KB_SERVER_WRITER_RUN_EVENTS_H_

#include <cstdint>
#include <vector>

#include "graph/log/turn_record.h"
#include "kb_server/door/run_feed.h"

namespace docent::server {

// In the order in which they happened in the turn.
std::vector<RunEvent> EventsOf(const log::TurnRecord& record);
// Whether a robot tells how far a command is, which is no event.
bool TellsProgress(const log::TurnRecord& record);

// How many firings of activators started no run in the turn.
uint64_t IgnoredFirings(const log::TurnRecord& record);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WRITER_RUN_EVENTS_H_
