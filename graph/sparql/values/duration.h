// xsd:duration, xsd:dayTimeDuration and xsd:yearMonthDuration (XML Schema 1.1 part 2, sections 3.3.6 and
// 3.4.26 to 3.4.27), with the operators of XPath and XQuery Functions 3.1 sections 8 and 9.7. Pure functions
// of values; any thread.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_DURATION_H_
#define DOCENT_GRAPH_SPARQL_VALUES_DURATION_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "graph/base/clock.h"
#include "graph/sparql/values/decimal.h"

namespace docent::sparql {

struct Duration {
  enum class Kind : uint8_t { kDuration, kDayTime, kYearMonth };

  Kind kind = Kind::kDuration;
  int64_t months = 0;
  TimeMicros time_us = 0;  // never of the opposite sign to `months`

  // True by its type, or because all other parts are zero.
  bool IsDayTime() const { return kind == Kind::kDayTime || (kind == Kind::kDuration && months == 0); }
  bool IsYearMonth() const { return kind == Kind::kYearMonth || (kind == Kind::kDuration && time_us == 0); }
};

// "-P1Y2M3DT4H5M6.7S". nullopt if it is not valid, not of that kind, finer than a microsecond, or longer than
// 292,000 years.
std::optional<Duration> ParseDuration(std::string_view text, Duration::Kind kind);
// The canonical form: "P1DT2H", "P1Y", "PT0S", "P0M".
std::string ToString(const Duration& duration);
// By the local name of the type in XML Schema: "dayTimeDuration".
std::optional<Duration::Kind> FindDurationKind(std::string_view local_name);
std::string_view DatatypeOf(Duration::Kind kind);  // xsd:…

// Of different kinds: an xsd:duration. nullopt: too long, or months and time of opposite signs.
std::optional<Duration> Add(const Duration& a, const Duration& b);
// Months are rounded to whole months, times to microseconds, halves up. nullopt for a zero divisor, NaN and
// infinity, for results that are too long, and for durations with both months and time.
std::optional<Duration> Multiply(const Duration& duration, const Decimal& by);
std::optional<Duration> Multiply(const Duration& duration, double by);
std::optional<Duration> Divide(const Duration& duration, const Decimal& by);
std::optional<Duration> Divide(const Duration& duration, double by);
std::optional<Decimal> Divide(const Duration& a, const Duration& b);  // both of one kind
Duration Negative(const Duration& duration);

inline bool Equal(const Duration& a, const Duration& b) {
  return a.months == b.months && a.time_us == b.time_us;
}
// Negative, zero, positive; nullopt: not comparable, as a month and 30 days.
std::optional<int> Compare(const Duration& a, const Duration& b);
// A total order: months count as 30.436875 days.
int CompareForOrder(const Duration& a, const Duration& b);

// A local time plus a duration: months first; a day that the month does not have becomes its last day (XML
// Schema 1.1 part 2, section E.3.3). nullopt beyond the supported years.
std::optional<TimeMicros> Plus(TimeMicros local_us, const Duration& duration);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_DURATION_H_
