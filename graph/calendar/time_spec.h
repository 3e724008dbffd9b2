// Time triggers: times that come again and again, or once, described by a few words.
//
//   between="22:00-06:00" days="Mon-Fri" from="2026-12-01" until="2026-12-24"   a level: it holds, or it does not
//   at="18:00" days="Sat,Sun"         an occurrence on each of these days
//   at="2026-12-24T18:00"             an occurrence once
//   every="10min"                     occurrences, counted from when somebody began to ask for it
//   every="10min" aligned="true"      occurrences, counted from each midnight of the zone: of more than an hour when its clocks show a multiple
//                                     of the interval, of up to an hour by the time that has passed
//   zone="Europe/Berlin"              of all of these; UTC without it
//   missed="skip"                     an occurrence that was missed (the server was down, or the clock was set) is left out; "fire": it is told late, once
//
// A level over midnight belongs to the day on which it begins. A time that the zone's clocks show twice is the first of
// the two; one that they jump over is the moment of the jump. Values; any thread. Nothing here reads a clock.
#ifndef DOCENT_GRAPH_CALENDAR_TIME_SPEC_H_
#define DOCENT_GRAPH_CALENDAR_TIME_SPEC_H_

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/time/civil_time.h"
#include "absl/time/time.h"
#include "graph/base/clock.h"

namespace docent::calendar {

// IRIs of triggers that documents ask for: this, and the canonical text.
inline constexpr std::string_view kTimeNs = "https://w3id.org/docent/time#";

// What is known of a trigger: word → value, both as written. The words are those above.
using TimeWords = std::map<std::string, std::string>;
// All of them, in the order of a canonical text.
const std::vector<std::string>& TimeWordNames();

// Why words are no trigger.
struct TimeFault {
  std::string word;  // the one at fault; empty: all of them together
  std::string message;
  std::string hint;
  std::string right;  // the value that is probably meant; empty: none is evident
};

// Days of the week, Monday first.
using Weekdays = uint8_t;
inline constexpr Weekdays kAllDays = 0x7f;
// "Mon-Fri,Sun", "Sat"; nullopt: it is not one.
std::optional<Weekdays> ParseWeekdays(std::string_view text);
// Seconds after midnight of "9:00", "09:00:30", "24:00".
std::optional<int> ParseTimeOfDay(std::string_view text);
// "2026-12-24"; a day that the calendar has not, as 31 February, is none.
std::optional<absl::CivilDay> ParseDay(std::string_view text);

struct TimeSpec {
  enum class Kind { kLevel, kDaily, kOnce, kEvery };
  Kind kind = Kind::kLevel;
  std::string zone_name = "UTC";
  absl::TimeZone zone = absl::UTCTimeZone();
  Weekdays days = kAllDays;
  int begin_s = 0, end_s = 24 * 3600;  // kLevel: of the day; an end before the begin is on the next one
  int at_s = 0;                        // kDaily
  absl::CivilSecond once;              // kOnce
  int64_t every_ms = 0;                // kEvery
  bool aligned = false;
  bool fire_missed = true;
  std::optional<absl::CivilSecond> from, until;  // until: not included any more

  bool is_level() const { return kind == Kind::kLevel; }
  // Counted on the steady clock of turns, from `anchor`; the others follow the wall clock.
  bool is_steady() const { return kind == Kind::kEvery && !aligned; }

  // kLevel.
  bool Holds(TimeMicros now_us) const;
  // The next instant after `now_us` at which Holds may be another; at most a day later.
  TimeMicros NextLook(TimeMicros now_us) const;

  // The others: the first after `after_us`, and the last until `now_us`, if there is one. `anchor_us`: of kEvery that is not
  // aligned.
  std::optional<TimeMicros> Next(TimeMicros after_us, TimeMicros anchor_us) const;
  std::optional<TimeMicros> Last(TimeMicros now_us, TimeMicros anchor_us) const;
};

// nullopt: `*faults` says why, all of it.
std::optional<TimeSpec> ParseTimeSpec(const TimeWords& words, std::vector<TimeFault>* faults);
std::optional<TimeSpec> ParseTimeSpec(const TimeWords& words);

// The IRI of the trigger that these words describe: the same words, the same IRI.
std::string TimeIri(const TimeWords& words);
// nullopt: not such an IRI.
std::optional<TimeWords> WordsOfTimeIri(std::string_view iri);
// The IRIs of triggers that stand in a text, as <…>, each once.
std::vector<std::string> TimeIrisIn(std::string_view text);

}  // namespace docent::calendar

#endif  // DOCENT_GRAPH_CALENDAR_TIME_SPEC_H_
