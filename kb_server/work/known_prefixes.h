// The prefixes that loaded documents declare: for naming IRIs to people, and known in their queries and updates without a
// declaration. Any thread.
#ifndef DOCENT_KB_SERVER_WORK_KNOWN_PREFIXES_H_
#define DOCENT_KB_SERVER_WORK_KNOWN_PREFIXES_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "graph/base/prefix_limits.h"
#include "graph/rdf/iri_names.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/ports.h"

namespace docent::server {

// The declarations of an ontology module as Turtle, a line each, without the well-known ones and within the limits: what
// the log and the catalog keep as the module's text.
std::string DeclarePrefixes(const std::vector<std::pair<std::string, std::string>>& prefixes,
                            const PrefixLimits& limits = {});

// The well-known prefixes, and those of ontology modules, rule sets and workflows, each kind by name; the first that has a
// name counts. At most known_prefixes. Thread-safe.
class KnownPrefixes {
 public:
  // `catalog` must outlive it.
  explicit KnownPrefixes(const CatalogPort* catalog, const PrefixLimits& limits = {})
      : catalog_(*catalog), limits_(limits) {}

  // Those of the newest catalog, whose texts are read once as long as it stays the same.
  std::shared_ptr<const IriNames> Get();

 private:
  const CatalogPort& catalog_;
  const PrefixLimits limits_;
  absl::Mutex mutex_;
  std::shared_ptr<const Catalog> read_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const IriNames> names_ ABSL_GUARDED_BY(mutex_);
};

// Those that a text of a client may use without a declaration; null: the well-known ones alone.
std::shared_ptr<const IriNames> KnownNames(const ReadPorts& ports);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_KNOWN_PREFIXES_H_
