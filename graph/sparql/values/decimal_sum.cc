#include "graph/sparql/values/decimal_sum.h"

#include <cstdio>
#include <string>

namespace docent::sparql {
namespace {

constexpr int kPointDigits = 36;  // the largest scale of a Decimal
constexpr int64_t kLimb = kPowersOfTen[18];

// Limbs below 10^18 in magnitude, but for the highest.
template <typename Limbs>
void Carry(Limbs* limbs) {
  for (size_t i = 0; i + 1 < limbs->size(); ++i) {
    (*limbs)[i + 1] += (*limbs)[i] / kLimb;
    (*limbs)[i] %= kLimb;
  }
}

}  // namespace

void DecimalSum::Add(const Decimal& number) {
  const int up = kPointDigits - number.scale;
  const int64_t factor = kPowersOfTen[static_cast<size_t>(up % kLimbDigits)];
  Int128 rest = number.mantissa;
  for (size_t i = static_cast<size_t>(up / kLimbDigits); rest != 0; ++i) {
    limbs_[i] += rest % kLimb * factor;
    rest /= kLimb;
  }
  Carry(&limbs_);
}

std::optional<Decimal> DecimalSum::Result() const {
  auto limbs = limbs_;
  size_t highest = limbs.size() - 1;
  while (highest > 0 && limbs[highest] == 0) --highest;
  const bool negative = limbs[highest] < 0;
  if (negative) {
    for (Int128& limb : limbs) limb = -limb;
  }
  for (size_t i = 0; i + 1 < limbs.size(); ++i) {  // none negative: the sum is not
    if (limbs[i] >= 0) continue;
    limbs[i] += kLimb;
    --limbs[i + 1];
  }
  if (limbs.back() >= kLimb) return std::nullopt;
  std::string digits = negative ? "-" : "";
  for (size_t i = limbs.size(); i-- > 0;) {
    char text[32];
    std::snprintf(text, sizeof text, "%018lld", static_cast<long long>(limbs[i]));
    digits += text;
  }
  digits.insert(digits.size() - kPointDigits, ".");
  return Decimal::Parse(digits);
}

}  // namespace docent::sparql
