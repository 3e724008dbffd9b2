// SERVICE (SPARQL 1.1 Federated Query): the parts of a query that other endpoints answer. They are queried
// before the query is planned, and their answers replace them as VALUES, so planner and operators do not see
// SERVICE at all.
#ifndef DOCENT_GRAPH_SPARQL_RUN_FEDERATION_H_
#define DOCENT_GRAPH_SPARQL_RUN_FEDERATION_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/update_algebra.h"

namespace docent::sparql {

using ServiceRow = std::vector<std::optional<Term>>;  // a term for each variable

// What a row takes in memory, in bytes.
size_t MemoryOf(const ServiceRow& row);

struct ServiceAnswer {
  std::vector<std::string> variables;
  std::vector<ServiceRow> rows;
  size_t counted =
      0;  // bytes of it in the memory that Select was given; whoever drops the answer releases them
};

// Client for other endpoints. Any thread.
class ServiceClient {
 public:
  virtual ~ServiceClient() = default;
  // The rows of a SELECT; any text may label a blank node. `silent`: the query goes on without them, so some time is kept
  // for it. `memory` counts what comes and what is kept.
  // PERMISSION_DENIED for an endpoint that is not allowed, UNKNOWN (the endpoint fails), DEADLINE_EXCEEDED,
  // RESOURCE_EXHAUSTED (an answer beyond a limit, named).
  virtual absl::StatusOr<ServiceAnswer> Select(const std::string& endpoint, const std::string& query,
                                               bool silent, Cancellation* cancellation,
                                               MemoryUse* memory) = 0;
};

bool HasService(const Query& query);
bool HasService(const Update& update);

// Replaces each SERVICE in `query` by its endpoint's answer. SERVICE ?x is sent to each IRI that the patterns
// joined with it bind to ?x in `run`'s version. SILENT turns a failure into one empty solution; without it
// the error names the endpoint and the place. `client` null: no endpoint is allowed.
absl::Status ResolveServices(Query* query, ServiceClient* client, const Dictionary& dictionary,
                             const PrepareOptions& options, const RunOptions& run);
// The same for the WHERE of each operation; the endpoints of an operation are determined on the version
// before the update.
absl::Status ResolveServices(Update* update, ServiceClient* client, const Dictionary& dictionary,
                             const PrepareOptions& options, const RunOptions& run);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_FEDERATION_H_
