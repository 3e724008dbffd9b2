// Times and durations in expressions: XPath and XQuery Functions 3.1 sections 8 to 10 and 19.
#include <algorithm>
#include <cmath>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/value.h"

namespace docent::sparql {

using Type = Value::Type;

namespace {

constexpr TimeMicros kDayMicros = TimeMicros{86'400} * 1'000'000;

TimeMicros StartOfDay(TimeMicros local_us) {
  const TimeMicros rest = local_us % kDayMicros;
  return local_us - rest - (rest < 0 ? kDayMicros : 0);
}

// The digits of a second's fraction beyond the microsecond, as written, without trailing zeros.
std::string_view FinerDigits(const Value& v) {
  constexpr size_t kKept = 6;
  std::string_view text = v.text();
  const size_t point = text.find('.');
  if (point == std::string_view::npos) return {};
  text.remove_prefix(point + 1);
  text = text.substr(0, std::min(text.size(), text.find_first_not_of("0123456789")));
  text = text.substr(std::min(text.size(), kKept));
  return text.substr(0, text.find_last_not_of('0') + 1);
}

Value Shifted(const Value& time, const Duration& duration) {
  if (time.type() == Type::kTime) {  // within the day
    if (!duration.IsDayTime()) return Value::Error();
    const TimeMicros local_us = time.local_time_us() + duration.time_us % kDayMicros;
    return Value::OfTime(Type::kTime, local_us - StartOfDay(local_us), time.zone_minutes());
  }
  const std::optional<TimeMicros> later = Plus(time.local_time_us(), duration);
  if (!later) return Value::Error();
  return Value::OfTime(time.type(), time.type() == Type::kDate ? StartOfDay(*later) : *later,
                       time.zone_minutes());
}

Value OfResult(const std::optional<Duration>& duration) {
  return duration ? Value::OfDuration(*duration) : Value::Error();
}

}  // namespace

std::optional<int> CompareTimes(const Value& a, const Value& b) {
  if (a.zone_minutes().has_value() != b.zone_minutes().has_value()) {
    constexpr TimeMicros kWindow = TimeMicros{14} * 3600 * 1'000'000;
    if (std::abs(a.instant_us() - b.instant_us()) <= kWindow) return std::nullopt;
  }
  return CompareTimesForOrder(a, b);
}

int CompareTimesForOrder(const Value& a, const Value& b) {
  const TimeMicros x = a.instant_us(), y = b.instant_us();
  if (x != y) return x < y ? -1 : 1;
  if (a.text().empty() && b.text().empty()) return 0;
  const int order = FinerDigits(a).compare(FinerDigits(b));
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

Value ComputeTimes(Arithmetic operation, const Value& a, const Value& b) {
  const bool adds = operation == Arithmetic::kAdd, subtracts = operation == Arithmetic::kSubtract;
  if (a.IsTime() && b.type() == a.type() && subtracts) {
    TimeMicros difference = 0;
    if (__builtin_sub_overflow(a.instant_us(), b.instant_us(), &difference)) return Value::Error();
    return Value::OfDuration({Duration::Kind::kDayTime, 0, difference});
  }
  if (a.IsTime() && b.type() == Type::kDuration && (adds || subtracts)) {
    return Shifted(a, adds ? b.duration() : Negative(b.duration()));
  }
  if (a.type() == Type::kDuration && b.IsTime() && adds) return Shifted(b, a.duration());
  if (a.type() == Type::kDuration && b.type() == Type::kDuration) {
    if (adds || subtracts) return OfResult(Add(a.duration(), adds ? b.duration() : Negative(b.duration())));
    if (operation != Arithmetic::kDivide) return Value::Error();
    const std::optional<Decimal> ratio = Divide(a.duration(), b.duration());
    return ratio ? Value::OfDecimal(*ratio) : Value::Error();
  }
  if (a.IsNumeric() && b.type() == Type::kDuration && operation == Arithmetic::kMultiply)
    return ComputeTimes(operation, b, a);
  if (a.type() != Type::kDuration || !b.IsNumeric() || adds || subtracts) return Value::Error();
  if (operation == Arithmetic::kMultiply) {
    return OfResult(b.IsExact() ? Multiply(a.duration(), b.decimal()) : Multiply(a.duration(), b.number()));
  }
  return OfResult(b.IsExact() ? Divide(a.duration(), b.decimal()) : Divide(a.duration(), b.number()));
}

Value CastTime(std::string_view datatype, const Value& v) {
  if (v.type() == Type::kDuration) {
    const Duration from = v.duration();
    const auto kind = FindDurationKind(datatype.substr(std::min(datatype.size(), kXsdNs.size())));
    if (!kind) return Value::Error();
    return Value::OfDuration({*kind, *kind == Duration::Kind::kDayTime ? 0 : from.months,
                              *kind == Duration::Kind::kYearMonth ? 0 : from.time_us});
  }
  const Type to = datatype == kXsdDateTime ? Type::kDateTime
                  : datatype == kXsdDate   ? Type::kDate
                  : datatype == kXsdTime   ? Type::kTime
                                           : Type::kError;
  if (to == v.type()) return v;
  if (v.type() == Type::kTime || to == Type::kError || (v.type() == Type::kDate && to == Type::kTime))
    return Value::Error();
  const TimeMicros local_us = v.local_time_us(), day = StartOfDay(local_us);
  return Value::OfTime(to,
                       to == Type::kDate   ? day
                       : to == Type::kTime ? local_us - day
                                           : local_us,
                       v.zone_minutes());
}

}  // namespace docent::sparql
