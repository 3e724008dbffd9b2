#include "graph/calendar/time_spec.h"

#include <algorithm>
#include <array>

#include "graph/calendar/zones.h"

namespace docent::calendar {
namespace {

constexpr int kDayS = 24 * 3600;
constexpr TimeMicros kSecondUs = 1'000'000;
// Days that are looked at for the next or the last occurrence: a week has each weekday.
constexpr int kDaysAhead = 9;

absl::CivilSecond TimeOn(const absl::CivilDay& day, int seconds) {
  return absl::CivilSecond(day) + seconds;
}

bool IsOn(Weekdays days, const absl::CivilDay& day) {
  return (days >> static_cast<int>(absl::GetWeekday(day)) & 1) != 0;  // absl::Weekday::monday is 0
}

}  // namespace

bool TimeSpec::Holds(TimeMicros now_us) const {
  if (from && now_us < InstantOf(*from, zone)) return false;
  if (until && now_us >= InstantOf(*until, zone)) return false;
  const absl::CivilDay today = DayOf(now_us, zone);
  for (const absl::CivilDay& day : {today - 1, today}) {
    if (!IsOn(days, day)) continue;
    const int end = end_s <= begin_s ? end_s + kDayS : end_s;
    if (InstantOf(TimeOn(day, begin_s), zone) <= now_us && now_us < InstantOf(TimeOn(day, end), zone))
      return true;
  }
  return false;
}

TimeMicros TimeSpec::NextLook(TimeMicros now_us) const {
  const absl::CivilDay today = DayOf(now_us, zone);
  TimeMicros next = std::max(now_us + 1, InstantOf(absl::CivilSecond(today + 1), zone));
  const auto consider = [&](TimeMicros instant) {
    if (instant > now_us) next = std::min(next, instant);
  };
  for (const absl::CivilDay& day : {today - 1, today}) {
    consider(InstantOf(TimeOn(day, begin_s), zone));
    consider(InstantOf(TimeOn(day, end_s <= begin_s ? end_s + kDayS : end_s), zone));
  }
  if (from) consider(InstantOf(*from, zone));
  if (until) consider(InstantOf(*until, zone));
  return next;
}

namespace {

// Longer intervals that are aligned go by what the clocks show, shorter ones by the time that passes.
constexpr int64_t kLongestByElapsedMs = 3600 * 1000;

// Occurrences of one day, for `visit` until it returns false. Two that the clocks jump over may be the same moment.
template <typename Visit>
void OnDay(const TimeSpec& spec, const absl::CivilDay& day, Visit visit) {
  if (!IsOn(spec.days, day)) return;
  const auto within = [&spec](TimeMicros t) {
    return !(spec.from && t < InstantOf(*spec.from, spec.zone)) &&
           !(spec.until && t >= InstantOf(*spec.until, spec.zone));
  };
  if (spec.kind == TimeSpec::Kind::kDaily) {
    const TimeMicros t = InstantOf(TimeOn(day, spec.at_s), spec.zone);
    if (within(t)) visit(t);
    return;
  }
  if (spec.every_ms > kLongestByElapsedMs) {
    // it divides a day, and so is whole seconds
    for (int s = 0; s < kDayS; s += static_cast<int>(spec.every_ms / 1000)) {
      const TimeMicros t = InstantOf(TimeOn(day, s), spec.zone);
      if (within(t) && !visit(t)) return;
    }
    return;
  }
  const TimeMicros midnight = InstantOf(absl::CivilSecond(day), spec.zone);
  const TimeMicros end = InstantOf(absl::CivilSecond(day + 1), spec.zone);
  for (TimeMicros t = midnight; t < end; t += spec.every_ms * 1000) {
    if (within(t) && !visit(t)) return;
  }
}

}  // namespace

std::optional<TimeMicros> TimeSpec::Next(TimeMicros after_us, TimeMicros anchor_us) const {
  if (kind == Kind::kOnce) {
    const TimeMicros instant = InstantOf(once, zone);
    return instant > after_us ? std::make_optional(instant) : std::nullopt;
  }
  if (is_steady()) {
    const TimeMicros step = every_ms * 1000;
    if (after_us < anchor_us) return anchor_us + step;
    return anchor_us + ((after_us - anchor_us) / step + 1) * step;
  }
  absl::CivilDay first = DayOf(after_us, zone) - 1;
  if (from) first = std::max(first, absl::CivilDay(*from));
  for (int i = 0; i < kDaysAhead; ++i) {
    std::optional<TimeMicros> found;
    OnDay(*this, first + i, [&](TimeMicros t) {
      if (t > after_us) found = t;
      return !found;
    });
    if (found) return found;
  }
  return std::nullopt;
}

std::optional<TimeMicros> TimeSpec::Last(TimeMicros now_us, TimeMicros anchor_us) const {
  if (kind == Kind::kOnce) {
    const TimeMicros instant = InstantOf(once, zone);
    return instant <= now_us ? std::make_optional(instant) : std::nullopt;
  }
  if (is_steady()) {
    const TimeMicros step = every_ms * 1000;
    if (now_us < anchor_us + step) return std::nullopt;
    return anchor_us + (now_us - anchor_us) / step * step;
  }
  absl::CivilDay last = DayOf(now_us, zone) + 1;
  if (until) last = std::min(last, absl::CivilDay(*until));
  for (int i = 0; i < kDaysAhead; ++i) {
    std::optional<TimeMicros> found;
    OnDay(*this, last - i, [&](TimeMicros t) {
      if (t <= now_us) found = t;
      return t <= now_us;
    });
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace docent::calendar
