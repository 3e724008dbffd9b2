#include "workflow/rsel/part_types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "absl/strings/numbers.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/number_literal.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/duration.h"
#include "graph/sparql/values/time_text.h"
#include "workflow/xml/element_reader.h"

namespace docent::rsel {
namespace {

// Datatype → the one that it is derived from (XML Schema 1.1 Part 2, section 3), or that its values are promoted to (SPARQL
// 1.1, section 17.1).
constexpr std::array<std::pair<std::string_view, std::string_view>, 29> kWider = {{
    {"nonPositiveInteger", "integer"},
    {"negativeInteger", "nonPositiveInteger"},
    {"long", "integer"},
    {"int", "long"},
    {"short", "int"},
    {"byte", "short"},
    {"nonNegativeInteger", "integer"},
    {"positiveInteger", "nonNegativeInteger"},
    {"unsignedLong", "nonNegativeInteger"},
    {"unsignedInt", "unsignedLong"},
    {"unsignedShort", "unsignedInt"},
    {"unsignedByte", "unsignedShort"},
    {"integer", "decimal"},
    {"decimal", "float"},
    {"float", "double"},
    {"normalizedString", "string"},
    {"token", "normalizedString"},
    {"language", "token"},
    {"Name", "token"},
    {"NMTOKEN", "token"},
    {"NCName", "Name"},
    {"ID", "NCName"},
    {"IDREF", "NCName"},
    {"ENTITY", "NCName"},
    {"dateTimeStamp", "dateTime"},
    {"yearMonthDuration", "duration"},
    {"dayTimeDuration", "duration"},
    {"anyURI", "string"},
    {"QName", "string"},
}};

std::string_view LocalXsd(std::string_view type) {
  return type.starts_with(kXsdNs) ? type.substr(kXsdNs.size()) : std::string_view();
}

// The next wider datatype of XML Schema, by their local names; empty: none.
std::string_view Wider(std::string_view local) {
  const auto found =
      std::find_if(kWider.begin(), kWider.end(), [local](const auto& pair) { return pair.first == local; });
  return found == kWider.end() ? std::string_view() : found->second;
}

bool IsNarrower(std::string_view local, std::string_view wanted) {
  for (; !local.empty(); local = Wider(local)) {
    if (local == wanted) return true;
  }
  return false;
}

// Datatypes that every literal is of.
bool IsAnyLiteral(std::string_view type) {
  const std::string_view local = LocalXsd(type);
  return local == "anySimpleType" || local == "anyAtomicType" || type == Concat(kRdfsNs, "Literal");
}

// Classes that everything is of.
bool IsAnything(std::string_view type) {
  return type.empty() || type == Concat(kRdfsNs, "Resource") || LocalXsd(type) == "anyType";
}

std::string DatatypeOf(const Term& literal) {
  if (!literal.language.empty()) return std::string(kRdfLangString);
  return literal.datatype.empty() ? std::string(kXsdString) : literal.datatype;
}

// Whether an integer's lexical form is in the range of a datatype that is derived from xsd:integer.
bool IsInRange(std::string_view lexical, std::string_view local) {
  struct Range {
    std::string_view local;
    int64_t least;
    uint64_t most;
  };
  constexpr Range kRanges[] = {{"long", INT64_MIN, INT64_MAX},   {"int", INT32_MIN, INT32_MAX},
                               {"short", INT16_MIN, INT16_MAX},  {"byte", INT8_MIN, INT8_MAX},
                               {"unsignedLong", 0, UINT64_MAX},  {"unsignedInt", 0, UINT32_MAX},
                               {"unsignedShort", 0, UINT16_MAX}, {"unsignedByte", 0, UINT8_MAX}};
  const bool is_zero = lexical.find_first_not_of("+-0") == std::string_view::npos;
  const bool is_negative = !is_zero && lexical.starts_with('-');
  for (const Range& range : kRanges) {
    if (range.local != local) continue;
    int64_t negative = 0;
    uint64_t positive = 0;
    if (is_negative) return absl::SimpleAtoi(ToAbsl(lexical), &negative) && negative >= range.least;
    if (lexical.starts_with('+') || is_zero)
      lexical.remove_prefix(std::min(lexical.find_first_not_of("+-"), lexical.size()));
    return absl::SimpleAtoi(ToAbsl(lexical), &positive) && positive <= range.most;
  }
  if (IsNarrower(local, "nonNegativeInteger"))
    return !is_negative && (local != "positiveInteger" || !is_zero);
  if (IsNarrower(local, "nonPositiveInteger")) return is_zero ? local != "negativeInteger" : is_negative;
  return true;
}

bool IsInteger(std::string_view local) {
  return IsNarrower(local, "integer");
}

// The digits of a number that is whole: "4" of "4.0" and "40e-1"; nullopt: it is not whole.
std::optional<std::string> WholeDigits(const Term& number) {
  const std::string& lexical = number.lexical;
  if (lexical.find_first_of("eE") == std::string::npos) {
    const size_t point = lexical.find('.');
    if (point == std::string::npos) return lexical;
    if (lexical.find_first_not_of('0', point + 1) != std::string::npos) return std::nullopt;
    const std::string digits = lexical.substr(0, point);
    return digits.find_first_of("0123456789") == std::string::npos ? digits + "0" : digits;
  }
  const std::optional<double> value = FiniteNumber(number);
  if (!value || *value != std::trunc(*value)) return std::nullopt;
  return absl::StrFormat("%.0f", *value);
}

// Whether a literal's lexical form is one of its datatype; true where this is not known.
bool HasItsForm(const Term& value, std::string_view local) {
  const std::string& lexical = value.lexical;
  if (IsNumberLiteral(value)) {
    const bool special = lexical == "NaN" || lexical == "INF" || lexical == "-INF";
    return special || (FiniteNumber(value) && (!IsInteger(local) || IsInRange(lexical, local)));
  }
  if (local == "boolean") return lexical == "true" || lexical == "false" || lexical == "0" || lexical == "1";
  if (local == "date") return sparql::ParseDateText(lexical).has_value();
  if (local == "time") return sparql::ParseTimeText(lexical).has_value();
  if (local == "dateTime") return sparql::ParseDateTimeText(lexical).has_value();
  if (local == "dateTimeStamp") {
    const auto time = sparql::ParseDateTimeText(lexical);
    return time && time->zone_minutes;
  }
  const std::optional<sparql::Duration::Kind> kind = sparql::FindDurationKind(local);
  return !kind || sparql::ParseDuration(lexical, *kind);
}

}  // namespace

bool IsDatatype(std::string_view type) {
  return type.starts_with(kXsdNs) || type == kRdfLangString || type == Concat(kRdfNs, "PlainLiteral") ||
         type == Concat(kRdfNs, "XMLLiteral") || type == Concat(kRdfNs, "HTML") ||
         type == Concat(kRdfsNs, "Literal") || type == Concat(kGeoNs, "wktLiteral");
}

bool MayBeOf(std::string_view given, std::string_view wanted) {
  if (IsAnything(given) || IsAnything(wanted) || given == wanted) return true;
  const std::string_view given_local = LocalXsd(given), wanted_local = LocalXsd(wanted);
  if (IsDatatype(given) != IsDatatype(wanted)) return given_local == "anyURI" || wanted_local == "anyURI";
  if (!IsDatatype(given)) return true;  // whether two classes share a thing only the graph may know
  if (IsAnyLiteral(given) || IsAnyLiteral(wanted)) return true;
  if (IsNarrower(given_local, wanted_local) || IsNarrower(wanted_local, given_local)) return true;
  if (IsInteger(given_local) && IsInteger(wanted_local)) return true;  // 3 is an int and a positiveInteger
  const auto is_text = [](std::string_view type) {
    return type == kRdfLangString || type == kXsdString || type == Concat(kRdfNs, "PlainLiteral");
  };
  if (is_text(given) && is_text(wanted)) return true;
  // Of a datatype that is not known here nothing is known.
  const auto is_known = [&](std::string_view type, std::string_view local) {
    return !local.empty() || is_text(type);
  };
  return !is_known(given, given_local) || !is_known(wanted, wanted_local);
}

std::string TypeFault(const Term& value, std::string_view type) {
  if (IsAnything(type)) return "";
  const std::string name = TypeName(type);
  if (!value.IsLiteral()) {
    if (!IsDatatype(type) || LocalXsd(type) == "anyURI") return "";
    return Concat("is a resource, and ", name, " is a datatype; give a literal");
  }
  if (!IsDatatype(type)) return Concat("is a literal, and ", name, " is a class; give <iri> or prefix:local");
  const std::string given = DatatypeOf(value);
  if (!HasItsForm(value, LocalXsd(given))) return Concat("does not have the form of ", TypeName(given));
  if (!MayBeOf(given, type)) return Concat("is of ", TypeName(given), ", not of ", name);
  if (IsAnyLiteral(type) || IsNarrower(LocalXsd(given), LocalXsd(type)) || !IsNumberLiteral(value) ||
      !IsNumberLiteral(Term::Literal("", std::string(type))))
    return "";
  // A number of a wider datatype is one of the narrower, if that has its value.
  bool fits = FiniteNumber(value).has_value();
  if (IsInteger(LocalXsd(type))) {
    const std::optional<std::string> digits = WholeDigits(value);
    fits = fits && digits && IsInRange(*digits, LocalXsd(type));
  }
  return fits ? "" : Concat("is not of ", name);
}

std::string FullType(std::string_view type) {
  const size_t colon = type.find(':');
  if (colon == std::string_view::npos) return std::string(type);
  for (const auto& [prefix, name_space] : kWellKnownPrefixes) {
    if (type.substr(0, colon) == prefix) return Concat(name_space, type.substr(colon + 1));
  }
  return std::string(type);
}

std::string TypeName(std::string_view type) {
  return IriNames::WellKnown().Iri(type);
}

std::string PartsText(const std::vector<std::string>& parts, const PartTypes& types) {
  if (parts.empty()) return "nothing";
  std::vector<std::string> words;
  for (const std::string& part : parts) {
    const auto type = types.find(part);
    words.push_back(type == types.end() ? part : Concat(part, " (", TypeName(type->second), ")"));
  }
  return xml::ListOf(words);
}

}  // namespace docent::rsel
