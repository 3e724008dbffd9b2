#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/number.h"
#include "graph/sparql/values/text.h"
#include "graph/sparql/values/value.h"

namespace docent::sparql {

using Type = Value::Type;

namespace {

int Sign(int64_t value) {
  return value < 0 ? -1 : value > 0 ? 1 : 0;
}
int CompareText(std::string_view a, std::string_view b) {
  return Sign(a.compare(b));
}

// Both numeric. NaN: unordered.
std::optional<int> CompareNumbers(const Value& a, const Value& b) {
  const std::partial_ordering order = Compare(Number::Of(a), Number::Of(b));
  if (order == std::partial_ordering::unordered) return std::nullopt;
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

// The rank of the kinds in ORDER BY.
int OrderRank(const Value& v) {
  switch (v.type()) {
    case Type::kError:
      return 0;
    case Type::kBlank:
      return 1;
    case Type::kIri:
      return 2;
    case Type::kInteger:
    case Type::kDecimal:
    case Type::kFloat:
    case Type::kDouble:
      return 3;
    case Type::kBoolean:
      return 4;
    case Type::kDate:
      return 5;
    case Type::kDateTime:
      return 6;
    case Type::kTime:
      return 7;
    case Type::kDuration:
      return 8;
    case Type::kString:
      return 9;
    case Type::kLangString:
      return 10;
    case Type::kOther:
      return 11;
  }
  return 11;
}

// Whether a text of the lexical space has no value only because it has more digits than there are values for.
bool IsNumberTooLong(std::string_view text, std::string_view datatype) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  const size_t point = datatype == kXsdDecimal ? text.find('.') : std::string_view::npos;
  size_t digits = 0;
  for (const char c : text) digits += c >= '0' && c <= '9' ? 1 : 0;
  return digits > 0 && digits == text.size() - (point == std::string_view::npos ? 0 : 1);
}

}  // namespace

std::optional<bool> EffectiveBooleanValue(const Value& v) {
  switch (v.type()) {
    case Type::kBoolean:
      return v.boolean();
    case Type::kString:
    case Type::kLangString:
      return !v.text().empty();
    case Type::kInteger:
    case Type::kDecimal:
      return !v.decimal().IsZero();
    case Type::kFloat:
    case Type::kDouble:
      return !(v.number() == 0 || std::isnan(v.number()));
    case Type::kOther: {  // an invalid lexical form of these types is false
      const std::string_view datatype = v.datatype();
      if ((datatype == kXsdInteger || datatype == kXsdDecimal) && IsNumberTooLong(v.text(), datatype))
        return std::nullopt;  // it has a value, which is not known
      if (datatype == kXsdBoolean || datatype == kXsdInteger || datatype == kXsdDecimal ||
          datatype == kXsdDouble || datatype == kXsdFloat) {
        return false;
      }
      return std::nullopt;
    }
    default:
      return std::nullopt;
  }
}

std::optional<bool> ValuesEqual(const Value& a, const Value& b) {
  if (a.IsError() || b.IsError()) return std::nullopt;
  if (a.IsNumeric() && b.IsNumeric()) {
    const std::optional<int> order = CompareNumbers(a, b);
    return order.has_value() && *order == 0;
  }
  if (!a.IsLiteral() || !b.IsLiteral()) return a.type() == b.type() && a.text() == b.text();
  if (a.type() == b.type()) {
    switch (a.type()) {
      case Type::kString:
        return a.text() == b.text();
      case Type::kLangString:
        return a.text() == b.text() && EqualsIgnoreCase(a.language(), b.language());
      case Type::kBoolean:
        return a.boolean() == b.boolean();
      case Type::kDuration:
        return Equal(a.duration(), b.duration());
      case Type::kDate:
      case Type::kDateTime:
      case Type::kTime: {
        const std::optional<int> order = CompareTimes(a, b);
        if (!order) return std::nullopt;
        return *order == 0;
      }
      default:  // kOther: the same term is equal; for others the result is unknown
        if (a.text() == b.text() && a.datatype() == b.datatype()) return true;
        return std::nullopt;
    }
  }
  // Literals of different kinds: one with a language tag differs from one without. Values of two
  // known datatypes with disjoint value spaces differ. For unknown datatypes the result is
  // unknown.
  if (a.type() == Type::kOther || b.type() == Type::kOther) {
    if (a.type() == Type::kLangString || b.type() == Type::kLangString) return false;
    return std::nullopt;
  }
  return false;
}

std::optional<int> CompareValues(const Value& a, const Value& b, bool* unordered) {
  *unordered = false;
  if (a.IsNumeric() && b.IsNumeric()) {
    const std::optional<int> order = CompareNumbers(a, b);
    *unordered = !order;
    return order;
  }
  if (a.type() != b.type()) return std::nullopt;
  switch (a.type()) {
    case Type::kString:
      return CompareText(a.text(), b.text());
    case Type::kBoolean:
      return static_cast<int>(a.boolean()) - static_cast<int>(b.boolean());
    case Type::kDate:
    case Type::kDateTime:
    case Type::kTime:
      return CompareTimes(a, b);
    case Type::kDuration:
      return Compare(a.duration(), b.duration());
    default:
      return std::nullopt;
  }
}

std::optional<int> CompareIdsForOrder(TermId a, TermId b, const Dictionary& dictionary) {
  if ((a.IsIri() && b.IsIri()) || (a.IsBlank() && b.IsBlank())) {
    return CompareText(dictionary.Lexical(a), dictionary.Lexical(b));
  }
  const Number x = Number::Of(a);
  if (x.IsNone()) return std::nullopt;
  const Number y = Number::Of(b);
  if (y.IsNone()) return std::nullopt;
  const std::partial_ordering order = Compare(x, y);
  if (order == std::partial_ordering::unordered)
    return static_cast<int>(!x.IsNan()) - static_cast<int>(!y.IsNan());
  return order < 0 ? -1 : order > 0 ? 1 : 0;
}

int CompareForOrder(const Value& a, const Value& b) {
  if (a.IsExact() && b.IsExact()) return Compare(a.decimal(), b.decimal());
  const int rank_a = OrderRank(a), rank_b = OrderRank(b);
  if (rank_a != rank_b) return rank_a - rank_b;
  switch (a.type()) {
    case Type::kError:
      return 0;
    case Type::kInteger:
    case Type::kDecimal:
    case Type::kFloat:
    case Type::kDouble: {
      if (const std::optional<int> order = CompareNumbers(a, b)) return *order;
      // NaN before all numbers
      return static_cast<int>(!std::isnan(a.AsDouble())) - static_cast<int>(!std::isnan(b.AsDouble()));
    }
    case Type::kBoolean:
      return static_cast<int>(a.boolean()) - static_cast<int>(b.boolean());
    case Type::kDate:
    case Type::kDateTime:
    case Type::kTime:
      return CompareTimesForOrder(a, b);
    case Type::kDuration:
      return CompareForOrder(a.duration(), b.duration());
    case Type::kLangString: {
      const int text = CompareText(a.text(), b.text());
      return text != 0 ? text : CompareText(LowerAscii(a.language()), LowerAscii(b.language()));
    }
    case Type::kOther: {
      const int type = CompareText(a.datatype(), b.datatype());
      return type != 0 ? type : CompareText(a.text(), b.text());
    }
    default:
      return CompareText(a.text(), b.text());
  }
}

Value Compute(Arithmetic operation, const Value& a, const Value& b) {
  if (!a.IsNumeric() || !b.IsNumeric()) return ComputeTimes(operation, a, b);
  if (a.IsExact() && b.IsExact()) {
    std::optional<Decimal> result;
    switch (operation) {
      case Arithmetic::kAdd:
        result = Add(a.decimal(), b.decimal());
        break;
      case Arithmetic::kSubtract:
        result = Subtract(a.decimal(), b.decimal());
        break;
      case Arithmetic::kMultiply:
        result = Multiply(a.decimal(), b.decimal());
        break;
      case Arithmetic::kDivide:
        result = Divide(a.decimal(), b.decimal());
        break;
    }
    if (!result) return Value::Error();
    const bool whole =
        a.type() == Type::kInteger && b.type() == Type::kInteger && operation != Arithmetic::kDivide;
    return whole ? Value::Integer(*result) : Value::OfDecimal(*result);
  }
  const bool is_double = a.type() == Type::kDouble || b.type() == Type::kDouble;
  double x = a.AsDouble(), y = b.AsDouble();
  if (!is_double) {
    x = static_cast<float>(x);
    y = static_cast<float>(y);
  }
  double result = 0;
  switch (operation) {
    case Arithmetic::kAdd:
      result = x + y;
      break;
    case Arithmetic::kSubtract:
      result = x - y;
      break;
    case Arithmetic::kMultiply:
      result = x * y;
      break;
    case Arithmetic::kDivide:
      result = x / y;
      break;
  }
  return is_double ? Value::Double(result) : Value::Float(result);
}

bool IsCast(std::string_view datatype) {
  if (datatype == kXsdString || datatype == kXsdBoolean || datatype == kXsdDecimal ||
      datatype == kXsdDouble || datatype == kXsdFloat || datatype == kXsdDateTime || datatype == kXsdDate ||
      datatype == kXsdTime || IsIntegerType(datatype)) {
    return true;
  }
  return datatype.starts_with(kXsdNs) && FindDurationKind(datatype.substr(kXsdNs.size()));
}

namespace {

// The shortest decimal digits that read back as the same float or double, without exponent. Not of NaN and infinities.
std::string PlainDigits(const Value& v) {
  std::array<char, 400> buffer;
  char* const end = buffer.data() + buffer.size();
  const auto written =
      v.type() == Type::kFloat
          ? std::to_chars(buffer.data(), end, static_cast<float>(v.number()), std::chars_format::fixed)
          : std::to_chars(buffer.data(), end, v.number(), std::chars_format::fixed);
  return {buffer.data(), written.ptr};
}

// A float or double as a decimal; nullopt for NaN, infinities and numbers of more than 38 digits.
std::optional<Decimal> DecimalOf(const Value& v) {
  if (!std::isfinite(v.number())) return std::nullopt;
  const std::string digits = PlainDigits(v);
  std::string_view text = digits;
  while (true) {
    if (const auto d = Decimal::Parse(text)) return d;
    if (text.find('.') == std::string_view::npos) return std::nullopt;
    text.remove_suffix(1);  // fewer digits after the point
  }
}

// XPath and XQuery Functions section 19.1.2.2 (17.1.2 of 1.0): without exponent from 1e-6 to below 1e6.
std::string StringOf(const Value& v) {
  const double magnitude = std::abs(v.number());
  return magnitude == 0 || (magnitude >= 1e-6 && magnitude < 1e6) ? PlainDigits(v) : v.CanonicalText();
}

bool CastsNumbers(std::string_view datatype) {
  return datatype == kXsdDecimal || datatype == kXsdDouble || datatype == kXsdFloat ||
         IsIntegerType(datatype);
}

Value CastNumber(std::string_view datatype, const Value& v) {
  if (datatype == kXsdDouble) return Value::Double(v.AsDouble());
  if (datatype == kXsdFloat) return Value::Float(v.AsDouble());
  const std::optional<Decimal> exact = v.IsExact() ? v.decimal() : DecimalOf(v);
  if (!exact) return Value::Error();
  if (datatype == kXsdDecimal) return Value::OfDecimal(*exact);
  const Decimal whole = exact->mantissa < 0 ? exact->Ceiling() : exact->Floor();  // toward zero
  if (datatype == kXsdInteger) return Value::Integer(whole);
  Value derived = Value::OfTerm(Term::Literal(whole.ToString(), std::string(datatype)));
  return derived.type() == Type::kInteger ? derived : Value::Error();  // out of the type's range
}

}  // namespace

std::optional<Value> Cast(std::string_view datatype, const Value& v) {
  if (!IsCast(datatype)) return std::nullopt;
  if (v.IsError() || v.type() == Type::kBlank) return Value::Error();
  if (datatype == kXsdString) {
    if (v.type() == Type::kIri || v.IsStringLike() || v.type() == Type::kOther)
      return Value::String(std::string(v.text()));
    if (v.type() == Type::kDouble || v.type() == Type::kFloat) return Value::String(StringOf(v));
    return Value::String(v.CanonicalText());
  }
  if (v.type() == Type::kIri || v.type() == Type::kLangString) return Value::Error();
  if (v.type() == Type::kString) {
    std::string_view text = v.text();  // white space is collapsed in a cast (XPath 17.1.1)
    while (!text.empty() && std::string_view(" \t\r\n").find(text.front()) != std::string_view::npos)
      text.remove_prefix(1);
    while (!text.empty() && std::string_view(" \t\r\n").find(text.back()) != std::string_view::npos)
      text.remove_suffix(1);
    Value read = Value::OfTerm(Term::Literal(std::string(text), std::string(datatype)));
    if (read.type() == Type::kBoolean) return Value::Boolean(read.boolean());
    if (read.IsNumeric()) return CastNumber(datatype, read);
    if (read.type() == Type::kDuration) return Value::OfDuration(read.duration());
    return read.type() == Type::kOther
               ? Value::Error()
               : read;  // a time keeps its text: its fraction may be finer than a microsecond
  }
  if (datatype == kXsdBoolean) {
    if (v.type() == Type::kBoolean) return Value::Boolean(v.boolean());
    if (!v.IsNumeric()) return Value::Error();
    return Value::Boolean(*EffectiveBooleanValue(v));
  }
  if (v.IsTime() || v.type() == Type::kDuration) return CastTime(datatype, v);
  if (v.type() == Type::kBoolean && CastsNumbers(datatype))
    return CastNumber(datatype, Value::Integer(v.boolean() ? 1 : 0));
  return v.IsNumeric() && CastsNumbers(datatype) ? CastNumber(datatype, v) : Value::Error();
}

}  // namespace docent::sparql
