// What a reader of an answer to SERVICE hands over, whatever the answer is written in: variables and rows, within the limits.
// One thread.
#ifndef DOCENT_KB_SERVER_WORK_SERVICE_ROWS_H_
#define DOCENT_KB_SERVER_WORK_SERVICE_ROWS_H_

#include <cstddef>
#include <string>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "graph/base/limits.h"
#include "graph/base/memory_part.h"
#include "graph/rdf/term.h"
#include "graph/sparql/run/federation.h"

namespace docent::server {

// Errors: UNKNOWN for what no answer may hold; RESOURCE_EXHAUSTED for more rows than remote_rows, a term of more than
// term_bytes, and more than `memory` allows.
class ServiceRows {
 public:
  // `memory` counts what is kept. Both must outlive this object.
  ServiceRows(const Limits& limits, MemoryUse* memory) : limits_(limits), memory_(*memory), kept_(memory) {}

  // Before the first row.
  absl::Status AddVariable(std::string name);
  absl::Status BeginRow();
  // A value of the newest row. A variable that the head does not name is passed over.
  absl::Status Bind(const std::string& variable, Term term);

  // What is counted of it stays counted.
  sparql::ServiceAnswer Take() {
    answer_.counted = kept_.Detach();
    return std::move(answer_);
  }

 private:
  absl::Status Count(size_t bytes);

  const Limits& limits_;
  MemoryUse& memory_;
  MemoryPart kept_;
  sparql::ServiceAnswer answer_;
  absl::flat_hash_map<std::string, size_t> columns_;  // of the variables
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_SERVICE_ROWS_H_
