#include "kb_server/door/document_versions.h"

#include <algorithm>

namespace docent::server {
namespace {

void Bound(std::vector<DocumentVersionPtr>* kept) {
  size_t bytes = 0, texts = 0;
  auto oldest = kept->end();
  while (oldest != kept->begin()) {
    bytes += (*std::prev(oldest))->text.size();
    ++texts;
    if (texts > 1 && (texts > kDocumentLimits.version_texts || bytes > kDocumentLimits.version_text_bytes))
      break;
    --oldest;
  }
  kept->erase(kept->begin(), oldest);
}

}  // namespace

void VersionHistory::Put(const Key& key, const std::string& own_version, const std::string& text,
                         Revision revision, TimeMicros time_us) {
  const DocumentVersionsPtr before = Find(key);
  auto after =
      before == nullptr ? std::make_shared<DocumentVersions>() : std::make_shared<DocumentVersions>(*before);
  after->live = true;
  after->removed = Revision();
  if (before == nullptr || before->newest().text != text) {
    const uint32_t number = before == nullptr ? 1 : before->newest().number + 1;
    after->kept.push_back(std::make_shared<const DocumentVersion>(
        DocumentVersion{number, own_version, revision, time_us, text}));
    Bound(&after->kept);
  }
  documents_[key] = std::move(after);
}

void VersionHistory::Remove(const Key& key, Revision revision) {
  const auto found = documents_.find(key);
  if (found == documents_.end()) return;
  auto after = std::make_shared<DocumentVersions>(*found->second);
  after->live = false;
  after->removed = revision;
  found->second = std::move(after);
  const auto is_live = [](const auto& entry) { return entry.second->live; };
  const size_t removed = documents_.size() - std::count_if(documents_.begin(), documents_.end(), is_live);
  if (removed <= kDocumentLimits.removed_documents) return;
  const auto first =
      std::min_element(documents_.begin(), documents_.end(), [&](const auto& a, const auto& b) {
        return std::pair(is_live(a), a.second->removed) < std::pair(is_live(b), b.second->removed);
      });
  documents_.erase(first);
}

DocumentVersionsPtr VersionHistory::Find(const Key& key) const {
  const auto found = documents_.find(key);
  return found == documents_.end() ? nullptr : found->second;
}

void VersionHistory::Restore(const Key& key, DocumentVersions versions) {
  documents_[key] = std::make_shared<const DocumentVersions>(std::move(versions));
}

}  // namespace docent::server
