// SHACL validation (W3C Recommendation, section 3): which nodes of a data graph violate which shapes. Reads an
// immutable version: beside the writer, on any thread; one validation is one thread's.
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

// Section 3.6.2. Its ids are the dictionary's.
struct ValidationResult {
  TermId focus;
  TermId value;                  // none where the component names no value
  std::optional<Term> computed;  // in its place: a value that a query computed
  bool has_path = false;
  Path path;
  Component component = Component::kClass;
  TermId own_component;  // of Component::kOwn: which
  TermId constraint;     // sh:sourceConstraint; none but for sh:sparql
  TermId shape;          // sh:sourceShape
  TermId severity;
  std::vector<Term> messages;             // sh:message of the shape, else one of ours
  std::vector<ValidationResult> details;  // sh:node: why the value does not conform to the other shape
};

struct ValidationReport {
  std::vector<ValidationResult> results;  // by shape, then by focus node
  uint64_t total = 0;                     // results found; more than `results` has where that is full
  uint64_t focus_nodes = 0;               // nodes that a shape was held against, each counted once
  bool conforms() const { return total == 0; }
};

struct ValidateOptions {
  CheckLimits limits;
  size_t memory_bytes =
      Limits{}.query_memory_bytes;       // of the validation, and again of each query of its shapes
  MemoryBudget* all_memory = nullptr;    // of these queries with all others; null: it is not counted
  Cancellation* cancellation = nullptr;  // may be null
  const sparql::FunctionRegistry* functions = nullptr;  // that queries may call; null: casts and builtins
  TimeMicros now_us = 0;                                // NOW() in queries
};

// CANCELLED, DEADLINE_EXCEEDED, or RESOURCE_EXHAUSTED naming query_memory_bytes; INVALID_ARGUMENT, with its shape, where a
// query calls an unknown function; FAILED_PRECONDITION where one says that it failed (?failure): then there is no report.
absl::StatusOr<ValidationReport> Validate(const ShapeSet& shapes, const GraphView& data,
                                          const Dictionary& dictionary, const ValidateOptions& options = {});

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_VALIDATOR_H_
