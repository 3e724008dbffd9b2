#include "graph/rdf/formats/place_recorder.h"

#include <algorithm>

namespace docent {

void PlaceRecorder::DeclarePrefix(std::string_view prefix, const std::string& iri, size_t offset) {
  newest_[std::string(prefix)] = prefixes_.size();
  prefixes_.push_back({std::string(prefix), iri, {}, 0});
  prefix_offsets_.push_back(offset);
}

void PlaceRecorder::UsePrefix(std::string_view prefix) {
  auto it = newest_.find(std::string(prefix));
  if (it != newest_.end()) ++prefixes_[it->second].uses;
}

void PlaceRecorder::Finish(std::string_view text, LocatedRdf* out) {
  out->prefixes = std::move(prefixes_);
  if (!out->rdf.ok()) return;
  std::vector<std::pair<size_t, SourceSpan*>> wanted;
  wanted.reserve(3 * offsets_.size() + prefix_offsets_.size());
  if (!offsets_.empty()) places_.resize(offsets_.size());
  for (size_t i = 0; i < offsets_.size(); ++i) {
    wanted.push_back({offsets_[i].subject, &places_[i].subject});
    wanted.push_back({offsets_[i].predicate, &places_[i].predicate});
    wanted.push_back({offsets_[i].object, &places_[i].object});
  }
  for (size_t i = 0; i < prefix_offsets_.size(); ++i)
    wanted.push_back({prefix_offsets_[i], &out->prefixes[i].span});
  std::sort(wanted.begin(), wanted.end());
  SourceSpan at{1, 1, 0, 0};
  for (const auto& [offset, span] : wanted) {
    for (; at.offset < offset && at.offset < text.size(); ++at.offset) {
      const unsigned char c = static_cast<unsigned char>(text[at.offset]);
      if (c == '\n') {
        ++at.line;
        at.column = 1;
      } else if ((c & 0xC0) != 0x80) {
        ++at.column;
      }
    }
    *span = at;
  }
  out->places = std::move(places_);
}

}  // namespace docent
