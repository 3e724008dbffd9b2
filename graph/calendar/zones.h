// Time zones of the IANA database, by name. Any thread.
#ifndef DOCENT_GRAPH_CALENDAR_ZONES_H_
#define DOCENT_GRAPH_CALENDAR_ZONES_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/time/time.h"
#include "graph/base/clock.h"

namespace docent::calendar {

// The zone of that name ("Europe/Berlin", "UTC"), from the system's database; nullopt: it has none.
std::optional<absl::TimeZone> FindZone(std::string_view name);
// A name that is like this one, for hints; empty: none is near.
std::string ZoneLike(std::string_view name);

// The instant at which the zone's clocks show this. What they show twice is the first time. What they jump over is the
// instant of the jump.
TimeMicros InstantOf(const absl::CivilSecond& shown, const absl::TimeZone& zone);
// The day on which the zone's calendars are at an instant.
absl::CivilDay DayOf(TimeMicros instant_us, const absl::TimeZone& zone);

}  // namespace docent::calendar

#endif  // DOCENT_GRAPH_CALENDAR_ZONES_H_
