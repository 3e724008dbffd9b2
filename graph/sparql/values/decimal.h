// Exact decimal numbers of up to 38 digits: xsd:decimal, and xsd:integer as scale 0 (XML Schema part 2
// requires at least 18 digits). An operation whose exact result does not fit is an error, never a rounded
// value; only division rounds (to 18 digits after the point, toward zero). Values; any thread.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_DECIMAL_H_
#define DOCENT_GRAPH_SPARQL_VALUES_DECIMAL_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace docent::sparql {

__extension__ typedef __int128 Int128;

// 38 digits: 10^38 - 1. What is parsed or computed has no larger mantissa.
inline constexpr Int128 kMaxMantissa = [] {
  Int128 power = 1;
  for (int i = 0; i < 38; ++i) power *= 10;
  return power - 1;
}();

// mantissa / 10^scale, scale >= 0.
struct Decimal {
  Int128 mantissa = 0;
  int scale = 0;

  static Decimal Of(int64_t value) { return {value, 0}; }
  // [+-]?[0-9]*(.[0-9]*)? with at least one digit; nullopt if it is not that or has too many digits.
  static std::optional<Decimal> Parse(std::string_view text);
  // As Parse, without a point.
  static std::optional<Decimal> ParseInteger(std::string_view text);

  // Without trailing zeros after the point, without a point if whole: "1.5", "-3".
  std::string ToString() const;
  double ToDouble() const;
  bool IsZero() const { return mantissa == 0; }
  // Whole numbers, made by dropping the digits after the point in the stated direction (XPath fn:floor,
  // fn:ceiling, fn:round: half rounds toward positive infinity).
  Decimal Floor() const;
  Decimal Ceiling() const;
  Decimal Round() const;
};

// 10^0 to the largest power that fits.
inline constexpr std::array<int64_t, 19> kPowersOfTen = [] {
  std::array<int64_t, 19> powers = {1};
  for (size_t i = 1; i < powers.size(); ++i) powers[i] = powers[i - 1] * 10;
  return powers;
}();

// Drops trailing zeros after the point.
Decimal Normalised(Decimal d);
std::optional<Decimal> Add(const Decimal& a, const Decimal& b);
std::optional<Decimal> Subtract(const Decimal& a, const Decimal& b);
std::optional<Decimal> Multiply(const Decimal& a, const Decimal& b);
std::optional<Decimal> Divide(const Decimal& a, const Decimal& b);  // nullopt also for a zero divisor
// As Compare, of different scales.
int CompareScales(const Decimal& a, const Decimal& b);
// Negative, zero or positive as a is less than, equal to or greater than b. Exact for any scales.
inline int Compare(const Decimal& a, const Decimal& b) {
  if (a.scale != b.scale) return CompareScales(a, b);
  return a.mantissa < b.mantissa ? -1 : a.mantissa > b.mantissa ? 1 : 0;
}

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_DECIMAL_H_
