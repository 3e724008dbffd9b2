#include "workflow/cawl/value_type.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "absl/strings/numbers.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {
namespace {

// In the order in which one is promoted to the next; 0: no number. The integers of XML Schema are one step.
int NumericRank(std::string_view datatype) {
  if (!datatype.starts_with(kXsdNs)) return 0;
  datatype.remove_prefix(kXsdNs.size());
  static constexpr std::string_view kIntegers[] = {"integer",
                                                   "long",
                                                   "int",
                                                   "short",
                                                   "byte",
                                                   "nonNegativeInteger",
                                                   "positiveInteger",
                                                   "nonPositiveInteger",
                                                   "negativeInteger",
                                                   "unsignedLong",
                                                   "unsignedInt",
                                                   "unsignedShort",
                                                   "unsignedByte"};
  if (std::find(std::begin(kIntegers), std::end(kIntegers), datatype) != std::end(kIntegers)) return 1;
  return datatype == "decimal" ? 2 : datatype == "float" ? 3 : datatype == "double" ? 4 : 0;
}

bool IsNumber(const Term& value, int rank) {
  int64_t whole = 0;
  double number = 0;
  if (rank == 1) {
    const size_t digits = value.lexical.find_first_not_of("+-");
    return absl::SimpleAtoi(value.lexical, &whole) ||
           (digits != std::string::npos && digits <= 1 &&
            value.lexical.find_first_not_of("0123456789", digits) == std::string::npos);
  }
  if (value.lexical == "NaN" || value.lexical == "INF" || value.lexical == "-INF") return rank > 2;
  return absl::SimpleAtod(value.lexical, &number);
}

}  // namespace

std::string TypeFault(const Term& value, const std::optional<Term>& type) {
  if (!type || !type->IsIri()) return "";
  const std::string& wanted = type->lexical;
  const bool any_literal = wanted == Concat(kRdfsNs, "Literal");
  const bool datatype = wanted.starts_with(kXsdNs) || any_literal || wanted == kRdfLangString;
  const std::string fault = Concat("is ", ToDisplay(value), ", and its type is ", ToDisplay(*type));
  if (!datatype) return value.IsLiteral() && value.datatype != wanted ? fault : "";
  if (!value.IsLiteral()) return fault;
  if (any_literal) return "";
  const std::string given = !value.language.empty()  ? std::string(kRdfLangString)
                            : value.datatype.empty() ? Concat(kXsdNs, "string")
                                                     : value.datatype;
  const int rank = NumericRank(wanted), given_rank = NumericRank(given);
  // Text in a language is a text, as in RSEL.
  const bool is_text = given == wanted || (!value.language.empty() && wanted == Concat(kXsdNs, "string"));
  if (rank == 0) return is_text ? "" : fault;
  const bool same_step =
      rank == given_rank && (rank != 1 || given == wanted || wanted == Concat(kXsdNs, "integer"));
  const bool fits = given_rank != 0 && (given_rank < rank || same_step);
  return fits && IsNumber(value, given_rank) ? "" : fault;
}

}  // namespace docent::cawl
