#include "graph/rdf/date_time.h"

#include <gtest/gtest.h>

#include <random>

#include "absl/time/time.h"

namespace docent {
namespace {

TEST(DateTimeTerm, IsCanonical) {
  EXPECT_EQ(DateTimeTerm(0).lexical, "1970-01-01T00:00:00Z");
  EXPECT_EQ(DateTimeTerm(500'000).lexical, "1970-01-01T00:00:00.5Z");
  EXPECT_EQ(DateTimeTerm(1'700'000'000'120'999).lexical, "2023-11-14T22:13:20.12Z");
  EXPECT_EQ(DateTimeTerm(1'709'164'805'007'000).lexical, "2024-02-29T00:00:05.007Z");
  EXPECT_EQ(DateTimeTerm(-1).lexical, "1969-12-31T23:59:59.999Z");
  EXPECT_EQ(DateTimeTerm(253'402'300'800'000'000).lexical, "10000-01-01T00:00:00Z");
  EXPECT_EQ(DateTimeTerm(-62'167'219'200'000'000).lexical, "0000-01-01T00:00:00Z");
  EXPECT_EQ(DateTimeTerm(-62'167'219'201'000'000).lexical, "-0001-12-31T23:59:59Z");
  EXPECT_EQ(DateTimeTerm(0).datatype, "http://www.w3.org/2001/XMLSchema#dateTime");
}

TEST(DateTimeTerm, IsThatOfAbseilInYearsOfFourDigits) {
  std::mt19937_64 dice(1);
  std::uniform_int_distribution<TimeMicros> times(-30'600'000'000'000'000, 253'402'300'799'999'999);
  for (int i = 0; i < 2000; ++i) {
    TimeMicros time_us = times(dice);
    for (TimeMicros unit = 1; i % 3 > 0 && unit < 1'000'000; unit *= 10) time_us -= time_us % unit;
    const absl::Time time = absl::FromUnixMillis(absl::ToUnixMillis(absl::FromUnixMicros(time_us)));
    EXPECT_EQ(DateTimeTerm(time_us).lexical,
              absl::FormatTime("%Y-%m-%dT%H:%M:%E*SZ", time, absl::UTCTimeZone()));
  }
}

}  // namespace
}  // namespace docent
