// Catalog of deployed workflows, registered services and loaded modules: an immutable picture that the
// writer thread makes when documents change; the committer publishes it beside the graph version.
#ifndef DOCENT_KB_SERVER_DOOR_CATALOG_H_
#define DOCENT_KB_SERVER_DOOR_CATALOG_H_

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "graph/base/ids.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/document_versions.h"
#include "reasoner/explain/rule_text.h"
#include "workflow/cawl/ast.h"
#include "workflow/rsel/service_registry.h"

namespace docent::server {

// The named graph of an ontology module.
std::string OntologyGraph(const std::string& name);

// An ontology module or a rule set.
struct ModuleEntry {
  std::string name;
  Document::Kind kind = Document::Kind::kOntology;
  uint64_t size = 0;                        // triples, or rules
  Revision revision;                        // that put it
  std::shared_ptr<const std::string> text;  // of a rule set; of an ontology its prefix declarations (Turtle)
};

struct Catalog {
  std::vector<ModuleEntry> modules;
  std::vector<std::pair<cawl::DocumentPtr, Revision>> workflows;  // by name
  std::set<std::string> disabled_workflows;
  rsel::ServiceRegistry services;
  VersionHistory versions;               // of workflows and RSEL documents, removed ones too
  std::vector<explain::RuleText> rules;  // by name

  // Null: none of that name is deployed.
  cawl::DocumentPtr FindWorkflow(std::string_view name) const;
};

// The newest catalog; any thread.
class CatalogPort {
 public:
  std::shared_ptr<const Catalog> Get() const {
    absl::MutexLock lock(&mutex_);
    return catalog_;
  }
  void Publish(std::shared_ptr<const Catalog> catalog) {
    absl::MutexLock lock(&mutex_);
    catalog_ = std::move(catalog);
  }

 private:
  mutable absl::Mutex mutex_;
  std::shared_ptr<const Catalog> catalog_ ABSL_GUARDED_BY(mutex_) = std::make_shared<const Catalog>();
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_CATALOG_H_
