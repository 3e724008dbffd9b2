// Rehearsal of loads: what a server that has nothing else would say if these documents were loaded one after the other.
//
// `docent check` must not pass what a load refuses. So each document goes through the turn that the server would make of
// it (kb_server/turn/turn.h), with the server's limits, in memory. A refused document changes nothing for those after it.
// One thread.
#ifndef DOCENT_KB_SERVER_CLI_REHEARSAL_LOAD_REHEARSAL_H_
#define DOCENT_KB_SERVER_CLI_REHEARSAL_LOAD_REHEARSAL_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/write_batch.h"
#include "kb_server/turn/turn.h"

namespace docent::server {

class LoadRehearsal {
 public:
  // `functions`, those of a server, must outlive it.
  explicit LoadRehearsal(const sparql::FunctionRegistry* functions, const Limits& limits = {});

  // Facts, as `docent load FILE` loads them. Each returns the server's error.
  absl::Status LoadData(const std::vector<TermQuad>& facts);
  // A rule set, a workflow or an RSEL document.
  absl::Status LoadDocument(Document document);

  // Of all that was loaded, with what rules made of it.
  size_t facts() const { return stages_.writer.current().size(); }

 private:
  absl::Status Turn(WriteBatch batch);

  const Limits limits_;
  Dictionary dictionary_;
  Cancellation cancellation_;  // never cancelled: the turn tells it how many steps are allowed
  Stages stages_;
  uint64_t offset_ = 0;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_REHEARSAL_LOAD_REHEARSAL_H_
