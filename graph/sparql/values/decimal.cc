#include "graph/sparql/values/decimal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace docent::sparql {
namespace {

constexpr int kDivisionDigits = 18;
constexpr int kMaxScale = 36;

// value * 10^digits
std::optional<Int128> ScaleUp(Int128 value, int digits) {
  if (value == static_cast<int64_t>(value) && digits < std::ssize(kPowersOfTen))
    return value * kPowersOfTen[digits];
  for (int i = 0; i < digits; ++i) {
    if (__builtin_mul_overflow(value, static_cast<Int128>(10), &value)) return std::nullopt;
  }
  return value;
}

bool Fits(Int128 mantissa) {
  return mantissa >= -kMaxMantissa && mantissa <= kMaxMantissa;
}

Int128 Magnitude(Int128 value) {
  return value < 0 ? -value : value;
}

// Both numbers at the larger of the two scales.
std::optional<std::pair<Int128, Int128>> Align(const Decimal& a, const Decimal& b) {
  const int scale = std::max(a.scale, b.scale);
  const std::optional<Int128> x = ScaleUp(a.mantissa, scale - a.scale);
  const std::optional<Int128> y = ScaleUp(b.mantissa, scale - b.scale);
  if (!x || !y) return std::nullopt;
  return std::make_pair(*x, *y);
}

// The sum of a and b where b has the larger scale and a does not fit at it: the sum may fit if the signs differ.
// The whole parts are added first.
std::optional<Decimal> AddWide(const Decimal& a, const Decimal& b) {
  const std::optional<Int128> unit = ScaleUp(1, b.scale - a.scale);
  if (!unit) return std::nullopt;
  Decimal sum{0, b.scale};
  if (__builtin_mul_overflow(a.mantissa + b.mantissa / *unit, *unit, &sum.mantissa)) return std::nullopt;
  sum.mantissa += b.mantissa % *unit;  // what fits leaves room for it
  return sum;
}

// Divides each of the two factors or both by the factors of 10 that their product has after the point, so that a
// product that fits does not overflow.
void CancelTens(Decimal* x, Decimal* y) {
  const auto cancel = [&](int of_x, int of_y) {
    while (x->scale + y->scale > 0 && x->mantissa % of_x == 0 && y->mantissa % of_y == 0) {
      x->mantissa /= of_x;
      y->mantissa /= of_y;
      --(x->scale > 0 ? x : y)->scale;
    }
  };
  cancel(10, 1);
  cancel(1, 10);
  cancel(2, 5);
  cancel(5, 2);
}

// (top * 10^digits) / by toward zero, digit by digit; nullopt if it has more than 38 digits. by > 0, top >= 0.
std::optional<Int128> DivideScaled(Int128 top, Int128 by, int digits) {
  __extension__ using Unsigned = unsigned __int128;
  if (const auto scaled = ScaleUp(top, digits))
    return Fits(*scaled / by) ? std::optional<Int128>(*scaled / by) : std::nullopt;
  Int128 quotient = top / by;
  Unsigned rest = static_cast<Unsigned>(top % by);
  for (int i = 0; i < digits; ++i) {
    if (quotient > kMaxMantissa / 10) return std::nullopt;
    Unsigned next = 0;  // 10 * rest, reduced at each step: two numbers below 10^38 fit
    int digit = 0;
    for (int times = 0; times < 10; ++times) {
      next += rest;
      if (next >= static_cast<Unsigned>(by)) {
        next -= static_cast<Unsigned>(by);
        ++digit;
      }
    }
    rest = next;
    quotient = quotient * 10 + digit;
  }
  return quotient;
}

Int128 FloorDivide(Int128 value, Int128 by) {
  const Int128 quotient = value / by;
  return value % by < 0 ? quotient - 1 : quotient;
}

}  // namespace

Decimal Normalised(Decimal d) {
  while (d.scale > 0 && d.mantissa == static_cast<int64_t>(d.mantissa)) {  // 64-bit division is faster
    const int64_t mantissa = static_cast<int64_t>(d.mantissa);
    if (mantissa % 10 != 0) return d;
    d.mantissa = mantissa / 10;
    --d.scale;
  }
  while (d.scale > 0 && d.mantissa % 10 == 0) {
    d.mantissa /= 10;
    --d.scale;
  }
  return d;
}

std::optional<Decimal> Decimal::Parse(std::string_view text) {
  const bool negative = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  Decimal d;
  bool point = false, digits = false;
  if (const size_t dot = text.find('.'); dot != std::string_view::npos) {  // drops trailing zeros
    while (text.size() > dot + 1 && text.back() == '0' && text.size() > 2) text.remove_suffix(1);
  }
  for (const char c : text) {
    if (c == '.' && !point) {
      point = true;
      continue;
    }
    if (c < '0' || c > '9') return std::nullopt;
    digits = true;
    if (__builtin_mul_overflow(d.mantissa, static_cast<Int128>(10), &d.mantissa) ||
        __builtin_add_overflow(d.mantissa, static_cast<Int128>(c - '0'), &d.mantissa)) {
      return std::nullopt;
    }
    d.scale += point ? 1 : 0;
  }
  if (!digits || d.scale > kMaxScale || !Fits(d.mantissa)) return std::nullopt;
  if (negative) d.mantissa = -d.mantissa;
  return Normalised(d);
}

std::optional<Decimal> Decimal::ParseInteger(std::string_view text) {
  if (text.find('.') != std::string_view::npos) return std::nullopt;
  return Parse(text);
}

std::string Decimal::ToString() const {
  __extension__ using Unsigned = unsigned __int128;
  constexpr uint64_t kHalf =
      10'000'000'000'000'000'000u;  // 19 digits: what is above them fits into 64 bits, too
  const Decimal d = Normalised(*this);
  const Unsigned mantissa =
      d.mantissa < 0 ? 0 - static_cast<Unsigned>(d.mantissa) : static_cast<Unsigned>(d.mantissa);
  std::array<char, 48> digits;
  char* const begin = digits.data();
  char* end =
      std::to_chars(begin, begin + 20, static_cast<uint64_t>(mantissa < kHalf ? mantissa : mantissa / kHalf))
          .ptr;
  if (mantissa >= kHalf) {
    uint64_t low = static_cast<uint64_t>(mantissa % kHalf);
    char* const low_begin = end;
    end += 19;
    for (char* at = end; at != low_begin; low /= 10) *--at = static_cast<char>('0' + low % 10);
  }
  const size_t count = static_cast<size_t>(end - begin), scale = static_cast<size_t>(d.scale);
  std::string out;
  out.reserve(std::max(count, scale + 1) + 2);
  if (d.mantissa < 0) out += '-';
  if (count <= scale) {
    out += "0.";
    out.append(scale - count, '0');
    return out.append(begin, count);
  }
  out.append(begin, count - scale);
  if (scale == 0) return out;
  out += '.';
  return out.append(end - scale, scale);
}

double Decimal::ToDouble() const {
  // Up to 2^53 over a power of ten up to 10^22 this is correctly rounded; beyond, the text is parsed.
  const Int128 exact = Int128{1} << 53;
  if (scale <= 22 && mantissa < exact && mantissa > -exact) {
    return static_cast<double>(mantissa) / std::pow(10.0, scale);
  }
  return std::stod(ToString());
}

Decimal Decimal::Floor() const {
  Int128 unit = 1;
  for (int i = 0; i < scale; ++i) unit *= 10;
  return {FloorDivide(mantissa, unit), 0};
}

Decimal Decimal::Ceiling() const {
  const Decimal floor = Decimal{-mantissa, scale}.Floor();
  return {-floor.mantissa, 0};
}

Decimal Decimal::Round() const {
  if (scale == 0) return *this;
  Int128 half = 5;
  for (int i = 1; i < scale; ++i) half *= 10;
  return Decimal{mantissa + half, scale}.Floor();  // there is room above 10^38
}

std::optional<Decimal> Add(const Decimal& a, const Decimal& b) {
  const auto aligned = Align(a, b);
  Decimal sum{0, std::max(a.scale, b.scale)};
  if (!aligned) {
    const std::optional<Decimal> wide = a.scale < b.scale ? AddWide(a, b) : AddWide(b, a);
    if (!wide) return std::nullopt;
    sum = *wide;
  } else if (__builtin_add_overflow(aligned->first, aligned->second, &sum.mantissa)) {
    return std::nullopt;
  }
  sum = Normalised(sum);
  return Fits(sum.mantissa) ? std::optional<Decimal>(sum) : std::nullopt;
}

std::optional<Decimal> Subtract(const Decimal& a, const Decimal& b) {
  return Add(a, {-b.mantissa, b.scale});
}

std::optional<Decimal> Multiply(const Decimal& a, const Decimal& b) {
  Decimal x = Normalised(a), y = Normalised(b);
  Decimal product{0, x.scale + y.scale};
  if (__builtin_mul_overflow(x.mantissa, y.mantissa, &product.mantissa)) {
    CancelTens(&x, &y);
    product.scale = x.scale + y.scale;
    if (__builtin_mul_overflow(x.mantissa, y.mantissa, &product.mantissa)) return std::nullopt;
  }
  product = Normalised(product);
  if (product.scale > kMaxScale || !Fits(product.mantissa)) return std::nullopt;
  return product;
}

std::optional<Decimal> Divide(const Decimal& a, const Decimal& b) {
  if (b.mantissa == 0) return std::nullopt;
  const bool negative = (a.mantissa < 0) != (b.mantissa < 0);
  Int128 top = Magnitude(a.mantissa);
  const Int128 by = Magnitude(b.mantissa);
  // a/b to kDivisionDigits: (a.m * 10^(k + b.scale - a.scale)) / b.m; fewer digits if it does not fit.
  for (int digits = kDivisionDigits; digits >= 0; --digits) {
    const int up = digits + b.scale - a.scale;
    std::optional<Int128> quotient;
    if (up >= 0) {
      quotient = DivideScaled(top, by, up);
    } else {  // dividing twice is the same as by the product
      const std::optional<Int128> unit = ScaleUp(1, -up);
      quotient = unit ? top / *unit / by : 0;
    }
    if (quotient) return Normalised({negative ? -*quotient : *quotient, digits});
  }
  return std::nullopt;
}

int CompareScales(const Decimal& a, const Decimal& b) {
  if (const auto aligned = Align(a, b)) {
    return aligned->first < aligned->second ? -1 : aligned->first > aligned->second ? 1 : 0;
  }
  // One of them does not fit at the other's scale, at which the other has 38 digits at most: their whole parts
  // differ.
  return a.Floor().mantissa < b.Floor().mantissa ? -1 : 1;
}

}  // namespace docent::sparql
