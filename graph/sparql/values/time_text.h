// xsd:dateTime, xsd:date and xsd:time as text (XML Schema part 2, sections 3.2.7 to 3.2.9). Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_TIME_TEXT_H_
#define DOCENT_GRAPH_SPARQL_VALUES_TIME_TEXT_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/clock.h"

namespace docent::sparql {

struct ZonedTime {
  TimeMicros local_us = 0;          // the time as written, as if its zone were UTC
  std::optional<int> zone_minutes;  // east of UTC
};

// nullopt if the text is not valid. Digits beyond the microsecond are dropped.
std::optional<ZonedTime> ParseDateTimeText(std::string_view text);
std::optional<ZonedTime> ParseDateText(std::string_view text);
std::optional<ZonedTime> ParseTimeText(std::string_view text);  // of the day 1970-01-01
std::string FormatDateTimeText(const ZonedTime& time);
std::string FormatDateText(const ZonedTime& time);
std::string FormatTimeText(const ZonedTime& time);
// Midnight of a day of the Gregorian calendar, as if its zone were UTC. Below: the days of a month.
TimeMicros TimeOfDay(int64_t year, int month, int day);
int DaysInMonth(int64_t year, int month);
// "Z", "-05:00", "" without a zone (function TZ).
std::string FormatZone(std::optional<int> zone_minutes);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_TIME_TEXT_H_
