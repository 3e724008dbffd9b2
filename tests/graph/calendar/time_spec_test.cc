#include "graph/calendar/time_spec.h"

#include "absl/time/time.h"
#include "graph/calendar/zones.h"
#include "gtest/gtest.h"

namespace docent::calendar {
namespace {

TimeMicros At(const std::string& utc) {
  absl::Time time;
  std::string error;
  EXPECT_TRUE(absl::ParseTime("%Y-%m-%dT%H:%M:%S%Ez", utc + ":00Z", &time, &error)) << error;
  return absl::ToUnixMicros(time);
}

std::string Utc(const std::optional<TimeMicros>& time) {
  if (!time) return "never";
  return absl::FormatTime("%Y-%m-%dT%H:%M", absl::FromUnixMicros(*time), absl::UTCTimeZone());
}

TimeSpec Spec(const TimeWords& words) {
  std::vector<TimeFault> faults;
  const std::optional<TimeSpec> spec = ParseTimeSpec(words, &faults);
  EXPECT_TRUE(spec.has_value()) << faults.front().message;
  return spec.value_or(TimeSpec());
}

TimeFault FaultOf(const TimeWords& words) {
  std::vector<TimeFault> faults;
  EXPECT_FALSE(ParseTimeSpec(words, &faults).has_value()) << TimeIri(words);
  return faults.empty() ? TimeFault() : faults.front();
}

// The words at fault, in order.
std::vector<std::string> FaultyWords(const TimeWords& words) {
  std::vector<TimeFault> faults;
  ParseTimeSpec(words, &faults);
  std::vector<std::string> out;
  for (const TimeFault& fault : faults) out.push_back(fault.word);
  return out;
}

TEST(TimeSpecTest, AllFaultsAreToldAtOnceAndNoneThatFollowsFromAnother) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(FaultyWords({{"between", "09:00-25:00"}, {"zone", "Europe/Zuerich"}}),
            (Words{"between", "zone"}));
  EXPECT_EQ(FaultyWords({{"days", "Mot-Fri"}, {"from", "2026-02-30"}, {"until", "soon"}}),
            (Words{"days", "from", "until"}));
  EXPECT_EQ(FaultyWords({{"at", "2026-13-01T10:00"}, {"days", "Mon"}, {"missed", "maybe"}}),
            (Words{"at", "days", "missed"}));
  EXPECT_EQ(FaultyWords({{"every", "7"}, {"aligned", "true"}}), Words{"every"});
  EXPECT_EQ(FaultyWords({{"at", "25:00"}, {"missed", "fire"}}), Words{"at"}) << "it is no level";
  EXPECT_EQ(FaultyWords({{"every", "7"}, {"days", "Mon"}}), (Words{"every", "days"}));
  EXPECT_EQ(FaultyWords({{"between", "9-10"}, {"every", "5min"}, {"aligned", "true"}, {"zone", "Mars"}}),
            (Words{"every", "zone"}));
}

TEST(TimeSpecTest, AWindowHoldsFromItsBeginToItsEnd) {
  const TimeSpec spec = Spec({{"between", "09:00-17:00"}});
  EXPECT_FALSE(spec.Holds(At("2026-11-26T09:00") - 1));
  EXPECT_TRUE(spec.Holds(At("2026-11-26T09:00")));
  EXPECT_TRUE(spec.Holds(At("2026-11-26T17:00") - 1));
  EXPECT_FALSE(spec.Holds(At("2026-11-26T17:00")));
  EXPECT_EQ(Utc(spec.NextLook(At("2026-11-26T08:00"))), "2026-11-26T09:00");
  EXPECT_EQ(Utc(spec.NextLook(At("2026-11-26T09:00"))), "2026-11-26T17:00");
  EXPECT_EQ(Utc(spec.NextLook(At("2026-11-26T17:00"))), "2026-11-27T00:00");
}

TEST(TimeSpecTest, AWindowOverMidnightBelongsToTheDayOnWhichItBegins) {
  const TimeSpec spec = Spec({{"between", "22:00-06:00"}, {"days", "Fri"}});
  EXPECT_FALSE(spec.Holds(At("2026-11-26T23:00"))) << "a Thursday";
  EXPECT_FALSE(spec.Holds(At("2026-11-27T05:00"))) << "Thursday's night";
  EXPECT_TRUE(spec.Holds(At("2026-11-27T22:00")));
  EXPECT_TRUE(spec.Holds(At("2026-11-28T05:59"))) << "Friday's night on Saturday";
  EXPECT_FALSE(spec.Holds(At("2026-11-28T06:00")));
}

TEST(TimeSpecTest, AZoneHasItsOwnDaysAndItsSummerTime) {
  const TimeSpec spec = Spec({{"between", "09:00-17:00"}, {"zone", "Europe/Berlin"}});
  EXPECT_TRUE(spec.Holds(At("2026-11-26T08:00"))) << "UTC+1";
  EXPECT_FALSE(spec.Holds(At("2026-11-26T16:00")));
  EXPECT_TRUE(spec.Holds(At("2026-07-01T07:00"))) << "UTC+2";
  EXPECT_FALSE(spec.Holds(At("2026-07-01T15:00")));
  const TimeSpec sunday = Spec({{"days", "Sun"}, {"zone", "Pacific/Auckland"}});
  EXPECT_TRUE(sunday.Holds(At("2026-11-28T12:00"))) << "Sunday there, Saturday in Greenwich";
}

TEST(TimeSpecTest, ATimeThatTheClocksJumpOverIsTheMomentOfTheJump) {
  const TimeSpec spec = Spec({{"at", "02:30"}, {"zone", "Europe/Berlin"}});
  EXPECT_EQ(Utc(spec.Next(At("2026-03-28T12:00"), 0)), "2026-03-29T01:00");
  EXPECT_EQ(Utc(spec.Next(At("2026-03-29T01:00"), 0)), "2026-03-30T00:30") << "once on that day";
  const TimeSpec gap = Spec({{"between", "02:15-02:45"}, {"zone", "Europe/Berlin"}});
  EXPECT_FALSE(gap.Holds(At("2026-03-29T01:00"))) << "a window in the gap is empty";
}

TEST(TimeSpecTest, ATimeThatTheClocksShowTwiceIsTheFirstOne) {
  const TimeSpec spec = Spec({{"at", "02:30"}, {"zone", "Europe/Berlin"}});
  EXPECT_EQ(Utc(spec.Next(At("2026-10-24T12:00"), 0)), "2026-10-25T00:30");
  EXPECT_EQ(Utc(spec.Next(At("2026-10-25T00:30"), 0)), "2026-10-26T01:30") << "not an hour later again";
}

TEST(TimeSpecTest, ADailyTimeHasANextAndALast) {
  const TimeSpec spec = Spec({{"at", "18:00"}, {"days", "Mon-Fri"}});
  EXPECT_EQ(Utc(spec.Next(At("2026-11-27T17:59"), 0)), "2026-11-27T18:00") << "Friday";
  EXPECT_EQ(Utc(spec.Next(At("2026-11-27T18:00"), 0)), "2026-11-30T18:00") << "Monday";
  EXPECT_EQ(Utc(spec.Last(At("2026-11-29T12:00"), 0)), "2026-11-27T18:00");
  EXPECT_EQ(Utc(spec.Last(At("2026-11-27T18:00"), 0)), "2026-11-27T18:00");
}

TEST(TimeSpecTest, ARangeOfDaysEndsWithItsLastDay) {
  const TimeSpec spec = Spec({{"at", "18:00"}, {"from", "2026-12-01"}, {"until", "2026-12-24"}});
  EXPECT_EQ(Utc(spec.Next(At("2026-06-01T00:00"), 0)), "2026-12-01T18:00");
  EXPECT_EQ(Utc(spec.Next(At("2026-12-24T17:00"), 0)), "2026-12-24T18:00");
  EXPECT_EQ(Utc(spec.Next(At("2026-12-24T18:00"), 0)), "never");
  EXPECT_EQ(Utc(spec.Last(At("2027-06-01T00:00"), 0)), "2026-12-24T18:00");
  EXPECT_EQ(Utc(spec.Last(At("2026-06-01T00:00"), 0)), "never");
  const TimeSpec level = Spec({{"from", "2026-12-01"}, {"until", "2026-12-24"}});
  EXPECT_FALSE(level.Holds(At("2026-11-30T23:59")));
  EXPECT_TRUE(level.Holds(At("2026-12-24T23:59")));
  EXPECT_FALSE(level.Holds(At("2026-12-25T00:00")));
}

TEST(TimeSpecTest, ADateAndTimeIsOnce) {
  const TimeSpec spec = Spec({{"at", "2026-12-24T18:00"}, {"zone", "Europe/Berlin"}});
  EXPECT_EQ(Utc(spec.Next(At("2026-11-26T00:00"), 0)), "2026-12-24T17:00");
  EXPECT_EQ(Utc(spec.Next(At("2026-12-24T17:00"), 0)), "never");
}

TEST(TimeSpecTest, AnIntervalIsCountedFromItsBeginOrFromMidnight) {
  const TimeSpec free = Spec({{"every", "10min"}});
  const TimeMicros anchor = At("2026-11-26T08:03");
  EXPECT_EQ(Utc(free.Next(anchor, anchor)), "2026-11-26T08:13");
  EXPECT_EQ(Utc(free.Last(At("2026-11-26T08:40"), anchor)), "2026-11-26T08:33");
  EXPECT_EQ(Utc(free.Last(At("2026-11-26T08:12"), anchor)), "never");
  const TimeSpec aligned = Spec({{"every", "6h"}, {"aligned", "true"}, {"zone", "Europe/Berlin"}});
  EXPECT_EQ(Utc(aligned.Next(At("2026-11-26T08:03"), 0)), "2026-11-26T11:00");
  EXPECT_EQ(Utc(aligned.Next(At("2026-11-26T22:30"), 0)), "2026-11-26T23:00") << "midnight in Berlin";
}

// It was 07, 13 and 19 o'clock, and midnight twice.
TEST(TimeSpecTest, AnAlignedIntervalOfHoursGoesByWhatTheClocksShow) {
  const TimeSpec spec = Spec({{"every", "6h"}, {"aligned", "true"}, {"zone", "Europe/Berlin"}});
  EXPECT_EQ(Utc(spec.Next(At("2026-03-28T23:00"), 0)), "2026-03-29T04:00") << "06:00, summer time";
  EXPECT_EQ(Utc(spec.Next(At("2026-03-29T04:00"), 0)), "2026-03-29T10:00");
  EXPECT_EQ(Utc(spec.Next(At("2026-03-29T16:00"), 0)), "2026-03-29T22:00") << "midnight";
  EXPECT_EQ(Utc(spec.Next(At("2026-10-24T22:00"), 0)), "2026-10-25T05:00") << "06:00, winter time";
  EXPECT_EQ(Utc(spec.Last(At("2026-10-25T22:59"), 0)), "2026-10-25T17:00");
  const TimeSpec gap = Spec({{"every", "2h"}, {"aligned", "true"}, {"zone", "Europe/Berlin"}});
  EXPECT_EQ(Utc(gap.Next(At("2026-03-28T23:00"), 0)), "2026-03-29T01:00")
      << "02:00 is the moment of the jump";
  EXPECT_EQ(Utc(gap.Next(At("2026-10-24T22:00"), 0)), "2026-10-25T00:00") << "02:00 is the first of the two";
  EXPECT_EQ(Utc(gap.Next(At("2026-10-25T00:00"), 0)), "2026-10-25T03:00") << "04:00";
}

// Over two years, in zones whose clocks change by an hour or half of one, at night or at midnight.
void CheckEveryDay(const std::string& zone, const std::string& every) {
  const TimeSpec spec = Spec({{"every", every}, {"aligned", "true"}, {"zone", zone}});
  const int64_t step_s = spec.every_ms / 1000;
  const bool by_clock = step_s > 3600;
  std::optional<TimeMicros> before;
  for (absl::CivilDay day(2026, 1, 1); day < absl::CivilDay(2028, 1, 1); ++day) {
    SCOPED_TRACE(zone + " " + every + " " + absl::FormatCivilTime(day));
    const TimeMicros midnight = InstantOf(absl::CivilSecond(day), spec.zone);
    const int64_t length_s = (InstantOf(absl::CivilSecond(day + 1), spec.zone) - midnight) / 1'000'000;
    for (int64_t s = 0; s < (by_clock ? 24 * 3600 : length_s); s += step_s) {
      const absl::CivilSecond shown = absl::CivilSecond(day) + s;
      const TimeMicros wanted = by_clock ? InstantOf(shown, spec.zone) : midnight + s * 1'000'000;
      if (wanted == before) continue;  // two in one jump
      if (before) {
        ASSERT_EQ(spec.Last(wanted - 1, 0), before);
      }
      const std::optional<TimeMicros> next = spec.Next(before.value_or(wanted - 1), 0);
      ASSERT_EQ(Utc(next), Utc(wanted));
      ASSERT_EQ(spec.Last(wanted, 0), next);
      const absl::Time moment = absl::FromUnixMicros(wanted);
      const bool jumped = spec.zone.At(shown).kind == absl::TimeZone::TimeInfo::SKIPPED;
      if (by_clock && !jumped) {
        ASSERT_EQ(absl::ToCivilSecond(moment, spec.zone), shown);
      }
      before = next;
    }
  }
}

TEST(TimeSpecTest, AlignedIntervalsHoldToTheirDayWhateverTheClocksDo) {
  for (const char* zone :
       {"Europe/Berlin", "Australia/Lord_Howe", "America/Santiago", "Africa/Cairo", "UTC"}) {
    for (const char* every : {"2h", "6h", "90min", "24h", "15min", "1h"}) CheckEveryDay(zone, every);
  }
}

TEST(TimeSpecTest, WhatCanNeverBeIsRefused) {
  EXPECT_EQ(FaultOf({{"from", "2027-02-31"}}).message,
            "\"2027-02-31\" can never be: the month has no day 31");
  EXPECT_EQ(FaultOf({{"at", "2027-02-29T10:00"}}).word, "at");
  EXPECT_EQ(FaultOf({{"from", "2026-12-24"}, {"until", "2026-12-01"}}).word, "until");
  EXPECT_EQ(FaultOf({{"between", "09:00-09:00"}}).word, "between");
  EXPECT_EQ(FaultOf({{"between", "9-17"}}).word, "between");
  EXPECT_EQ(FaultOf({{"at", "24:00"}}).word, "at");
  EXPECT_EQ(FaultOf({{"at", "25:00"}}).word, "at");
  EXPECT_EQ(FaultOf({{"days", "Mon-Fry"}}).word, "days");
  EXPECT_EQ(FaultOf({{"every", "7h"}, {"aligned", "true"}}).word, "every");
  EXPECT_EQ(FaultOf({{"every", "0s"}}).word, "every");
  EXPECT_EQ(FaultOf({{"every", "500ms"}}).word, "every");
  EXPECT_EQ(FaultOf({{"at", "10:00"}, {"every", "1h"}}).word, "every");
  EXPECT_EQ(FaultOf({{"zone", "UTC"}}).word, "");
  EXPECT_EQ(FaultOf({{"between", "09:00-17:00"}, {"missed", "skip"}}).word, "missed");
  EXPECT_EQ(FaultOf({{"at", "10:00"}, {"missed", "later"}}).word, "missed");
  EXPECT_EQ(FaultOf({{"at", "2026-12-24T18:00"}, {"days", "Mon"}}).word, "days");
}

TEST(TimeSpecTest, AnUnknownZoneHasTheNearestName) {
  EXPECT_EQ(FaultOf({{"at", "10:00"}, {"zone", "Europe/Berln"}}).right, "Europe/Berlin");
  EXPECT_EQ(FaultOf({{"at", "10:00"}, {"zone", "berlin"}}).right, "Europe/Berlin");
  for (const char* no_zone :
       {"", "/etc/passwd", "../../etc/passwd", "file:x", "localtime", "Fixed/UTC+01:00:00"})
    EXPECT_FALSE(FindZone(no_zone).has_value()) << no_zone;
}

TEST(TimeSpecTest, TheIriSaysTheWordsInOneOrder) {
  const TimeWords words = {{"zone", "Europe/Berlin"}, {"days", "Mon-Fri, Sun"}, {"between", "22:00-06:00"}};
  const std::string iri = TimeIri(words);
  EXPECT_EQ(iri, "https://w3id.org/docent/time#between=22:00-06:00;days=Mon-Fri,Sun;zone=Europe/Berlin");
  EXPECT_EQ(TimeIri(*WordsOfTimeIri(iri)), iri);
  EXPECT_FALSE(WordsOfTimeIri("https://w3id.org/docent/time#colour=red").has_value());
  EXPECT_FALSE(WordsOfTimeIri("urn:x").has_value());
  EXPECT_EQ(TimeIrisIn("ASK { <" + iri + "> a ?x . <" + iri + "> a ?y . <urn:x> a ?z }"),
            std::vector<std::string>{iri});
}

}  // namespace
}  // namespace docent::calendar
