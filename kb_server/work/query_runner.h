// Runner of SPARQL queries, one for all protocols: parses a query, finds the graph version that it reads, evaluates it
// within the limits of memory and time, and gives the answer to a sink, which brings it to the client.
#ifndef DOCENT_KB_SERVER_WORK_QUERY_RUNNER_H_
#define DOCENT_KB_SERVER_WORK_QUERY_RUNNER_H_

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::server {

struct ReadPorts;

struct QueryRequest {
  std::string text;
  std::string base_iri;  // of relative IRIs; empty: there are none
  // The data set that the protocol gives; where one of them is not empty, both take the place of the query's FROM.
  std::vector<Term> default_graphs;
  std::vector<Term> named_graphs;
  std::optional<sparql::DefaultGraph> default_graph;  // unset: what the server was started with
  std::string as_of;                                  // see ParseAsOf; empty: the newest version
  bool explain = false;                               // the plan with its real costs is the answer
};

// The way of one answer to its client. The functions are called on the thread of Run: OnBegin, then the one that belongs
// to the form of the query: OnPlan, OnBoolean, OnGraph, or OnHeader, OnRow for each row, and OnEnd. An error of one of
// them ends the run, which returns it.
class QuerySink {
 public:
  virtual ~QuerySink() = default;

  // The query is sound and will be evaluated on this version. False: its answer is not wanted, and Run returns OK.
  virtual bool OnBegin(sparql::Query::Form form, Revision revision) = 0;
  virtual void OnPlan(std::string plan) = 0;
  virtual void OnBoolean(bool answer) = 0;
  virtual void OnHeader(const std::vector<std::string>& variables) = 0;
  // The row that is being read has `bytes` of text so far: an error refuses a row that is too long to be sent.
  virtual absl::Status CheckRow(size_t /*bytes*/) { return absl::OkStatus(); }
  // A term for each variable; nullopt where it is unbound.
  virtual absl::Status OnRow(const std::vector<std::optional<Term>>& row) = 0;
  virtual void OnEnd() = 0;
  // Distinct triples, in no graph. `prefixes`: those of the query.
  virtual absl::Status OnGraph(std::vector<TermQuad> triples,
                               const std::vector<std::pair<std::string, std::string>>& prefixes) = 0;
};

// Thread-safe.
class QueryRunner {
 public:
  // `ports` must outlive it.
  explicit QueryRunner(const ReadPorts* ports) : ports_(*ports) {}

  // On a worker, for as long as the query and its sink take. INVALID_ARGUMENT with place and remedy for a text that is
  // wrong; RESOURCE_EXHAUSTED naming the limit; CANCELLED, DEADLINE_EXCEEDED; errors of SERVICE, of `as_of` and of the sink.
  // After an error the sink has not got the whole answer.
  absl::Status Run(const QueryRequest& request, Cancellation* cancellation, QuerySink* sink) const;

 private:
  const ReadPorts& ports_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_QUERY_RUNNER_H_
