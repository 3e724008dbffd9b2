// SHACL validation (W3C Recommendation, section 3): finds the nodes of a data graph that violate shapes. It
// reads an immutable version: beside the writer, on any thread; one thread for each validation.
#ifndef DOCENT_REASONER_SHAPES_VALIDATOR_H_
#define DOCENT_REASONER_SHAPES_VALIDATOR_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/check_limits.h"
#include "graph/base/clock.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "reasoner/shapes/graph_view.h"
#include "reasoner/shapes/shape.h"

namespace docent {
class MemoryBudget;
}
namespace docent::sparql {
class FunctionRegistry;
}

namespace docent::shapes {

// A result of section 3.6.2. Its ids are those of the dictionary that Validate was given.
struct ValidationResult {
  TermId focus;
  TermId value;                  // kNone if the component names no value
  std::optional<Term> computed;  // instead of `value`: a value computed by a query
  bool has_path = false;
  Path path;
  Component component = Component::kClass;
  TermId own_component;  // the component, if it is Component::kOwn
  TermId constraint;     // sh:sourceConstraint; kNone except for sh:sparql
  TermId shape;          // sh:sourceShape
  TermId severity;
  std::vector<Term> messages;             // sh:message of the shape, else our own
  std::vector<ValidationResult> details;  // sh:node: why the value does not conform to the other shape
};

struct ValidationReport {
  std::vector<ValidationResult> results;  // by shape, then by focus node
  uint64_t total = 0;                     // results found; `results` has fewer beyond its limit
  uint64_t focus_nodes = 0;               // nodes checked against a shape, each counted once
  bool conforms() const { return total == 0; }
};

struct ValidateOptions {
  CheckLimits limits;
  size_t memory_bytes =
      Limits{}.query_memory_bytes;       // of the validation, and also of each query of its shapes
  MemoryBudget* all_memory = nullptr;    // shared by these queries and all others; null: not counted
  Cancellation* cancellation = nullptr;  // may be null
  const sparql::FunctionRegistry* functions = nullptr;  // for queries; null: casts and builtins only
  TimeMicros now_us = 0;                                // NOW() in queries
};

// `dictionary` is the caller's own, over the one of the data: it receives targets that queries compute.
// CANCELLED, DEADLINE_EXCEEDED, or RESOURCE_EXHAUSTED naming query_memory_bytes; INVALID_ARGUMENT, with its
// shape, if a query calls an unknown function; FAILED_PRECONDITION if a query reports a failure (?failure):
// then there is no report.
absl::StatusOr<ValidationReport> Validate(const ShapeSet& shapes, const GraphView& data,
                                          Dictionary& dictionary, const ValidateOptions& options = {});

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_VALIDATOR_H_
