#include "graph/sparql/values/time_text.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "graph/sparql/values/value.h"

namespace docent::sparql {
namespace {

constexpr TimeMicros kSecond = 1'000'000;
constexpr TimeMicros kDay = 86'400 * kSecond;

// Days since 1970-01-01 (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms")
int64_t DaysFromCivil(int64_t year, int month, int day) {
  year -= month <= 2;
  const int64_t era = (year >= 0 ? year : year - 399) / 400;
  const int64_t year_of_era = year - era * 400;
  const int64_t day_of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  const int64_t day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146097 + day_of_era - 719468;
}

// Reader from the front of a text.
class Reader {
 public:
  explicit Reader(std::string_view text) : rest_(text) {}
  bool AtEnd() const { return rest_.empty(); }
  bool Take(char c) {
    if (rest_.empty() || rest_[0] != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  // At least `min` and at most `max` digits.
  std::optional<int64_t> Digits(size_t min, size_t max) {
    int64_t value = 0;
    size_t n = 0;
    while (n < rest_.size() && n < max && rest_[n] >= '0' && rest_[n] <= '9')
      value = value * 10 + (rest_[n++] - '0');
    if (n < min) return std::nullopt;
    rest_.remove_prefix(n);
    return value;
  }
  // Digits of a year (XML Schema 1.1 part 2, section D.3.1, yearFrag): four, or more without a leading zero.
  std::optional<int64_t> Year() {
    constexpr size_t kMost = 6;  // 292,000 years fit into TimeMicros
    const bool short_year = rest_.starts_with('0');
    return Digits(4, short_year ? 4 : kMost);
  }
  // Fraction of a second after the point, in microseconds.
  std::optional<int64_t> Fraction() {
    int64_t value = 0;
    size_t n = 0;
    for (; n < rest_.size() && rest_[n] >= '0' && rest_[n] <= '9'; ++n) {
      if (n < 6) value = value * 10 + (rest_[n] - '0');
    }
    if (n == 0) return std::nullopt;
    for (size_t i = n; i < 6; ++i) value *= 10;
    rest_.remove_prefix(n);
    return value;
  }

 private:
  std::string_view rest_;
};

std::optional<int64_t> ReadDate(Reader* in) {
  const bool negative = in->Take('-');
  const auto year = in->Year();
  if (!year || !in->Take('-')) return std::nullopt;
  const auto month = in->Digits(2, 2);
  if (!month || *month < 1 || *month > 12 || !in->Take('-')) return std::nullopt;
  const auto day = in->Digits(2, 2);
  const int64_t y = negative ? -*year : *year;
  if (std::abs(y) > 200'000 || !day || *day < 1 || *day > DaysInMonth(y, static_cast<int>(*month)))
    return std::nullopt;
  return DaysFromCivil(y, static_cast<int>(*month), static_cast<int>(*day));
}

// (Z | [+-]hh:mm)? to the end of the text
bool ReadZone(Reader* in, std::optional<int>* zone) {
  if (in->AtEnd()) return true;
  if (in->Take('Z')) {
    *zone = 0;
    return in->AtEnd();
  }
  const int sign = in->Take('+') ? 1 : in->Take('-') ? -1 : 0;
  const auto hours = in->Digits(2, 2);
  if (sign == 0 || !hours || !in->Take(':')) return false;
  const auto minutes = in->Digits(2, 2);
  if (!minutes || *minutes > 59 || *hours * 60 + *minutes > 14 * 60) return false;
  *zone = sign * static_cast<int>(*hours * 60 + *minutes);
  return in->AtEnd();
}

std::string FormatCivilDate(const CivilTime& c) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%s%04lld-%02d-%02d", c.year < 0 ? "-" : "",
                static_cast<long long>(std::llabs(c.year)), c.month, c.day);
  return buffer;
}

// hh:mm:ss(.s+)? in microseconds
std::optional<TimeMicros> ReadClock(Reader* in) {
  const auto hour = in->Digits(2, 2);
  if (!hour || !in->Take(':')) return std::nullopt;
  const auto minute = in->Digits(2, 2);
  if (!minute || !in->Take(':')) return std::nullopt;
  const auto second = in->Digits(2, 2);
  if (!second || *minute > 59 || *second > 59) return std::nullopt;
  int64_t fraction = 0;
  if (in->Take('.')) {
    const auto digits = in->Fraction();
    if (!digits) return std::nullopt;
    fraction = *digits;
  }
  const bool midnight = *hour == 24 && *minute == 0 && *second == 0 && fraction == 0;
  if (*hour > 23 && !midnight) return std::nullopt;
  return (*hour * 3600 + *minute * 60 + *second) * kSecond + fraction;
}

std::string FormatClock(const CivilTime& c) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%02d:%02d:%02d", c.hour, c.minute,
                static_cast<int>(c.second_us / kSecond));
  std::string out = buffer;
  if (const int64_t fraction = c.second_us % kSecond; fraction != 0) {
    std::snprintf(buffer, sizeof buffer, ".%06d", static_cast<int>(fraction));
    out += buffer;
    while (out.back() == '0') out.pop_back();
  }
  return out;
}

}  // namespace

int DaysInMonth(int64_t year, int month) {
  static constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return month == 2 && leap ? 29 : kDays[month - 1];
}

TimeMicros TimeOfDay(int64_t year, int month, int day) {
  return DaysFromCivil(year, month, day) * kDay;
}

CivilTime ToCivil(TimeMicros local_time_us) {
  int64_t days = local_time_us / kDay;
  TimeMicros rest = local_time_us % kDay;
  if (rest < 0) {
    rest += kDay;
    --days;
  }
  days += 719468;
  const int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  const int64_t day_of_era = days - era * 146097;
  const int64_t year_of_era =
      (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146096) / 365;
  const int64_t day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  const int64_t month_index = (5 * day_of_year + 2) / 153;
  CivilTime c;
  c.day = static_cast<int>(day_of_year - (153 * month_index + 2) / 5 + 1);
  c.month = static_cast<int>(month_index < 10 ? month_index + 3 : month_index - 9);
  c.year = year_of_era + era * 400 + (c.month <= 2 ? 1 : 0);
  c.hour = static_cast<int>(rest / (3600 * kSecond));
  c.minute = static_cast<int>(rest / (60 * kSecond) % 60);
  c.second_us = rest % (60 * kSecond);
  return c;
}

std::optional<ZonedTime> ParseDateText(std::string_view text) {
  Reader in(text);
  ZonedTime time;
  const auto days = ReadDate(&in);
  if (!days || !ReadZone(&in, &time.zone_minutes)) return std::nullopt;
  time.local_us = *days * kDay;
  return time;
}

std::optional<ZonedTime> ParseDateTimeText(std::string_view text) {
  Reader in(text);
  ZonedTime time;
  const auto days = ReadDate(&in);
  if (!days || !in.Take('T')) return std::nullopt;
  const auto clock = ReadClock(&in);
  if (!clock || !ReadZone(&in, &time.zone_minutes)) return std::nullopt;
  time.local_us = *days * kDay + *clock;
  return time;
}

std::optional<ZonedTime> ParseTimeText(std::string_view text) {
  Reader in(text);
  ZonedTime time;
  const auto clock = ReadClock(&in);
  if (!clock || !ReadZone(&in, &time.zone_minutes)) return std::nullopt;
  time.local_us = *clock % kDay;
  return time;
}

std::string FormatZone(std::optional<int> zone_minutes) {
  if (!zone_minutes) return "";
  if (*zone_minutes == 0) return "Z";
  char buffer[16];
  const int minutes = std::abs(*zone_minutes);
  std::snprintf(buffer, sizeof buffer, "%c%02d:%02d", *zone_minutes < 0 ? '-' : '+', minutes / 60,
                minutes % 60);
  return buffer;
}

std::string FormatDateTimeText(const ZonedTime& time) {
  const CivilTime c = ToCivil(time.local_us);
  return FormatCivilDate(c) + "T" + FormatClock(c) + FormatZone(time.zone_minutes);
}

std::string FormatTimeText(const ZonedTime& time) {
  return FormatClock(ToCivil(time.local_us)) + FormatZone(time.zone_minutes);
}

std::string FormatDateText(const ZonedTime& time) {
  return FormatCivilDate(ToCivil(time.local_us)) + FormatZone(time.zone_minutes);
}

}  // namespace docent::sparql
