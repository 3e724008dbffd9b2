// What robots and sensors may tell as measured values. Any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_MEASURES_H_
#define DOCENT_KB_SERVER_ROBOTS_MEASURES_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "graph/rdf/term.h"

namespace docent::server {

// INVALID_ARGUMENT where the value of a fact that is told (Context.Assert), or of a reading (empty predicate), cannot be
// measured: a number that is not finite or not well-formed; a docent:x, y, heading or progress that is no number, or beyond what
// the property may be. `what` is its place in the request: "add[3]". Data that is loaded is not held to it: RDF has NaN.
absl::Status CheckMeasure(std::string_view predicate, const Term& value, const std::string& what);

// The first of the values that docent:x, y or heading (`local`) may have; nullopt: none of them is a measure.
std::optional<double> MeasureOf(std::string_view local, const std::vector<Term>& values);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_MEASURES_H_
