#include "reasoner/shapes/datatype_check.h"

#include <algorithm>
#include <array>
#include <string>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/time_text.h"

namespace docent::shapes {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool AllDigits(std::string_view text) {
  for (const char c : text) {
    if (!IsDigit(c)) return false;
  }
  return !text.empty();
}

// [+-]?[0-9]+ without leading zeros and without the sign of zero: a number of any size as text.
struct BigInteger {
  bool negative = false;
  std::string_view digits;  // no leading zeros; "0" is "0"
};
std::optional<BigInteger> ReadInteger(std::string_view text) {
  BigInteger number;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    number.negative = text[0] == '-';
    text.remove_prefix(1);
  }
  if (!AllDigits(text)) return std::nullopt;
  while (text.size() > 1 && text[0] == '0') text.remove_prefix(1);
  number.digits = text;
  if (text == "0") number.negative = false;
  return number;
}

bool AtMost(std::string_view digits, std::string_view limit) {
  return digits.size() < limit.size() || (digits.size() == limit.size() && digits <= limit);
}

// Section 3.4.13 and following: the types derived from xsd:integer, with the magnitudes of their bounds ("":
// none).
struct IntegerType {
  std::string_view name, base, lowest, highest;
};
constexpr std::array<IntegerType, 13> kIntegerTypes = {{
    {"integer", "decimal", "", ""},
    {"nonPositiveInteger", "integer", "", "-0"},
    {"negativeInteger", "nonPositiveInteger", "", "-1"},
    {"nonNegativeInteger", "integer", "0", ""},
    {"positiveInteger", "nonNegativeInteger", "1", ""},
    {"long", "integer", "-9223372036854775808", "9223372036854775807"},
    {"int", "long", "-2147483648", "2147483647"},
    {"short", "int", "-32768", "32767"},
    {"byte", "short", "-128", "127"},
    {"unsignedLong", "nonNegativeInteger", "0", "18446744073709551615"},
    {"unsignedInt", "unsignedLong", "0", "4294967295"},
    {"unsignedShort", "unsignedInt", "0", "65535"},
    {"unsignedByte", "unsignedShort", "0", "255"},
}};

// a <= b, where either is written "-digits" or "digits".
bool NotAbove(const BigInteger& a, const BigInteger& b) {
  if (a.negative != b.negative) return a.negative;
  return a.negative ? AtMost(b.digits, a.digits) : AtMost(a.digits, b.digits);
}

bool IsIntegerOf(const IntegerType& type, std::string_view text) {
  const std::optional<BigInteger> number = ReadInteger(text);
  if (!number) return false;
  if (!type.lowest.empty() && !NotAbove(*ReadInteger(type.lowest), *number)) return false;
  return type.highest.empty() || NotAbove(*number, *ReadInteger(type.highest));
}

// [+-]?([0-9]+(.[0-9]*)?|.[0-9]+)
bool IsDecimal(std::string_view text) {
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) text.remove_prefix(1);
  const size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  const std::string_view part = point == std::string_view::npos ? std::string_view() : text.substr(point + 1);
  if (whole.empty() && part.empty()) return false;
  return (whole.empty() || AllDigits(whole)) && (part.empty() || AllDigits(part));
}

bool IsDouble(std::string_view text) {
  if (text == "INF" || text == "+INF" || text == "-INF" || text == "NaN") return true;
  const size_t e = text.find_first_of("eE");
  if (!IsDecimal(text.substr(0, e))) return false;
  return e == std::string_view::npos || ReadInteger(text.substr(e + 1)).has_value();
}

// The zone at the end (section D.3.1: timezoneFrag), or empty.
std::string_view ZoneOf(std::string_view text) {
  if (text.ends_with('Z')) return text.substr(text.size() - 1);
  if (text.size() < 6) return {};
  const std::string_view zone = text.substr(text.size() - 6);
  const bool is_zone = (zone[0] == '+' || zone[0] == '-') && AllDigits(zone.substr(1, 2)) && zone[3] == ':' &&
                       AllDigits(zone.substr(4));
  return is_zone ? zone : std::string_view();
}

// Checks a part of a date by completing it.
bool IsDatePart(std::string_view before, std::string_view text, std::string_view after) {
  const std::string_view zone = ZoneOf(text);
  const std::string_view part = text.substr(0, text.size() - zone.size());
  return sparql::ParseDateText(Concat(before, part, after, zone)).has_value();
}

// PnYnMnDTnHnMn.nS (section 3.3.6.2): checks the order of the designators; at least one, and one after T.
bool IsDuration(std::string_view text, std::string_view date_parts, std::string_view time_parts) {
  if (text.starts_with('-')) text.remove_prefix(1);
  if (!text.starts_with('P')) return false;
  text.remove_prefix(1);
  std::string_view parts = date_parts;
  bool any = false, after_t = false, any_after_t = false;
  while (!text.empty()) {
    if (text[0] == 'T') {
      if (after_t) return false;
      after_t = true;
      parts = time_parts;
      text.remove_prefix(1);
      continue;
    }
    const size_t end = text.find_first_not_of("0123456789.");
    if (end == std::string_view::npos || end == 0) return false;
    const size_t at = parts.find(text[end]);
    if (at == std::string_view::npos) return false;
    const std::string_view number = text.substr(0, end);
    if (text[end] == 'S' ? !(IsDecimal(number) && IsDigit(number[0]) && IsDigit(number.back()))
                         : !AllDigits(number)) {
      return false;
    }
    parts.remove_prefix(at + 1);
    any = true;
    any_after_t = any_after_t || after_t;
    text.remove_prefix(end + 1);
  }
  return any && (!after_t || any_after_t);
}

bool IsHex(std::string_view text) {
  return text.size() % 2 == 0 && text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

// Section 3.3.16: groups of four symbols; the bits that no byte uses in the last group are zero.
bool IsBase64(std::string_view text) {
  constexpr std::string_view kZeroOfFour = "AQgw", kZeroOfTwo = "AEIMQUYcgkosw048";
  size_t symbols = 0, padding = 0;
  char last = 0;
  for (const char c : text) {
    if (c == ' ') continue;
    const bool letter =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || IsDigit(c) || c == '+' || c == '/';
    if (c == '=') {
      ++padding;
    } else if (!letter || padding > 0) {
      return false;
    } else {
      last = c;
    }
    ++symbols;
  }
  if (symbols % 4 != 0 || padding > 2) return false;
  return padding == 0 || (padding == 2 ? kZeroOfFour : kZeroOfTwo).find(last) != std::string_view::npos;
}

// Name, NCName (no colons) and Nmtoken (any character may be the first) of XML, sections 3.4.6, 3.4.7 and 3.4.4.
bool IsXmlName(std::string_view text, bool colons, bool any_first) {
  if (FindInvalidUtf8(text)) return false;
  for (size_t at = 0; at < text.size();) {
    const bool first = at == 0 && !any_first;
    const char32_t c = NextCodePoint(text, &at);
    if (c == ':' ? !colons : !(first ? IsNameStart(c) : IsNameChar(c) || c == '.')) return false;
  }
  return !text.empty();
}

// [a-zA-Z]{1,8}(-[a-zA-Z0-9]{1,8})*
bool IsLanguageTag(std::string_view text) {
  size_t run = 0;
  bool first = true;
  for (const char c : text) {
    if (c == '-') {
      if (run == 0) return false;
      run = 0;
      first = false;
      continue;
    }
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (!letter && (first || !IsDigit(c))) return false;
    if (++run > 8) return false;
  }
  return run > 0;
}

// With the year (section D.3.1: yearFrag), which may be of any length, as one of four digits with the same leap days;
// nullopt: the text does not begin with a year.
std::optional<std::string> WithShortYear(std::string_view text) {
  const bool negative = text.starts_with('-');
  const size_t begin = negative ? 1 : 0;
  const size_t end = std::min(text.find_first_not_of("0123456789", begin), text.size());
  const std::string_view digits = text.substr(begin, end - begin);
  if (digits.size() < 4 || (digits.size() > 4 && digits[0] == '0')) return std::nullopt;
  int of_cycle = 0;  // the calendar repeats itself after 400 years
  for (const char c : digits) of_cycle = (of_cycle * 10 + (c - '0')) % 400;
  return absl::StrCat(2000 + (negative ? (400 - of_cycle) % 400 : of_cycle), ToAbsl(text.substr(end)));
}

bool IsTimeOfShortYear(std::string_view name, std::string_view text) {
  if (name == "dateTime") return sparql::ParseDateTimeText(text).has_value();
  if (name == "dateTimeStamp") {
    const auto time = sparql::ParseDateTimeText(text);
    return time && time->zone_minutes.has_value();
  }
  if (name == "date") return sparql::ParseDateText(text).has_value();
  if (name == "time") return sparql::ParseDateTimeText(Concat("2000-01-01T", text)).has_value();
  if (name == "gYear") return IsDatePart("", text, "-01-01");
  if (name == "gYearMonth") return IsDatePart("", text, "-01");
  if (name == "gMonth") return text.starts_with("--") && IsDatePart("2000-", text.substr(2), "-01");
  if (name == "gMonthDay") return text.starts_with("--") && IsDatePart("2000-", text.substr(2), "");
  return text.starts_with("---") && IsDatePart("2000-01-", text.substr(3), "");  // gDay
}

bool IsTime(std::string_view name, std::string_view text) {
  if (name == "dateTime" || name == "dateTimeStamp" || name == "date" || name.starts_with("gYear")) {
    const std::optional<std::string> dated = WithShortYear(text);
    return dated && IsTimeOfShortYear(name, *dated);
  }
  return IsTimeOfShortYear(name, text);
}

constexpr std::array<std::string_view, 9> kTimeTypes = {
    "dateTime", "dateTimeStamp", "date", "time", "gYear", "gYearMonth", "gMonth", "gMonthDay", "gDay"};

}  // namespace

std::optional<bool> IsValidLexicalForm(std::string_view text, std::string_view datatype) {
  if (datatype == kRdfLangString) return true;
  if (!datatype.starts_with(kXsdNs)) return std::nullopt;
  const std::string_view name = datatype.substr(kXsdNs.size());
  for (const IntegerType& type : kIntegerTypes) {
    if (name == type.name) return IsIntegerOf(type, text);
  }
  for (const std::string_view type : kTimeTypes) {
    if (name == type) return IsTime(name, text);
  }
  if (name == "string" || name == "anyURI") return true;  // XSD 1.1, section 3.3.17: any text is an anyURI
  if (name == "boolean") return text == "true" || text == "false" || text == "1" || text == "0";
  if (name == "decimal") return IsDecimal(text);
  if (name == "double" || name == "float") return IsDouble(text);
  if (name == "duration") return IsDuration(text, "YMD", "HMS");
  if (name == "yearMonthDuration") return IsDuration(text, "YM", "");
  if (name == "dayTimeDuration") return IsDuration(text, "D", "HMS");
  if (name == "hexBinary") return IsHex(text);
  if (name == "base64Binary") return IsBase64(text);
  if (name == "language") return IsLanguageTag(text);
  if (name == "Name") return IsXmlName(text, true, false);
  if (name == "NCName") return IsXmlName(text, false, false);
  if (name == "NMTOKEN") return IsXmlName(text, true, true);
  if (name == "normalizedString") return text.find_first_of("\t\n\r") == std::string_view::npos;
  if (name == "token") {
    return text.find_first_of("\t\n\r") == std::string_view::npos &&
           text.find("  ") == std::string_view::npos && !text.starts_with(' ') && !text.ends_with(' ');
  }
  return std::nullopt;
}

bool IsDerivedDatatype(std::string_view datatype, std::string_view base) {
  if (datatype == base) return true;
  if (!datatype.starts_with(kXsdNs) || !base.starts_with(kXsdNs)) return false;
  std::string_view name = datatype.substr(kXsdNs.size());
  const std::string_view wanted = base.substr(kXsdNs.size());
  if (name == "dateTimeStamp") return wanted == "dateTime";
  if (name == "NCName" && wanted == "Name") return true;
  if (name == "NCName" || name == "Name" || name == "NMTOKEN" || name == "language")
    return wanted == "token" || wanted == "normalizedString" || wanted == "string";
  if (name == "token") return wanted == "normalizedString" || wanted == "string";
  if (name == "normalizedString") return wanted == "string";
  if (name == "yearMonthDuration" || name == "dayTimeDuration") return wanted == "duration";
  for (size_t steps = 0; steps < kIntegerTypes.size(); ++steps) {
    bool found = false;
    for (const IntegerType& type : kIntegerTypes) {
      if (type.name != name) continue;
      name = type.base;
      found = true;
      break;
    }
    if (!found) return false;
    if (name == wanted) return true;
  }
  return false;
}

}  // namespace docent::shapes
