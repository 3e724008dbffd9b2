// The prefixes that loaded documents declare, for naming IRIs to people. Any thread.
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

namespace docent::server {

// The declarations of an ontology module as Turtle, a line each, without the well-known ones and within the limits: what
// the log and the catalog keep as the module's text.
std::string DeclarePrefixes(const std::vector<std::pair<std::string, std::string>>& prefixes,
                            const PrefixLimits& limits = {});

// The well-known prefixes, and those of ontology modules, rule sets and workflows, each kind by name; the first that has a
// name counts. At most known_prefixes. Thread-safe.
class KnownPrefixes {
 public:
  explicit KnownPrefixes(const PrefixLimits& limits = {}) : limits_(limits) {}

  // Those of a catalog, whose texts are read once as long as it stays the same.
  std::shared_ptr<const IriNames> Of(const std::shared_ptr<const Catalog>& catalog);

 private:
  const PrefixLimits limits_;
  absl::Mutex mutex_;
  std::shared_ptr<const Catalog> read_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const IriNames> names_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_KNOWN_PREFIXES_H_
