#include "kb_server/writer/log_history.h"

#include <algorithm>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "graph/log/record_codec.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/reading_mapper.h"

namespace docent::server {
namespace {

constexpr uint64_t kChunk = 500;  // records read at once

std::string KeyOf(const TermQuad& quad) {
  return absl::StrCat(ToNTriples(quad.subject), " ", ToNTriples(quad.predicate), " ", ToNTriples(quad.object),
                      " ", quad.graph.lexical);
}

std::string OntologyOf(const WriteBatch& batch) {
  for (const Document& document : batch.documents) {
    if (document.kind == Document::Kind::kOntology) return absl::StrCat("ontology ", document.name);
  }
  return "";
}

// What is wanted and not found yet: key → places in the answer.
class Search {
 public:
  Search(const std::vector<TermQuad>& quads, const Dictionary& dictionary, const GraphVersion& version)
      : dictionary_(dictionary), version_(version), found_(quads.size()) {
    for (size_t i = 0; i < quads.size(); ++i) {
      if (quads[i].graph.lexical == kRunsGraph) continue;  // by the engine, not by a batch
      wanted_[KeyOf(quads[i])].push_back(i);
    }
  }
  bool done() const { return wanted_.empty(); }
  std::vector<std::optional<explain::Telling>>& found() { return found_; }

  void Look(const log::TurnRecord& record) {
    const WriteBatch& batch = record.batch;
    const std::string default_graph = batch.source.empty() ? std::string(kDefaultGraph) : batch.source;
    const auto found = [&](const TermQuad& quad, const std::string& by) {
      const auto place = wanted_.find(KeyOf(quad));
      if (place == wanted_.end()) return;
      for (size_t i : place->second) found_[i] = explain::Telling{record.offset, record.time_us, by};
      wanted_.erase(place);
    };
    for (const log::RunTelling& telling : record.told) {
      const size_t slash = telling.by.find('/');
      found(telling.quad,
            absl::StrCat("run ", NameOfSegment(telling.by.substr(0, slash)), ", node ",
                         slash == std::string::npos ? "" : NameOfSegment(telling.by.substr(slash + 1))));
    }
    const auto take = [&](const QuadOperation& operation, const std::string& by) {
      if (operation.kind != QuadOperation::Kind::kAdd) return;
      TermQuad quad = operation.quad;
      if (quad.graph.lexical.empty()) quad.graph = Term::Iri(default_graph);
      found(quad, by);
    };
    const std::string by = OntologyOf(batch);
    for (const QuadOperation& operation : batch.operations) take(operation, by);
    for (const SensorReading& reading : batch.readings) {
      auto mapped = MapReadings({reading}, dictionary_, version_);
      if (!mapped.ok()) continue;  // its mapping is no longer there
      for (const QuadOperation& operation : *mapped)
        take(operation, absl::StrCat("reading of <", reading.sensor, ">"));
    }
  }

 private:
  const Dictionary& dictionary_;
  const GraphVersion& version_;
  absl::flat_hash_map<std::string, std::vector<size_t>> wanted_;
  std::vector<std::optional<explain::Telling>> found_;
};

}  // namespace

absl::StatusOr<std::vector<std::optional<explain::Telling>>> LogHistory::Find(
    const std::vector<TermQuad>& quads, const GraphVersion& version, Cancellation* cancellation) {
  Search search(quads, dictionary_, version);
  auto first = log_.First();
  if (!first.ok()) return first.status();
  uint64_t end = version.revision().value() + 1;  // records before it are to be looked at
  uint64_t looked = 0;
  while (!search.done() && end > *first && looked < limits_.explain_log_records) {
    if (cancellation != nullptr) {
      if (absl::Status status = cancellation->Check(); !status.ok()) return status;
    }
    const uint64_t begin = end - std::min(kChunk, end - *first);
    std::vector<log::LogEntry> chunk;
    while (chunk.size() < end - begin) {
      auto entries = log_.Read(begin + chunk.size(), end - begin - chunk.size());
      if (!entries.ok()) return entries.status();
      if (entries->empty()) break;
      std::move(entries->begin(), entries->end(), std::back_inserter(chunk));
    }
    for (auto entry = chunk.rbegin(); entry != chunk.rend() && !search.done(); ++entry) {
      auto record = log::DecodeTurnRecord(entry->offset, entry->data);
      if (!record.ok()) return record.status();
      search.Look(*record);
    }
    looked += end - begin;
    end = begin;
  }
  return std::move(search.found());
}

}  // namespace docent::server
