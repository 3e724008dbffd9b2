#include "graph/rdf/term_id.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using Tag = TermId::Tag;

constexpr int kScaleBits = 5;
constexpr int64_t kMaxScale = (1 << kScaleBits) - 1;
static_assert(InlineDecimal(TermId::Make(Tag::kDecimal, (1 << kScaleBits) + kMaxScale)).mantissa == 1);
static_assert(InlineDecimal(TermId::Make(Tag::kDecimal, (1 << kScaleBits) + kMaxScale)).scale == kMaxScale);
constexpr int64_t kMantissaLimit = int64_t{1} << 54;  // 55 bits, two's complement
constexpr int64_t kIntegerLimit = int64_t{1} << 59;   // 60 bits, two's complement
constexpr int64_t kTimeLimit = int64_t{1} << 55;      // 56 bits, two's complement
constexpr TimeMicros kDayMicros = 86'400'000'000;
constexpr int64_t kPlainLimit = int64_t{1} << 53;  // a double up to here is exact,
constexpr int64_t kPlainScale = 22;  // and a power of ten up to here: their quotient is rounded once
constexpr int kLeastPower = -26, kPowers = 42;           // of two, of a kNearDouble
constexpr TimeMicros kZonedStart = 946'684'800'000'000;  // 2000-01-01
constexpr int64_t kZonedLimit = int64_t{1} << 51;
constexpr int kQuarters = 56;  // of an hour, in 14 hours

int64_t SignExtend(uint64_t value, int bits) {
  return static_cast<int64_t>(value << (64 - bits)) >> (64 - bits);
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// Reads a whole text of the form -?[0-9]+ without a leading zero or "-0".
std::optional<int64_t> ParseCanonicalInteger(std::string_view text) {
  std::string_view digits = text.starts_with('-') ? text.substr(1) : text;
  if (digits.empty() || (digits[0] == '0' && text.size() > 1)) return std::nullopt;
  int64_t value = 0;
  auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<TermId> EncodeInteger(std::string_view text) {
  const std::optional<int64_t> value = ParseCanonicalInteger(text);
  return value ? InlineIntegerId(*value) : std::nullopt;
}

// The functions below write lexical forms at `out` and return their end; an InlineBuffer is large enough.
char* WriteDecimal(InlineDecimalValue value, char* out) {
  const uint64_t mantissa = static_cast<uint64_t>(value.mantissa);
  if (value.mantissa < 0) *out++ = '-';
  char* end = std::to_chars(out, out + 20, value.mantissa < 0 ? 0 - mantissa : mantissa).ptr;
  if (value.scale == 0) return end;
  const std::ptrdiff_t missing = value.scale + 1 - (end - out);  // zeros before the first digit
  if (missing > 0) {
    std::copy_backward(out, end, end + missing);
    std::fill(out, out + missing, '0');
    end += missing;
  }
  char* const point = end - value.scale;
  std::copy_backward(point, end, end + 1);
  *point = '.';
  return end + 1;
}

// Parses a text that WriteDecimal would write, with a mantissa in [-limit, limit).
std::optional<InlineDecimalValue> ParsePlain(std::string_view text, int64_t limit, int64_t max_scale) {
  std::array<char, 40> digits;
  size_t count = 0;
  int64_t scale = 0;
  bool point = false;
  for (char c : text) {
    if (c == '.' && !point) {
      point = true;
      continue;
    }
    if (count == digits.size() || (!IsDigit(c) && !(c == '-' && count == 0))) return std::nullopt;
    digits[count++] = c;
    scale += point ? 1 : 0;
  }
  int64_t mantissa = 0;
  auto [end, error] = std::from_chars(digits.data(), digits.data() + count, mantissa);
  if (error != std::errc() || end != digits.data() + count || scale > max_scale) return std::nullopt;
  if (mantissa < -limit || mantissa >= limit) return std::nullopt;
  const InlineDecimalValue value{mantissa, static_cast<int>(scale)};
  InlineBuffer buffer;
  if (std::string_view(buffer.data(), WriteDecimal(value, buffer.data())) != text) return std::nullopt;
  return value;
}

std::optional<TermId> EncodeDecimal(std::string_view text) {
  const std::optional<InlineDecimalValue> value = ParsePlain(text, kMantissaLimit, kMaxScale);
  return value ? InlineDecimalId(*value) : std::nullopt;
}

std::optional<TermId> EncodePlainDouble(std::string_view text, bool is_float) {
  const std::optional<InlineDecimalValue> value = ParsePlain(text, kPlainLimit, kPlainScale);
  if (!value) return std::nullopt;
  return TermId::Make(Tag::kPlainDouble, static_cast<uint64_t>(value->mantissa) << (kScaleBits + 1) |
                                             static_cast<uint64_t>(value->scale) << 1 | (is_float ? 1 : 0));
}

InlineDecimalValue PlainDouble(TermId id) {
  return {SignExtend(id.payload(), 60) >> (kScaleBits + 1), static_cast<int>(id.payload() >> 1 & kMaxScale)};
}

// XML Schema 1.0 part 2, section 3.2.5.2: one digit before the point, at least one after it, "E", no plus
// sign.
char* WriteDouble(double value, char* out) {
  const auto write = [&out](std::string_view text) { return std::copy(text.begin(), text.end(), out); };
  if (std::isnan(value)) return write("NaN");
  if (std::isinf(value)) return write(value > 0 ? "INF" : "-INF");
  std::array<char, 40> buffer;
  const char* end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific).ptr;
  const std::string_view text(buffer.data(), static_cast<size_t>(end - buffer.data()));
  const size_t e = text.find('e');
  out = write(text.substr(0, e));
  if (text.find('.') == std::string_view::npos) out = write(".0");
  out = write("E");
  std::string_view power = text.substr(e + 1);  // at least two digits
  if (power.starts_with('-')) out = write("-");
  power.remove_prefix(1);
  if (power.size() > 1 && power[0] == '0') power.remove_prefix(1);
  return write(power);
}

enum class DoubleForm : uint8_t { kCanonical, kFixed, kScientific };

char* WriteShortest(double value, DoubleForm form, char* out) {
  if (form == DoubleForm::kCanonical) return WriteDouble(value, out);
  const auto format = form == DoubleForm::kFixed ? std::chars_format::fixed : std::chars_format::scientific;
  return std::to_chars(out, out + InlineBuffer().size(), value, format).ptr;
}

bool IsWritten(double value, DoubleForm form, std::string_view text) {
  InlineBuffer buffer;
  return std::string_view(buffer.data(), WriteShortest(value, form, buffer.data())) == text;
}

std::optional<TermId> EncodeNearDouble(std::string_view text, double value) {
  const uint64_t bits = std::bit_cast<uint64_t>(value);
  const int power = static_cast<int>(bits >> 52 & 0x7FF) - 1023 - kLeastPower;
  if (power < 0 || power >= kPowers) return std::nullopt;
  const DoubleForm form = text.find('E') != std::string_view::npos   ? DoubleForm::kCanonical
                          : text.find('e') != std::string_view::npos ? DoubleForm::kScientific
                                                                     : DoubleForm::kFixed;
  if (!IsWritten(value, form, text)) return std::nullopt;
  const uint64_t code = static_cast<uint64_t>(form) * kPowers + static_cast<uint64_t>(power);
  return TermId::Make(Tag::kNearDouble, bits >> 63 << 59 | code << 52 | (bits & ((uint64_t{1} << 52) - 1)));
}

DoubleForm NearForm(TermId id) {
  return static_cast<DoubleForm>((id.payload() >> 52 & 0x7F) / kPowers);
}

double NearDouble(TermId id) {
  const uint64_t sign = id.payload() >> 59;
  const uint64_t power =
      static_cast<uint64_t>(static_cast<int>((id.payload() >> 52 & 0x7F) % kPowers) + kLeastPower + 1023);
  return std::bit_cast<double>(sign << 63 | power << 52 | (id.payload() & ((uint64_t{1} << 52) - 1)));
}

std::optional<TermId> EncodeDouble(std::string_view text) {
  double value = 0;
  if (text == "NaN") {
    value = std::numeric_limits<double>::quiet_NaN();
  } else if (text == "INF" || text == "-INF") {
    value =
        text[0] == '-' ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  } else {
    if (std::optional<TermId> plain = EncodePlainDouble(text, false)) return plain;
    auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      return std::nullopt;
  }
  const uint64_t bits = std::bit_cast<uint64_t>(value);
  if ((bits & 15) == 0 && IsWritten(value, DoubleForm::kCanonical, text))
    return TermId::Make(Tag::kDouble, bits >> 4);
  return EncodeNearDouble(text, value);
}

// Days since 1970-01-01 in the proleptic Gregorian calendar and back
// (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms").
int64_t DaysFromCivil(int64_t year, int month, int day) {
  year -= month <= 2;
  int64_t era = (year >= 0 ? year : year - 399) / 400;
  int64_t year_of_era = year - era * 400;
  int64_t day_of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  int64_t day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
  return era * 146097 + day_of_era - 719468;
}

struct Civil {
  int64_t year;
  int month;
  int day;
};

Civil CivilFromDays(int64_t days) {
  days += 719468;
  int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  int64_t day_of_era = days - era * 146097;
  int64_t year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36524 - day_of_era / 146096) / 365;
  int64_t day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
  int64_t month_index = (5 * day_of_year + 2) / 153;
  int day = static_cast<int>(day_of_year - (153 * month_index + 2) / 5 + 1);
  int month = static_cast<int>(month_index < 10 ? month_index + 3 : month_index - 9);
  return {year_of_era + era * 400 + (month <= 2), month, day};
}

// The number in `text[at, at+width)`; -1 if a character there is not a digit. Requires that the range lies
// inside the text.
int Digits(std::string_view text, size_t at, size_t width) {
  int value = 0;
  for (size_t i = at; i < at + width; ++i) {
    if (!IsDigit(text[i])) return -1;
    value = value * 10 + (text[i] - '0');
  }
  return value;
}

// "YYYY-MM-DD" → days; nullopt for years outside 1..9999 and days that do not exist.
std::optional<int64_t> ParseDate(std::string_view text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  int year = Digits(text, 0, 4), month = Digits(text, 5, 2), day = Digits(text, 8, 2);
  if (year < 1 || month < 1 || month > 12 || day < 1) return std::nullopt;
  int64_t days = DaysFromCivil(year, month, day);
  Civil back = CivilFromDays(days);
  if (back.month != month || back.day != day) return std::nullopt;
  return days;
}

std::optional<TermId> EncodeDate(std::string_view text) {
  bool zone = text.ends_with('Z');
  if (zone) text.remove_suffix(1);
  std::optional<int64_t> days = ParseDate(text);
  if (!days) return std::nullopt;
  return TermId::Make(Tag::kDate, static_cast<uint64_t>(*days) << 1 | (zone ? 1 : 0));
}

struct LocalTime {
  int64_t time_us;
  int64_t digits;  // after the second's point
};

// "YYYY-MM-DDThh:mm:ss" and up to 6 digits of the second.
std::optional<LocalTime> ParseLocalTime(std::string_view text) {
  if (text.size() < 19 || text[10] != 'T' || text[13] != ':' || text[16] != ':') return std::nullopt;
  std::optional<int64_t> days = ParseDate(text.substr(0, 10));
  int hour = Digits(text, 11, 2), minute = Digits(text, 14, 2), second = Digits(text, 17, 2);
  if (!days || hour < 0 || hour > 23 || minute < 0 || minute > 59 || second < 0 || second > 59)
    return std::nullopt;
  int64_t digits = 0, fraction_us = 0;
  if (text.size() > 19) {
    digits = static_cast<int64_t>(text.size()) - 20;
    if (text[19] != '.' || digits < 1 || digits > 6) return std::nullopt;
    fraction_us = Digits(text, 20, static_cast<size_t>(digits));
    if (fraction_us < 0) return std::nullopt;
    for (int64_t i = digits; i < 6; ++i) fraction_us *= 10;
  }
  return LocalTime{
      *days * kDayMicros + (hour * 3600 + minute * 60 + second) * int64_t{1'000'000} + fraction_us, digits};
}

// Payload of kZonedDateTime: 51 bits of microseconds since kZonedStart in local time of the zone, 7 bits of
// quarters of an hour beyond -14:00, 2 bits: a third of the number of fraction digits of the second.
std::optional<TermId> EncodeZonedDateTime(std::string_view text) {
  if (text.size() < 25) return std::nullopt;
  const std::string_view offset = text.substr(text.size() - 6);
  if ((offset[0] != '+' && offset[0] != '-') || offset[3] != ':') return std::nullopt;
  const int hours = Digits(offset, 1, 2), minutes = Digits(offset, 4, 2);
  if (hours < 0 || minutes < 0 || minutes > 45 || minutes % 15 != 0) return std::nullopt;
  const int quarters = (offset[0] == '-' ? -1 : 1) * (hours * 4 + minutes / 15);
  if (std::abs(quarters) > kQuarters || (quarters == 0 && offset[0] == '-')) return std::nullopt;
  const std::optional<LocalTime> time = ParseLocalTime(text.substr(0, text.size() - 6));
  if (!time || time->digits % 3 != 0) return std::nullopt;
  const int64_t since = time->time_us - kZonedStart;
  if (since < 0 || since >= kZonedLimit) return std::nullopt;
  return TermId::Make(Tag::kZonedDateTime, static_cast<uint64_t>(since) << 9 |
                                               static_cast<uint64_t>(quarters + kQuarters) << 2 |
                                               static_cast<uint64_t>(time->digits / 3));
}

// Payload of kDateTime: 56 bits of microseconds, 3 bits of digits after the second's point, 1 bit of zone.
std::optional<TermId> EncodeDateTime(std::string_view text) {
  std::string_view local = text;
  const bool zone = local.ends_with('Z');
  if (zone) local.remove_suffix(1);
  const std::optional<LocalTime> time = ParseLocalTime(local);
  if (!time) return EncodeZonedDateTime(text);
  if (time->time_us < -kTimeLimit || time->time_us >= kTimeLimit) return std::nullopt;
  return TermId::Make(Tag::kDateTime, static_cast<uint64_t>(time->time_us) << 4 |
                                          static_cast<uint64_t>(time->digits) << 1 | (zone ? 1 : 0));
}

char* WriteDigits(int64_t value, int width, char* out) {
  for (char* at = out + width; at != out; value /= 10) *--at = static_cast<char>('0' + value % 10);
  return out + width;
}

char* WriteDate(int64_t days, char* out) {
  const Civil date = CivilFromDays(days);
  out = WriteDigits(date.year, 4, out);
  *out++ = '-';
  out = WriteDigits(date.month, 2, out);
  *out++ = '-';
  return WriteDigits(date.day, 2, out);
}

char* WriteLocalTime(const LocalTime& time, char* out) {
  const int64_t days = time.time_us / kDayMicros - (time.time_us % kDayMicros < 0 ? 1 : 0);
  const int64_t of_day_us = time.time_us - days * kDayMicros;
  const int64_t seconds = of_day_us / 1'000'000;
  out = WriteDate(days, out);
  *out++ = 'T';
  out = WriteDigits(seconds / 3600, 2, out);
  *out++ = ':';
  out = WriteDigits(seconds / 60 % 60, 2, out);
  *out++ = ':';
  out = WriteDigits(seconds % 60, 2, out);
  if (time.digits == 0) return out;
  *out++ = '.';
  WriteDigits(of_day_us % 1'000'000, 6, out);
  return out + time.digits;
}

char* WriteDateTime(TermId id, char* out) {
  const InlineTimeValue time = InlineTime(id);
  if (id.tag() == Tag::kDateTime) {
    out = WriteLocalTime({time.local_us, static_cast<int64_t>(id.payload() >> 1 & 7)}, out);
    if (time.zone_minutes) *out++ = 'Z';
    return out;
  }
  out = WriteLocalTime({time.local_us, static_cast<int64_t>(id.payload() & 3) * 3}, out);
  const int zone = std::abs(*time.zone_minutes);
  *out++ = *time.zone_minutes < 0 ? '-' : '+';
  out = WriteDigits(zone / 60, 2, out);
  *out++ = ':';
  return WriteDigits(zone % 60, 2, out);
}

char* WriteInline(TermId id, char* out) {
  switch (id.tag()) {
    case Tag::kInteger:
      return std::to_chars(out, out + InlineBuffer().size(), InlineInteger(id)).ptr;
    case Tag::kDecimal:
      return WriteDecimal(InlineDecimal(id), out);
    case Tag::kDouble:
      return WriteDouble(InlineDouble(id), out);
    case Tag::kPlainDouble:
      return WriteDecimal(PlainDouble(id), out);
    case Tag::kNearDouble:
      return WriteShortest(NearDouble(id), NearForm(id), out);
    case Tag::kBoolean: {
      const std::string_view text = InlineBoolean(id) ? "true" : "false";
      return std::copy(text.begin(), text.end(), out);
    }
    case Tag::kDate:
      out = WriteDate(SignExtend(id.payload(), 60) >> 1, out);
      if ((id.payload() & 1) != 0) *out++ = 'Z';
      return out;
    case Tag::kDateTime:
    case Tag::kZonedDateTime:
      return WriteDateTime(id, out);
    default:
      return out;
  }
}

}  // namespace

std::optional<TermId> InlineLiteral(const Term& term) {
  if (!term.IsLiteral() || !std::string_view(term.datatype).starts_with(kXsdNs)) return std::nullopt;
  if (term.datatype == kXsdInteger) return EncodeInteger(term.lexical);
  if (term.datatype == kXsdDecimal) return EncodeDecimal(term.lexical);
  if (term.datatype == kXsdDouble) return EncodeDouble(term.lexical);
  if (term.datatype == kXsdFloat) return EncodePlainDouble(term.lexical, true);
  if (term.datatype == kXsdDateTime) return EncodeDateTime(term.lexical);
  if (term.datatype == kXsdDate) return EncodeDate(term.lexical);
  if (term.datatype == kXsdBoolean && (term.lexical == "true" || term.lexical == "false")) {
    return TermId::Make(Tag::kBoolean, term.lexical == "true" ? 1 : 0);
  }
  return std::nullopt;
}

std::string_view InlineDatatype(TermId id) {
  switch (id.tag()) {
    case Tag::kInteger:
      return kXsdInteger;
    case Tag::kDecimal:
      return kXsdDecimal;
    case Tag::kDouble:
    case Tag::kNearDouble:
      return kXsdDouble;
    case Tag::kPlainDouble:
      return InlineIsFloat(id) ? kXsdFloat : kXsdDouble;
    case Tag::kBoolean:
      return kXsdBoolean;
    case Tag::kDate:
      return kXsdDate;
    case Tag::kDateTime:
    case Tag::kZonedDateTime:
      return kXsdDateTime;
    default:
      return {};
  }
}

std::string_view WriteInlineText(TermId id, InlineBuffer* buffer) {
  return {buffer->data(), WriteInline(id, buffer->data())};
}

void DecodeInlineTo(TermId id, Term* out) {
  InlineBuffer buffer;
  out->kind = TermKind::kLiteral;
  Overwrite(&out->lexical, WriteInlineText(id, &buffer));
  Overwrite(&out->datatype, InlineDatatype(id));
  out->language.clear();
}

Term DecodeInline(TermId id) {
  Term term;
  DecodeInlineTo(id, &term);
  return term;
}

std::optional<TermId> InlineIntegerId(int64_t value) {
  if (value < -kIntegerLimit || value >= kIntegerLimit) return std::nullopt;
  return TermId::Make(Tag::kInteger, static_cast<uint64_t>(value));
}

std::optional<TermId> InlineDecimalId(InlineDecimalValue value) {
  if (value.mantissa < -kMantissaLimit || value.mantissa >= kMantissaLimit || value.scale > kMaxScale)
    return std::nullopt;
  return TermId::Make(Tag::kDecimal, static_cast<uint64_t>(value.mantissa) << kScaleBits |
                                         static_cast<uint64_t>(value.scale));
}

double InlineDouble(TermId id) {
  if (id.tag() == Tag::kDouble) return std::bit_cast<double>(id.payload() << 4);
  if (id.tag() == Tag::kNearDouble) return NearDouble(id);
  static constexpr std::array<double, kPlainScale + 1> kTens = {
      1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const InlineDecimalValue plain = PlainDouble(id);
  const double value = static_cast<double>(plain.mantissa) / kTens[static_cast<size_t>(plain.scale)];
  return InlineIsFloat(id) ? static_cast<double>(static_cast<float>(value)) : value;
}

InlineTimeValue InlineTime(TermId id) {
  if (id.tag() == Tag::kZonedDateTime) {
    const int quarters = static_cast<int>(id.payload() >> 2 & 0x7F) - kQuarters;
    return {kZonedStart + static_cast<int64_t>(id.payload() >> 9), quarters * 15};
  }
  const std::optional<int> zone = (id.payload() & 1) != 0 ? std::optional<int>(0) : std::nullopt;
  int64_t value = SignExtend(id.payload(), 60);
  if (id.tag() == Tag::kDate) return {(value >> 1) * kDayMicros, zone};
  return {value >> 4, zone};
}

}  // namespace docent
