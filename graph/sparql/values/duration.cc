#include "graph/sparql/values/duration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "graph/sparql/values/time_text.h"
#include "graph/sparql/values/value.h"

namespace docent::sparql {
namespace {

using Kind = Duration::Kind;

constexpr TimeMicros kSecond = 1'000'000, kMinute = 60 * kSecond, kHour = 60 * kMinute, kDay = 24 * kHour;

// Adds value * unit.
bool AddTo(int64_t* sum, int64_t value, int64_t unit) {
  int64_t part = 0;
  return !__builtin_mul_overflow(value, unit, &part) && !__builtin_add_overflow(*sum, part, sum);
}

// Reads "12Y": the number, and the letter after it. False if the number is too large.
bool TakePart(std::string_view* text, int64_t* value, int64_t* fraction_us, char* letter) {
  size_t n = 0;
  *value = *fraction_us = 0;
  for (; n < text->size() && (*text)[n] >= '0' && (*text)[n] <= '9'; ++n) {
    if (__builtin_mul_overflow(*value, int64_t{10}, value) ||
        __builtin_add_overflow(*value, int64_t{(*text)[n] - '0'}, value))
      return false;
  }
  if (n == 0) return false;
  const bool point = n < text->size() && (*text)[n] == '.';
  if (point) {
    const size_t begin = ++n;
    int64_t unit = kSecond / 10;
    for (; n < text->size() && (*text)[n] >= '0' && (*text)[n] <= '9'; ++n, unit /= 10) {
      if (unit == 0 && (*text)[n] != '0') return false;
      *fraction_us += unit * ((*text)[n] - '0');
    }
    if (n == begin) return false;
  }
  if (n >= text->size() || (point && (*text)[n] != 'S')) return false;
  *letter = (*text)[n];
  text->remove_prefix(n + 1);
  return true;
}

void AppendPart(std::string* out, int64_t value, char letter) {
  if (value != 0) *out += std::to_string(value) + letter;
}

// The nearest whole number to value / by, halves up; by > 0.
Int128 RoundedQuotient(Int128 value, Int128 by) {
  Int128 quotient = value / by, rest = value % by;
  if (rest < 0) {
    rest += by;
    --quotient;
  }
  return quotient + (rest >= by - rest ? 1 : 0);
}

std::optional<int64_t> Narrow(Int128 value) {
  if (value < std::numeric_limits<int64_t>::min() || value > std::numeric_limits<int64_t>::max())
    return std::nullopt;
  return static_cast<int64_t>(value);
}

std::optional<int64_t> Narrow(double value) {
  const double rounded = std::floor(value + 0.5);
  if (!(std::abs(rounded) < 0x1p62)) return std::nullopt;  // NaN, too
  return static_cast<int64_t>(rounded);
}

// The duration with its only part changed.
template <typename Change>
std::optional<Duration> WithPart(const Duration& duration, Change change) {
  Duration out = duration;
  if (duration.IsDayTime()) {
    const std::optional<int64_t> time_us = change(duration.time_us);
    if (time_us) out.time_us = *time_us;
    return time_us ? std::optional(out) : std::nullopt;
  }
  if (!duration.IsYearMonth()) return std::nullopt;
  const std::optional<int64_t> months = change(duration.months);
  if (months) out.months = *months;
  return months ? std::optional(out) : std::nullopt;
}

// value * numerator / denominator
std::optional<int64_t> Scaled(int64_t value, Int128 numerator, Int128 denominator) {
  if (denominator < 0) {
    numerator = -numerator;
    denominator = -denominator;
  }
  Int128 product = 0;
  if (__builtin_mul_overflow(Int128{value}, numerator, &product)) return std::nullopt;
  return Narrow(RoundedQuotient(product, denominator));
}

std::optional<Int128> PowerOfTen(int digits) {
  Int128 power = 1;
  for (int i = 0; i < digits; ++i) {
    if (__builtin_mul_overflow(power, Int128{10}, &power)) return std::nullopt;
  }
  return power;
}

}  // namespace

std::optional<Duration> ParseDuration(std::string_view text, Kind kind) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  if (!text.starts_with('P') || text.size() < 3 || text.ends_with('T')) return std::nullopt;
  text.remove_prefix(1);
  Duration out{kind, 0, 0};
  std::string_view letters = kind == Kind::kDayTime ? "D" : kind == Kind::kYearMonth ? "YM" : "YMD";
  bool clock = false;  // after the T
  while (!text.empty()) {
    if (!clock && kind != Kind::kYearMonth && text.starts_with('T')) {
      clock = true;
      letters = "HMS";
      text.remove_prefix(1);
    }
    int64_t value = 0, fraction_us = 0;
    char letter = 0;
    if (!TakePart(&text, &value, &fraction_us, &letter)) return std::nullopt;
    const size_t at = letters.find(letter);
    if (at == std::string_view::npos) return std::nullopt;
    letters.remove_prefix(at + 1);  // each once, in this order
    const bool fits = letter == 'Y'             ? AddTo(&out.months, value, 12)
                      : letter == 'M' && !clock ? AddTo(&out.months, value, 1)
                      : letter == 'D'           ? AddTo(&out.time_us, value, kDay)
                      : letter == 'H'           ? AddTo(&out.time_us, value, kHour)
                      : letter == 'M'
                          ? AddTo(&out.time_us, value, kMinute)
                          : AddTo(&out.time_us, value, kSecond) && AddTo(&out.time_us, fraction_us, 1);
    if (!fits) return std::nullopt;
  }
  return negative ? Negative(out) : out;
}

std::string ToString(const Duration& duration) {
  if (duration.months == 0 && duration.time_us == 0)
    return duration.kind == Kind::kYearMonth ? "P0M" : "PT0S";
  std::string out = duration.months < 0 || duration.time_us < 0 ? "-P" : "P";
  const int64_t months = std::abs(duration.months), time_us = std::abs(duration.time_us);
  AppendPart(&out, months / 12, 'Y');
  AppendPart(&out, months % 12, 'M');
  AppendPart(&out, time_us / kDay, 'D');
  if (time_us % kDay == 0) return out;
  out += 'T';
  AppendPart(&out, time_us % kDay / kHour, 'H');
  AppendPart(&out, time_us % kHour / kMinute, 'M');
  if (time_us % kMinute != 0) out += Decimal{time_us % kMinute, 6}.ToString() + "S";
  return out;
}

std::optional<Kind> FindDurationKind(std::string_view local_name) {
  if (local_name == "dayTimeDuration") return Kind::kDayTime;
  if (local_name == "yearMonthDuration") return Kind::kYearMonth;
  if (local_name == "duration") return Kind::kDuration;
  return std::nullopt;
}

std::string_view DatatypeOf(Kind kind) {
  switch (kind) {
    case Kind::kDayTime:
      return "http://www.w3.org/2001/XMLSchema#dayTimeDuration";
    case Kind::kYearMonth:
      return "http://www.w3.org/2001/XMLSchema#yearMonthDuration";
    default:
      return "http://www.w3.org/2001/XMLSchema#duration";
  }
}

std::optional<Duration> Add(const Duration& a, const Duration& b) {
  Duration sum = a;
  if (a.kind != b.kind) sum.kind = Kind::kDuration;
  if (__builtin_add_overflow(a.months, b.months, &sum.months) ||
      __builtin_add_overflow(a.time_us, b.time_us, &sum.time_us) || (sum.months < 0 && sum.time_us > 0) ||
      (sum.months > 0 && sum.time_us < 0) || sum.months == std::numeric_limits<int64_t>::min() ||
      sum.time_us == std::numeric_limits<int64_t>::min()) {
    return std::nullopt;
  }
  return sum;
}

std::optional<Duration> Multiply(const Duration& duration, const Decimal& by) {
  const std::optional<Int128> power = PowerOfTen(by.scale);
  if (!power) return std::nullopt;
  return WithPart(duration, [&](int64_t value) { return Scaled(value, by.mantissa, *power); });
}
std::optional<Duration> Multiply(const Duration& duration, double by) {
  return WithPart(duration, [&](int64_t value) { return Narrow(static_cast<double>(value) * by); });
}
std::optional<Duration> Divide(const Duration& duration, const Decimal& by) {
  const std::optional<Int128> power = PowerOfTen(by.scale);
  if (!power || by.mantissa == 0) return std::nullopt;
  return WithPart(duration, [&](int64_t value) { return Scaled(value, *power, by.mantissa); });
}
std::optional<Duration> Divide(const Duration& duration, double by) {
  if (by == 0 || std::isnan(by)) return std::nullopt;
  return WithPart(duration, [&](int64_t value) { return Narrow(static_cast<double>(value) / by); });
}
std::optional<Decimal> Divide(const Duration& a, const Duration& b) {
  if (a.IsDayTime() && b.IsDayTime()) return Divide(Decimal::Of(a.time_us), Decimal::Of(b.time_us));
  if (a.IsYearMonth() && b.IsYearMonth()) return Divide(Decimal::Of(a.months), Decimal::Of(b.months));
  return std::nullopt;
}

Duration Negative(const Duration& duration) {
  return {duration.kind, -duration.months, -duration.time_us};
}

std::optional<int> Compare(const Duration& a, const Duration& b) {
  if (Equal(a, b)) return 0;
  if (a.IsDayTime() && b.IsDayTime()) return a.time_us < b.time_us ? -1 : 1;
  if (a.IsYearMonth() && b.IsYearMonth()) return a.months < b.months ? -1 : 1;
  return std::nullopt;
}

int CompareForOrder(const Duration& a, const Duration& b) {
  constexpr Int128 kMonthMicros = Int128{2'629'746} * kSecond;  // a twelfth of 365.2425 days
  const Int128 x = kMonthMicros * a.months + a.time_us, y = kMonthMicros * b.months + b.time_us;
  if (x != y) return x < y ? -1 : 1;
  return a.months < b.months ? -1 : a.months > b.months ? 1 : 0;
}

std::optional<TimeMicros> Plus(TimeMicros local_us, const Duration& duration) {
  constexpr int64_t kMostYears = 200'000;  // as ParseDateTimeText reads
  if (duration.months != 0) {
    const CivilTime c = ToCivil(local_us);
    if (std::abs(duration.months) > 24 * kMostYears) return std::nullopt;
    const int64_t months = c.year * 12 + (c.month - 1) + duration.months;
    const int64_t year = months >= 0 ? months / 12 : (months - 11) / 12;
    const int month = static_cast<int>(months - year * 12) + 1;
    if (std::abs(year) > kMostYears) return std::nullopt;
    const TimeMicros day = TimeOfDay(year, month, std::min(c.day, DaysInMonth(year, month)));
    local_us = day + c.hour * kHour + c.minute * kMinute + c.second_us;
  }
  if (__builtin_add_overflow(local_us, duration.time_us, &local_us)) return std::nullopt;
  if (std::abs(ToCivil(local_us).year) > kMostYears) return std::nullopt;
  return local_us;
}

}  // namespace docent::sparql
