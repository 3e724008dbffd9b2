// A term with its parsed value, the operand of expressions. It holds a view of the dictionary's text, not a
// copy, so it must not outlive the dictionary. Values; one thread.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_VALUE_H_
#define DOCENT_GRAPH_SPARQL_VALUES_VALUE_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/rdf/term_id.h"
#include "graph/sparql/values/decimal.h"
#include "graph/sparql/values/duration.h"

namespace docent::sparql {

class Value {
 public:
  enum class Type : uint8_t {
    kError,       // no value: an unbound variable, or an error in an expression
    kIri,         // text()
    kBlank,       // text(): label
    kString,      // text()
    kLangString,  // text(), language()
    kBoolean,     // boolean
    kInteger,     // decimal (scale 0); xsd:integer and the types derived from it
    kDecimal,     // decimal
    kFloat,       // number
    kDouble,      // number
    kDateTime,    // time_us, zone
    kDate,        // time_us (midnight), zone
    kTime,        // time_us (of 1970-01-01), zone
    kDuration,    // duration
    kOther,       // text(), datatype(): an unknown datatype, or an invalid lexical form
  };

  Value() = default;
  static Value Error() { return Value(); }
  static Value Boolean(bool value);
  static Value Integer(const Decimal& value);
  static Value Integer(int64_t value) { return Integer(Decimal::Of(value)); }
  static Value OfDecimal(const Decimal& value);
  static Value Float(double value);
  static Value Double(double value);
  static Value String(std::string text);
  static Value LangString(std::string text, std::string language);
  static Value Iri(std::string iri);
  static Value Blank(std::string label);
  static Value DateTime(TimeMicros time_us);  // with zone Z
  static Value OfTime(Type type, TimeMicros local_us,
                      std::optional<int> zone_minutes);  // kDateTime, kDate or kTime
  static Value OfDuration(const Duration& duration);
  // From a term; copies the texts.
  static Value OfTerm(const Term& term);
  // From an id that `dictionary` gave or that is inline.
  static Value OfId(TermId id, const Dictionary& dictionary);

  Type type() const { return type_; }
  bool IsError() const { return type_ == Type::kError; }
  bool IsLiteral() const { return type_ >= Type::kString; }
  bool IsNumeric() const { return type_ >= Type::kInteger && type_ <= Type::kDouble; }
  bool IsExact() const { return type_ == Type::kInteger || type_ == Type::kDecimal; }
  bool IsStringLike() const { return type_ == Type::kString || type_ == Type::kLangString; }
  bool IsTime() const { return type_ >= Type::kDateTime && type_ <= Type::kTime; }

  // The id it was made from; kNone if it was computed.
  TermId id() const { return id_; }
  void set_id(TermId id) { id_ = id; }

  bool boolean() const { return boolean_; }
  const Decimal& decimal() const { return decimal_; }
  double number() const { return number_; }
  // Any numeric type as a double.
  double AsDouble() const { return IsExact() ? decimal_.ToDouble() : number_; }
  // The local time as written, as if its zone were UTC. Below: the zone in minutes, if it has one.
  TimeMicros local_time_us() const { return time_us_; }
  std::optional<int> zone_minutes() const { return zone_; }
  // The instant; a time without zone counts as UTC (XPath's implicit timezone).
  TimeMicros instant_us() const { return time_us_ - TimeMicros{60'000'000} * zone_.value_or(0); }

  Duration duration() const { return {duration_kind_, months_, time_us_}; }

  // For kIri, kBlank, kString, kLangString, kOther; for other literals the original text, if there was one.
  std::string_view text() const { return text_; }
  std::string_view language() const { return tag_; }
  std::string_view datatype() const { return tag_; }  // kOther
  // The datatype xsd:… of other literals, as computed: not a type derived from xsd:integer.
  std::string_view CanonicalDatatype() const;

  // Memory of computed texts, shared with the copies.
  size_t owned_bytes() const {
    return owned_ == nullptr ? 0 : sizeof(Texts) + owned_->text.capacity() + owned_->tag.capacity();
  }

  // The term with its original text, else in canonical lexical form. Not for kError.
  Term ToTerm() const;
  std::string Lexical() const;
  std::string_view DatatypeIri() const;  // a literal's
  // The canonical lexical form of the value, whatever its original text.
  std::string CanonicalText() const;

 private:
  struct Texts {
    std::string text, tag;
  };
  static Value Owning(Type type, std::string text, std::string tag = std::string());
  void ReadLiteral(std::string_view text, std::string_view datatype);

  Type type_ = Type::kError;
  bool boolean_ = false;
  Duration::Kind duration_kind_ = Duration::Kind::kDuration;
  std::optional<int> zone_;
  TermId id_;
  double number_ = 0;
  TimeMicros time_us_ = 0;  // for a duration: the part without months
  int64_t months_ = 0;
  Decimal decimal_;
  std::string_view text_, tag_;
  std::shared_ptr<const Texts> owned_;  // the viewed texts, unless they are the dictionary's; copies share it
};

// Section 17.2.2; nullopt is a type error.
std::optional<bool> EffectiveBooleanValue(const Value& value);
// The operator `=` (section 17.3; RDFterm-equal for pairs not in the table); nullopt is a type error.
std::optional<bool> ValuesEqual(const Value& a, const Value& b);
// The operators `<`, `>`, …: negative, zero, positive; nullopt is a type error (or NaN: see `unordered`).
std::optional<int> CompareValues(const Value& a, const Value& b, bool* unordered);
// Section 15.1 as a total order over all values; negative, zero, positive.
int CompareForOrder(const Value& a, const Value& b);

enum class Arithmetic : uint8_t { kAdd, kSubtract, kMultiply, kDivide };
// With the promotions of XPath; an error value if the operation is not defined for the operands, for a zero
// divisor, and on overflow.
Value Compute(Arithmetic operation, const Value& a, const Value& b);

// For times and durations (value_times.cc). Two times of one type, one of them without zone, are incomparable
// if they are less than 14 hours apart (XML Schema part 2, section 3.2.7.4).
std::optional<int> CompareTimes(const Value& a, const Value& b);
int CompareTimesForOrder(const Value& a, const Value& b);
Value ComputeTimes(Arithmetic operation, const Value& a, const Value& b);
// Casts a value that is not a text.
Value CastTime(std::string_view datatype, const Value& value);

// The xsd: constructor functions (section 17.5); an error value if the cast fails. nullopt if `datatype` is
// not a cast.
std::optional<Value> Cast(std::string_view datatype, const Value& value);
bool IsIntegerType(std::string_view datatype);  // xsd:integer and the types derived from it
bool IsCast(std::string_view datatype);

// "1.5E0", "INF"
std::string FormatDouble(double value);
std::string FormatFloat(float value);
// The civil parts of a local time.
struct CivilTime {
  int64_t year;
  int month, day, hour, minute;
  int64_t second_us;  // microseconds within the minute
};
CivilTime ToCivil(TimeMicros local_time_us);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_VALUE_H_
