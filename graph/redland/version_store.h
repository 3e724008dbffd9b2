// Quad stores over graph versions of this process.
#ifndef DOCENT_GRAPH_REDLAND_VERSION_STORE_H_
#define DOCENT_GRAPH_REDLAND_VERSION_STORE_H_

#include <memory>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/redland/quad_store.h"
#include "graph/store/graph_version.h"
#include "graph/store/graph_writer.h"

namespace docent::redland {

// The answers of one version; `dictionary` must outlive the stream, which keeps the version.
std::unique_ptr<QuadStream> FindInVersion(const Dictionary& dictionary, GraphVersionPtr version,
                                          const QuadQuery& query);
std::vector<Term> GraphsOfVersion(const Dictionary& dictionary, const GraphVersion& version);

// One read-only version: Apply returns FAILED_PRECONDITION. `dictionary` must outlive it.
class VersionStore final : public QuadStore {
 public:
  VersionStore(const Dictionary* dictionary, GraphVersionPtr version)
      : dictionary_(*dictionary), version_(std::move(version)) {}

  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  absl::Status Apply(std::vector<QuadOperation> operations) override;

 private:
  const Dictionary& dictionary_;
  const GraphVersionPtr version_;
};

// A graph writer's newest version: each Apply freezes the next one. In memory only. Both must outlive it, and
// no other code may change them meanwhile.
class WriterStore final : public QuadStore {
 public:
  // `start`: the revision that the writer stands at.
  WriterStore(Dictionary* dictionary, GraphWriter* writer, Revision start);

  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override;
  absl::StatusOr<uint64_t> Size() override;
  absl::StatusOr<std::vector<Term>> Graphs() override;
  absl::Status Apply(std::vector<QuadOperation> operations) override;

  const GraphVersionPtr& version() const { return version_; }

 private:
  Dictionary& dictionary_;
  GraphWriter& writer_;
  GraphVersionPtr version_;
};

}  // namespace docent::redland

#endif  // DOCENT_GRAPH_REDLAND_VERSION_STORE_H_
