// Documents that a batch brings (ontologies, rules, workflows, robot services): checked, given to the stage
// that they are for, and described as facts, so that a query sees what is deployed. Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_DOCUMENTS_H_
#define DOCENT_KB_SERVER_TURN_DOCUMENTS_H_

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/catalog.h"
#include "reasoner/rules/rule_engine.h"
#include "workflow/engine/engine.h"

namespace docent {

class Documents {
 public:
  // Gives each document of `batch` to its stage, and extends batch->operations by what that means for the
  // graph: an ontology's graph is replaced; workflows and services are described in the graph
  // docent:documents. On an error the caller rolls the stages back. `origin`: of all documents.
  absl::Status Apply(WriteBatch* batch, Revision revision, const Dictionary& dictionary,
                     const GraphVersion& version, RuleEngine* rules, Engine* engine, const Limits& limits,
                     RuleTextOrigin origin);

  void Commit() { undo_.reset(); }
  void Rollback();

  using Key = std::pair<Document::Kind, std::string>;
  struct Entry {
    uint64_t size = 0;
    uint64_t fingerprint = 0;
    Revision revision;
    std::shared_ptr<const std::string>
        text;  // of rules and ontologies; other stages keep their documents themselves
  };
  // What is there, for snapshots; and the same put back into a fresh object, whose rules are given to `rules`.
  const std::map<Key, Entry>& entries() const { return entries_; }
  absl::Status Restore(std::map<Key, Entry> entries, RuleEngine* rules);

  // The picture for people and clients.
  std::shared_ptr<const Catalog> MakeCatalog(const Engine& engine) const;

 private:
  absl::Status ApplyOntology(const Document& document, const Dictionary& dictionary,
                             const GraphVersion& version, WriteBatch* batch);
  absl::Status ApplyRules(const Document& document, RuleTextOrigin origin, RuleEngine* rules);
  absl::Status ApplyCawl(const Document& document, Engine* engine, const Limits& limits, WriteBatch* batch,
                         std::string* name);
  absl::Status ApplyRsel(const Document& document, Engine* engine, const Limits& limits, WriteBatch* batch,
                         std::string* name);

  std::map<Key, Entry> entries_;
  std::optional<std::map<Key, Entry>> undo_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_TURN_DOCUMENTS_H_
