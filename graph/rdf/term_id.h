// A term as 64 bits: a tag of 4 bits and 60 bits that are a dictionary index or the value
// itself.
//
// Integers, decimals, doubles, floats, booleans, dates and date-times are held in the id *only
// if decoding returns exactly the original text*; "01" or "+1" need the dictionary, "1.50" does
// not (its scale is kept). A stream of poses and times in the usual notation therefore does not
// grow the dictionary. Equal terms have equal ids within one Dictionary. Values; any thread.
#ifndef DOCENT_GRAPH_RDF_TERM_ID_H_
#define DOCENT_GRAPH_RDF_TERM_ID_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "graph/base/clock.h"

#include "graph/rdf/term.h"

namespace docent {

class TermId {
 public:
  enum class Tag : uint8_t {
    kNone = 0,     // no term: unbound, or a wildcard in a pattern
    kIri = 1,      // dictionary index
    kBlank = 2,    // dictionary index
    kLiteral = 3,  // dictionary index: strings, language strings, and whatever does not fit below
    kInteger = 4,  // xsd:integer, 60-bit two's complement
    kDecimal = 5,  // xsd:decimal, 55-bit mantissa and 5-bit scale (digits after the point): "-1.250", "12"
    kDouble =
        6,  // xsd:double whose low 4 mantissa bits are 0 and whose lexical form is canonical: "1.5E0", "INF"
    kBoolean = 7,   // xsd:boolean "true"/"false"
    kDate = 8,      // xsd:date of the years 1 to 9999, without zone or with Z
    kDateTime = 9,  // xsd:dateTime to the microsecond (about 828 to 3111), 0 to 6 digits of it, without zone
                    // or with Z
    // xsd:double (last bit 0) and xsd:float (1) written as a decimal: 54-bit mantissa, 5-bit scale of at most 22:
    // "12.340000", "-0.05", "3"
    kPlainDouble = 10,
    // xsd:double of 2^-26 up to 2^16 (and below zero) in the shortest text that gives it back, which may need 17
    // digits: canonical ("1.2345678901234567E1"), fixed ("12.345678901234567") or "9.5e-05"
    kNearDouble = 11,
    // xsd:dateTime of 2000 to 2071 with 0, 3 or 6 digits of the second and an offset of whole quarters of an hour
    kZonedDateTime = 12,
    kLocal = 15,  // made by one query (computed values); index into that query's own table, never stored
  };

  constexpr TermId() = default;
  constexpr explicit TermId(uint64_t bits) : bits_(bits) {}
  static constexpr TermId Make(Tag tag, uint64_t payload) {
    return TermId((static_cast<uint64_t>(tag) << 60) | (payload & kPayloadMask));
  }

  constexpr uint64_t bits() const { return bits_; }
  constexpr Tag tag() const { return static_cast<Tag>(bits_ >> 60); }
  constexpr uint64_t payload() const { return bits_ & kPayloadMask; }
  constexpr bool IsNone() const { return bits_ == 0; }
  constexpr bool IsIri() const { return tag() == Tag::kIri; }
  constexpr bool IsBlank() const { return tag() == Tag::kBlank; }
  // True for a literal, in the dictionary or inline. Local ids need their query's table and are not covered.
  constexpr bool IsLiteral() const { return tag() >= Tag::kLiteral && tag() <= Tag::kZonedDateTime; }
  constexpr bool InDictionary() const { return tag() >= Tag::kIri && tag() <= Tag::kLiteral; }

  friend constexpr auto operator<=>(TermId, TermId) = default;
  template <typename H>
  friend H AbslHashValue(H h, TermId id) {
    return H::combine(std::move(h), id.bits_);
  }

 private:
  static constexpr uint64_t kPayloadMask = (uint64_t{1} << 60) - 1;
  uint64_t bits_ = 0;
};

// The id of a literal that fits into an id; nullopt if it needs the dictionary.
std::optional<TermId> InlineLiteral(const Term& term);
// The term of an id with an inline tag (kInteger … kZonedDateTime), with exactly the original text.
Term DecodeInline(TermId id);
void DecodeInlineTo(TermId id, Term* out);
// The lexical form alone, written into `buffer`; the result is a view of it.
using InlineBuffer = std::array<char, 64>;
std::string_view WriteInlineText(TermId id, InlineBuffer* buffer);
// The IRI of the datatype of an id with an inline tag.
std::string_view InlineDatatype(TermId id);

// The value of an inline id without its text, for evaluation. Each function requires the tag in its comment.
constexpr int64_t InlineInteger(TermId id) {
  return static_cast<int64_t>(id.bits() << 4) >> 4;
}  // kInteger
double InlineDouble(TermId id);  // kDouble, kPlainDouble (a float's value is rounded to float), kNearDouble
constexpr bool InlineIsFloat(TermId id) {
  return (id.bits() & 1) != 0;
}  // kPlainDouble
constexpr bool InlineBoolean(TermId id) {
  return id.payload() != 0;
}  // kBoolean
// kDecimal: the value is mantissa / 10^scale, 0 <= scale <= 31.
struct InlineDecimalValue {
  int64_t mantissa;
  int scale;
};
constexpr InlineDecimalValue InlineDecimal(TermId id) {
  return {static_cast<int64_t>(id.bits() << 4) >> 9, static_cast<int>(id.bits() & 31)};
}
// The reverse: the id of the literal with exactly this canonical text; nullopt if it needs the dictionary.
std::optional<TermId> InlineIntegerId(int64_t value);
std::optional<TermId> InlineDecimalId(InlineDecimalValue value);
// kDate (its first instant), kDateTime and kZonedDateTime: the zone's local time, read as if it were UTC.
struct InlineTimeValue {
  TimeMicros local_us;
  std::optional<int> zone_minutes;
};
InlineTimeValue InlineTime(TermId id);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TERM_ID_H_
