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
#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/catalog.h"
#include "reasoner/rules/rule_engine.h"
#include "workflow/engine/engine.h"

namespace docent::server {

// What documents are given to, and the graph before the batch that brings them.
struct DocumentStages {
  rules::RuleEngine* rules;
  engine::Engine* engine;
  const Dictionary& dictionary;
  const GraphVersion& version;
  const Limits& limits;
  rules::RuleTextOrigin rule_origin;  // of all documents of the batch
  TimeMicros now_us = 0;
};

class Documents {
 public:
  // Gives each document of `batch` to its stage. What that means for the graph, before the batch's own operations: the
  // quads of an ontology that is replaced go; workflows and services are described in the graph docent:documents. On an
  // error the caller rolls the stages back. FAILED_PRECONDITION: what would be removed is used by a workflow or another
  // document's process; a removal with the text kForcedRemoval is done all the same.
  absl::StatusOr<std::vector<QuadOperation>> Apply(const WriteBatch& batch, Revision revision,
                                                   const DocumentStages& stages);

  void Commit() {
    undo_.reset();
    undo_versions_.reset();
  }
  void Rollback();

  using Key = std::pair<Document::Kind, std::string>;
  struct Entry {
    uint64_t size = 0;
    Revision revision;
    std::shared_ptr<const std::string>
        text;  // of rules and ontologies; other stages keep their documents themselves
  };
  // What is there, for snapshots; and the same put back into a fresh object, whose rules are given to `rules`.
  const std::map<Key, Entry>& entries() const { return entries_; }
  absl::Status Restore(std::map<Key, Entry> entries, rules::RuleEngine* rules);
  // Likewise the versions of documents. Of those that it lacks, which are of a state from before they were kept, the text that
  // the engine has counts as the first; after the engine is restored.
  const VersionHistory& versions() const { return versions_; }
  void RestoreVersions(VersionHistory versions, const engine::Engine& engine);

  // The picture for people and clients.
  std::shared_ptr<const Catalog> MakeCatalog(const engine::Engine& engine) const;

 private:
  using Operations = std::vector<QuadOperation>;
  absl::Status ApplyOntology(const Document& document, const DocumentStages& stages, Operations* operations);
  absl::Status ApplyRules(const Document& document, rules::RuleTextOrigin origin, rules::RuleEngine* rules);
  absl::Status ApplyCawl(const Document& document, Revision revision, const DocumentStages& stages,
                         Operations* operations, std::string* name);
  absl::Status ChangeCawl(const Document& document, Revision revision, engine::Engine* engine,
                          Operations* operations);
  absl::Status ApplyRsel(const Document& document, Revision revision, const DocumentStages& stages,
                         Operations* operations, std::string* name);

  std::map<Key, Entry> entries_;
  std::optional<std::map<Key, Entry>> undo_;
  VersionHistory versions_;
  std::optional<VersionHistory> undo_versions_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_DOCUMENTS_H_
