#include "graph/rdf/number_literal.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

constexpr std::string_view kOfInteger[] = {"integer",
                                           "int",
                                           "long",
                                           "short",
                                           "byte",
                                           "nonNegativeInteger",
                                           "positiveInteger",
                                           "nonPositiveInteger",
                                           "negativeInteger",
                                           "unsignedInt",
                                           "unsignedLong",
                                           "unsignedShort",
                                           "unsignedByte"};

size_t SkipDigits(std::string_view text, size_t* at) {
  const size_t first = *at;
  while (*at < text.size() && absl::ascii_isdigit(static_cast<unsigned char>(text[*at]))) ++*at;
  return *at - first;
}

void SkipSign(std::string_view text, size_t* at) {
  if (*at < text.size() && (text[*at] == '+' || text[*at] == '-')) ++*at;
}

// [+-]? digits, with a point and an exponent where allowed.
bool IsWellFormed(std::string_view text, bool point, bool exponent) {
  size_t at = 0;
  SkipSign(text, &at);
  size_t digits = SkipDigits(text, &at);
  if (point && at < text.size() && text[at] == '.') {
    ++at;
    digits += SkipDigits(text, &at);
  }
  if (digits == 0) return false;
  if (exponent && at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    ++at;
    SkipSign(text, &at);
    if (SkipDigits(text, &at) == 0) return false;
  }
  return at == text.size();
}

}  // namespace

bool IsNumberLiteral(const Term& term) {
  if (!term.IsLiteral() || !term.datatype.starts_with(kXsdNs)) return false;
  const std::string_view local = std::string_view(term.datatype).substr(kXsdNs.size());
  return local == "decimal" || local == "double" || local == "float" ||
         std::find(std::begin(kOfInteger), std::end(kOfInteger), local) != std::end(kOfInteger);
}

std::optional<double> FiniteNumber(const Term& term) {
  if (!IsNumberLiteral(term)) return std::nullopt;
  const bool floating = term.datatype == kXsdDouble || term.datatype == kXsdFloat;
  const bool point = floating || term.datatype == kXsdDecimal;
  double value = 0;
  if (!IsWellFormed(term.lexical, point, floating) || !absl::SimpleAtod(ToAbsl(term.lexical), &value) ||
      !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

}  // namespace docent
