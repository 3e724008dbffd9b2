// Words that the loaded ontologies do not have, though they have others of the same namespace: misspelt predicates and classes.
// Thread-safe.
#ifndef DOCENT_KB_SERVER_WORK_UNKNOWN_WORDS_H_
#define DOCENT_KB_SERVER_WORK_UNKNOWN_WORDS_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/diagnostic.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/ports.h"
#include "kb_server/work/load_judge.h"

namespace docent::server {

// What ontology modules declare. A word is whatever they say something of.
struct DeclaredWords {
  absl::flat_hash_set<std::string> words;
  absl::flat_hash_set<std::string> property_spaces,
      class_spaces;  // namespaces of declared properties and classes
};

class UnknownWords {
 public:
  // Both must outlive it. `catalog` null: modules are read again each time.
  UnknownWords(const ReadPorts* ports, const CatalogPort* catalog) : ports_(*ports), catalog_(catalog) {}

  // A warning for each predicate of the facts and rules that `batch` adds, and each class of a thing, that is in a namespace of the
  // ontologies and not among their words: at most kMost, with the nearest word, and its place in the rules, or in `text` if there is
  // one.
  Diagnostics In(const WriteBatch& batch, const LoadedText& text);

  static constexpr size_t kMost = 20;

 private:
  std::shared_ptr<const DeclaredWords> Declared();

  const ReadPorts& ports_;
  const CatalogPort* const catalog_;
  absl::Mutex mutex_;
  std::shared_ptr<const Catalog> read_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const DeclaredWords> declared_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_UNKNOWN_WORDS_H_
