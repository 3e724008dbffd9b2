#include "kb_server/robots/measures.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/number_literal.h"
#include "graph/rdf/vocabulary.h"

namespace docent::server {
namespace {

// The values that a property may have.
struct Range {
  std::string_view local;
  int least = 0, most = 0;
  std::string_view unit;
};
constexpr Range kRanges[] = {{"x", -1000000, 1000000, "metres"},
                             {"y", -1000000, 1000000, "metres"},
                             {"heading", -1000, 1000, "radians"},
                             {"progress", 0, 1, "of the whole"}};

const Range* RangeOf(std::string_view predicate) {
  if (!predicate.starts_with(kDocentNs)) return nullptr;
  const std::string_view local = predicate.substr(kDocentNs.size());
  const auto found = std::find_if(std::begin(kRanges), std::end(kRanges),
                                  [local](const Range& range) { return range.local == local; });
  return found == std::end(kRanges) ? nullptr : &*found;
}

}  // namespace

absl::Status CheckMeasure(std::string_view predicate, const Term& value, const std::string& what) {
  const Range* range = RangeOf(predicate);
  if (range == nullptr && !IsNumberLiteral(value)) return absl::OkStatus();
  const std::optional<double> number = FiniteNumber(value);
  const std::string of =
      predicate.empty() ? what : absl::StrCat(what, ": ", ToDisplay(Term::Iri(std::string(predicate))));
  if (range != nullptr && (!number || *number < range->least || *number > range->most)) {
    return absl::InvalidArgumentError(absl::StrCat(of, " is ", ToDisplay(value),
                                                   "; it must be a number from ", range->least, " to ",
                                                   range->most, " (", ToAbsl(range->unit), ")"));
  }
  if (number) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      of, " is ", ToDisplay(value), ", which is not a finite number; leave out what was not measured"));
}

std::optional<double> MeasureOf(std::string_view local, const std::vector<Term>& values) {
  const Range* range = RangeOf(DocentIri(local));
  for (const Term& value : values) {
    const std::optional<double> number = FiniteNumber(value);
    if (number && range != nullptr && *number >= range->least && *number <= range->most) return number;
  }
  return std::nullopt;
}

}  // namespace docent::server
