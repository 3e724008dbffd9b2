// Opening hours of a place, as schema.org writes them: schema:openingHoursSpecification with opens, closes, dayOfWeek,
// validFrom and validThrough; schema:specialOpeningHoursSpecification for single days, which count alone on their days.
//
// Times are those of the place's docent:timeZone, UTC without it. Hours that end when they begin, or have no opens, say that
// the place is closed. Hours over midnight belong to the day on which they begin. Values; any thread.
#ifndef DOCENT_KB_SERVER_CLOCK_OPENING_HOURS_H_
#define DOCENT_KB_SERVER_CLOCK_OPENING_HOURS_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/time/civil_time.h"
#include "absl/time/time.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"

namespace docent::server {

struct Hours {
  calendar::Weekdays days = calendar::kAllDays;
  std::optional<int> opens_s, closes_s;  // of the day; none: closed
  std::optional<absl::CivilDay> from, through;

  bool IsOn(const absl::CivilDay& day) const;
};

struct OpeningHours {
  absl::TimeZone zone = absl::UTCTimeZone();
  std::vector<Hours> regular, special;
  std::string fault;  // what could not be read, for people; empty: nothing

  bool OpenAt(TimeMicros now_us) const;
  // The next instant at which OpenAt may be another; at most a day later.
  TimeMicros NextLook(TimeMicros now_us) const;

 private:
  const std::vector<Hours>& On(const absl::CivilDay& day) const;
};

// Subjects that have opening hours, in term order.
std::vector<std::string> PlacesWithHours(const Dictionary& dictionary, const GraphVersion& graph);
OpeningHours HoursOf(const std::string& place, const Dictionary& dictionary, const GraphVersion& graph);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLOCK_OPENING_HOURS_H_
