// Versions of a workflow or RSEL document: the texts that were deployed or registered under its name, the newest of them kept.
// They stay when the document is removed. Values; any thread.
#ifndef DOCENT_KB_SERVER_DOOR_DOCUMENT_VERSIONS_H_
#define DOCENT_KB_SERVER_DOOR_DOCUMENT_VERSIONS_H_

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/document_limits.h"
#include "graph/base/ids.h"
#include "graph/store/write_batch.h"

namespace docent::server {

// Text of the removal of a document (Document::Action::kRemove) that is done although others use it.
inline constexpr char kForcedRemoval[] = "force";

// One text. `number` counts from 1 and is not used again.
struct DocumentVersion {
  uint32_t number = 0;
  std::string own_version;  // the document's @version
  Revision revision;        // that brought it
  TimeMicros time_us = 0;   // of that turn
  std::string text;
};
using DocumentVersionPtr = std::shared_ptr<const DocumentVersion>;

// The versions of one document, oldest first; never empty.
struct DocumentVersions {
  std::vector<DocumentVersionPtr> kept;
  bool live = false;  // the newest one is deployed or registered
  Revision removed;   // that removed the document; while it is not live

  const DocumentVersion& newest() const { return *kept.back(); }
};
using DocumentVersionsPtr = std::shared_ptr<const DocumentVersions>;

// The versions of all documents. A copy shares the texts.
class VersionHistory {
 public:
  using Key = std::pair<Document::Kind, std::string>;

  // The document has this text from now on; no new version where the newest one has it, too. The oldest versions go when there
  // are more than version_texts, or when the texts of the document have more than version_text_bytes; the newest stays.
  void Put(const Key& key, const std::string& own_version, const std::string& text, Revision revision,
           TimeMicros time_us);
  // The document is removed. Of removed documents the last removed_documents are remembered.
  void Remove(const Key& key, Revision revision);

  // Null: no document of this name was ever there.
  DocumentVersionsPtr Find(const Key& key) const;
  const std::map<Key, DocumentVersionsPtr>& all() const { return documents_; }
  // One document as it was saved.
  void Restore(const Key& key, DocumentVersions versions);

 private:
  std::map<Key, DocumentVersionsPtr> documents_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_DOCUMENT_VERSIONS_H_
