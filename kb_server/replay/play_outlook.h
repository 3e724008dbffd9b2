// What happens next in a simulation without anybody doing anything, behind its end. Functions without state.
#ifndef DOCENT_KB_SERVER_REPLAY_PLAY_OUTLOOK_H_
#define DOCENT_KB_SERVER_REPLAY_PLAY_OUTLOOK_H_

#include <optional>

#include "graph/base/clock.h"
#include "kb_server/replay/played_clock.h"
#include "kb_server/turn/turn.h"

namespace docent::server {

// When the run may go on by itself: a timer of it is due, what it waits for has held for long enough, or a time of day or the end
// of a lifetime changes what it waits for. nullopt: not by itself. A time that is not to come within a few hundred changes of
// times of day is not found.
std::optional<TimeMicros> GoesOnAt(const Stages& stages, const PlayedClock& clock);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_PLAY_OUTLOOK_H_
