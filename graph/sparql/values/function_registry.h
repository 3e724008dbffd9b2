// Registry of functions that SPARQL calls by IRI: FILTER(docent:distance(?a, ?b) < 2.0). The server registers
// them (spatial functions live beside the maps), so queries, rules and conditions use them without a
// dependency on their folders.
//
// Filled once at start, then read by any thread. The xsd: casts are part of the evaluator and not in here.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_FUNCTION_REGISTRY_H_
#define DOCENT_GRAPH_SPARQL_VALUES_FUNCTION_REGISTRY_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/rdf/term.h"

namespace docent::sparql {

// A function from bound terms to a term. An error status is a type error of the expression: FILTER drops the
// row, BIND leaves the variable unbound. It must depend only on its arguments, be thread-safe, and throw
// nothing.
using NamedFunction = std::function<absl::StatusOr<Term>(absl::Span<const Term> arguments)>;

struct FunctionEntry {
  NamedFunction call;
  int min_arguments = 0;
  int max_arguments = 0;
};

class FunctionRegistry {
 public:
  // ALREADY_EXISTS if the IRI is taken; INVALID_ARGUMENT for an empty function or a minimum above the
  // maximum.
  absl::Status Register(std::string_view iri, int min_arguments, int max_arguments, NamedFunction function);
  // Null if unknown. The entry lives as long as the registry; later Registers do not move it.
  const FunctionEntry* Find(std::string_view iri) const;
  // All IRIs, sorted (hints, documentation).
  std::vector<std::string> Names() const;

 private:
  absl::flat_hash_map<std::string, std::unique_ptr<FunctionEntry>> functions_;
};

// A mistake in a call: the IRI is neither in the registry (which may be null) nor a cast, or the number of
// arguments is wrong.
struct CallMistake {
  std::string message, hint;
};
std::optional<CallMistake> FindCallMistake(const FunctionRegistry* functions, const std::string& iri,
                                           size_t arguments);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_FUNCTION_REGISTRY_H_
