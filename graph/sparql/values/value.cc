#include "graph/sparql/values/value.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/text.h"
#include "graph/sparql/values/time_text.h"

namespace docent::sparql {
namespace {

struct IntegerRange {
  Int128 min, max;
};
constexpr Int128 kNoMin = -kMaxMantissa;  // as far as there are values
constexpr Int128 kNoMax = kMaxMantissa;

// XML Schema part 2, section 3.3.13 to 3.3.25, by local name
const IntegerRange* DerivedInteger(std::string_view local) {
  static const absl::flat_hash_map<std::string, IntegerRange> kRanges = {
      {"integer", {kNoMin, kNoMax}},
      {"nonPositiveInteger", {kNoMin, 0}},
      {"negativeInteger", {kNoMin, -1}},
      {"nonNegativeInteger", {0, kNoMax}},
      {"positiveInteger", {1, kNoMax}},
      {"long", {std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()}},
      {"int", {std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max()}},
      {"short", {-32768, 32767}},
      {"byte", {-128, 127}},
      {"unsignedLong", {0, std::numeric_limits<uint64_t>::max()}},
      {"unsignedInt", {0, std::numeric_limits<uint32_t>::max()}},
      {"unsignedShort", {0, 65535}},
      {"unsignedByte", {0, 255}},
  };
  const auto it = kRanges.find(absl::string_view(local.data(), local.size()));
  return it == kRanges.end() ? nullptr : &it->second;
}

std::optional<double> ParseDouble(std::string_view text) {
  if (text == "INF" || text == "+INF") return std::numeric_limits<double>::infinity();
  if (text == "-INF") return -std::numeric_limits<double>::infinity();
  if (text == "NaN") return std::numeric_limits<double>::quiet_NaN();
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  if (text.empty() || text.find_first_not_of("0123456789.eE+-") != std::string_view::npos)
    return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  if (error != std::errc()) return std::nullopt;
  return value;
}

template <typename Number>
std::string FormatScientific(Number value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "INF" : "-INF";
  std::array<char, 48> buffer;
  const char* end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific).ptr;
  const std::string_view text(buffer.data(), static_cast<size_t>(end - buffer.data()));
  const size_t e = text.find('e');
  std::string out(text.substr(0, e));
  if (out.find('.') == std::string::npos) out += ".0";
  std::string_view power = text.substr(e + 1);
  if (power[0] == '+') power.remove_prefix(1);
  int exponent = 0;
  std::from_chars(power.data(), power.data() + power.size(), exponent);
  return out + "E" + std::to_string(exponent);
}

}  // namespace

bool IsIntegerType(std::string_view datatype) {
  return datatype.starts_with(kXsdNs) && DerivedInteger(datatype.substr(kXsdNs.size())) != nullptr;
}

std::string FormatDouble(double value) {
  return FormatScientific(value);
}
std::string FormatFloat(float value) {
  return FormatScientific(value);
}

Value Value::Boolean(bool value) {
  Value v;
  v.type_ = Type::kBoolean;
  v.boolean_ = value;
  return v;
}

Value Value::Integer(const Decimal& value) {
  Value v;
  v.type_ = Type::kInteger;
  v.decimal_ = value;
  return v;
}

Value Value::OfDecimal(const Decimal& value) {
  Value v;
  v.type_ = Type::kDecimal;
  v.decimal_ = value;
  return v;
}

Value Value::Float(double value) {
  Value v;
  v.type_ = Type::kFloat;
  v.number_ = static_cast<float>(value);
  return v;
}

Value Value::Double(double value) {
  Value v;
  v.type_ = Type::kDouble;
  v.number_ = value;
  return v;
}

Value Value::Owning(Type type, std::string text, std::string tag) {
  Value v;
  v.type_ = type;
  v.owned_ = std::make_shared<const Texts>(Texts{std::move(text), std::move(tag)});
  v.text_ = v.owned_->text;
  v.tag_ = v.owned_->tag;
  return v;
}

Value Value::String(std::string text) {
  return Owning(Type::kString, std::move(text));
}

Value Value::LangString(std::string text, std::string language) {
  return Owning(Type::kLangString, std::move(text), std::move(language));
}

Value Value::Iri(std::string iri) {
  return Owning(Type::kIri, std::move(iri));
}

Value Value::Blank(std::string label) {
  return Owning(Type::kBlank, std::move(label));
}

Value Value::DateTime(TimeMicros time_us) {
  Value v;
  v.type_ = Type::kDateTime;
  v.time_us_ = time_us;
  v.zone_ = 0;
  return v;
}

Value Value::OfTime(Type type, TimeMicros local_us, std::optional<int> zone_minutes) {
  Value v;
  v.type_ = type;
  v.time_us_ = local_us;
  v.zone_ = zone_minutes;
  return v;
}

Value Value::OfDuration(const Duration& duration) {
  Value v;
  v.type_ = Type::kDuration;
  v.duration_kind_ = duration.kind;
  v.months_ = duration.months;
  v.time_us_ = duration.time_us;
  return v;
}

// Sets type and value by the datatype; the texts are already set.
void Value::ReadLiteral(std::string_view text, std::string_view datatype) {
  type_ = Type::kOther;
  if (datatype.substr(0, kXsdNs.size()) != kXsdNs) return;
  const std::string_view local = datatype.substr(kXsdNs.size());
  if (local == "string") {
    type_ = Type::kString;
  } else if (local == "boolean") {
    if (text != "true" && text != "false" && text != "1" && text != "0") return;
    type_ = Type::kBoolean;
    boolean_ = text == "true" || text == "1";
  } else if (local == "decimal") {
    if (const auto d = Decimal::Parse(text)) {
      type_ = Type::kDecimal;
      decimal_ = *d;
    }
  } else if (local == "double" || local == "float") {
    if (const auto d = ParseDouble(text)) {
      type_ = local == "double" ? Type::kDouble : Type::kFloat;
      number_ = type_ == Type::kFloat ? static_cast<double>(static_cast<float>(*d)) : *d;
    }
  } else if (local == "dateTime" || local == "date" || local == "time") {
    const Type type = local == "date" ? Type::kDate : local == "time" ? Type::kTime : Type::kDateTime;
    if (const auto time = type == Type::kDate   ? ParseDateText(text)
                          : type == Type::kTime ? ParseTimeText(text)
                                                : ParseDateTimeText(text)) {
      type_ = type;
      time_us_ = time->local_us;
      zone_ = time->zone_minutes;
    }
  } else if (const auto kind = FindDurationKind(local)) {
    if (const auto duration = ParseDuration(text, *kind)) {
      type_ = Type::kDuration;
      duration_kind_ = *kind;
      months_ = duration->months;
      time_us_ = duration->time_us;
    }
  } else if (const IntegerRange* range = DerivedInteger(local)) {
    const auto d = Decimal::ParseInteger(text);
    if (d && d->mantissa >= range->min && d->mantissa <= range->max) {
      type_ = Type::kInteger;
      decimal_ = *d;
    }
  }
}

Value Value::OfTerm(const Term& term) {
  switch (term.kind) {
    case TermKind::kIri:
      return Iri(term.lexical);
    case TermKind::kBlank:
      return Blank(term.lexical);
    case TermKind::kLiteral:
      break;
  }
  if (!term.language.empty()) return LangString(term.lexical, term.language);
  Value v = Owning(Type::kString, term.lexical, term.datatype);
  if (!term.datatype.empty()) v.ReadLiteral(term.lexical, term.datatype);
  return v;
}

Value Value::OfId(TermId id, const Dictionary& dictionary) {
  Value v;
  v.id_ = id;
  switch (id.tag()) {
    case TermId::Tag::kIri:
    case TermId::Tag::kBlank:
      v.type_ = id.IsIri() ? Type::kIri : Type::kBlank;
      v.text_ = dictionary.Lexical(id);
      break;
    case TermId::Tag::kLiteral: {
      const Dictionary::LiteralView literal = dictionary.Literal(id);
      v.text_ = literal.lexical;
      if (!literal.language.empty()) {
        v.type_ = Type::kLangString;
        v.tag_ = literal.language;
      } else if (literal.datatype.empty()) {
        v.type_ = Type::kString;
      } else {
        v.ReadLiteral(v.text_, literal.datatype);
        v.tag_ = literal.datatype;
      }
      break;
    }
    case TermId::Tag::kInteger:
      v.type_ = Type::kInteger;
      v.decimal_ = Decimal::Of(InlineInteger(id));
      break;
    case TermId::Tag::kDecimal: {
      const InlineDecimalValue d = InlineDecimal(id);
      v.type_ = Type::kDecimal;
      v.decimal_ = {d.mantissa, d.scale};
      break;
    }
    case TermId::Tag::kDouble:
    case TermId::Tag::kPlainDouble:
    case TermId::Tag::kNearDouble:
      v.type_ = id.tag() == TermId::Tag::kPlainDouble && InlineIsFloat(id) ? Type::kFloat : Type::kDouble;
      v.number_ = InlineDouble(id);
      break;
    case TermId::Tag::kBoolean:
      v.type_ = Type::kBoolean;
      v.boolean_ = InlineBoolean(id);
      break;
    case TermId::Tag::kDate:
    case TermId::Tag::kDateTime:
    case TermId::Tag::kZonedDateTime: {
      const InlineTimeValue time = InlineTime(id);
      v.type_ = id.tag() == TermId::Tag::kDate ? Type::kDate : Type::kDateTime;
      v.time_us_ = time.local_us;
      v.zone_ = time.zone_minutes;
      break;
    }
    default:
      break;
  }
  return v;
}

std::string_view Value::CanonicalDatatype() const {
  switch (type_) {
    case Type::kBoolean:
      return kXsdBoolean;
    case Type::kInteger:
      return kXsdInteger;
    case Type::kDecimal:
      return kXsdDecimal;
    case Type::kFloat:
      return kXsdFloat;
    case Type::kDouble:
      return kXsdDouble;
    case Type::kDateTime:
      return kXsdDateTime;
    case Type::kDate:
      return kXsdDate;
    case Type::kTime:
      return kXsdTime;
    case Type::kDuration:
      return DatatypeOf(duration_kind_);
    case Type::kString:
      return kXsdString;
    case Type::kLangString:
      return kRdfLangString;
    case Type::kOther:
      return datatype();
    default:
      return "";
  }
}

std::string Value::CanonicalText() const {
  switch (type_) {
    case Type::kBoolean:
      return boolean_ ? "true" : "false";
    case Type::kInteger:
    case Type::kDecimal:
      return decimal_.ToString();
    case Type::kFloat:
      return FormatFloat(static_cast<float>(number_));
    case Type::kDouble:
      return FormatDouble(number_);
    case Type::kDateTime:
      return FormatDateTimeText({time_us_, zone_});
    case Type::kDate:
      return FormatDateText({time_us_, zone_});
    case Type::kTime:
      return FormatTimeText({time_us_, zone_});
    case Type::kDuration:
      return ToString(duration());
    default:
      return std::string(text());
  }
}

std::string Value::Lexical() const {
  return text_.empty() ? CanonicalText() : std::string(text_);
}

std::string_view Value::DatatypeIri() const {
  return type_ == Type::kLangString || tag_.empty() ? CanonicalDatatype() : tag_;
}

Term Value::ToTerm() const {
  switch (type_) {
    case Type::kIri:
      return Term::Iri(std::string(text()));
    case Type::kBlank:
      return Term::Blank(std::string(text()));
    case Type::kString:
      return Term::Literal(std::string(text()));
    case Type::kLangString:
      return Term::LangString(std::string(text()), std::string(language()));
    default:
      return Term::Literal(Lexical(), std::string(DatatypeIri()));
  }
}

}  // namespace docent::sparql
