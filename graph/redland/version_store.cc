#include "graph/redland/version_store.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/limits.h"
#include "graph/rdf/term_check.h"

namespace docent::redland {
namespace {

// Ids of a query; false: a term is not in the dictionary, so there are no matches.
bool Resolve(const Dictionary& dictionary, const std::optional<Term>& term, TermId* id) {
  if (!term) return true;
  const std::optional<TermId> found = dictionary.Find(*term);
  if (found) *id = *found;
  return found.has_value();
}

class VersionStream final : public QuadStream {
 public:
  VersionStream(const Dictionary& dictionary, GraphVersionPtr version, const QuadPattern& pattern)
      : dictionary_(dictionary), version_(std::move(version)), cursor_(version_->Scan(pattern)) {}

  bool Next(TermQuad* quad) override {
    if (!cursor_.Valid()) return false;
    const Quad ids = cursor_.quad();
    Decode(ids.subject, last_.subject, &quad->subject);
    Decode(ids.predicate, last_.predicate, &quad->predicate);
    Decode(ids.object, last_.object, &quad->object);
    Decode(ids.graph, last_.graph, &quad->graph);
    last_ = ids;
    decoded_ = *quad;
    cursor_.Next();
    return true;
  }

 private:
  // Neighbours in an index share most of their terms, so the last ones are reused.
  void Decode(TermId id, TermId last, Term* term) const {
    if (id == last) {
      *term = id == last_.subject     ? decoded_.subject
              : id == last_.predicate ? decoded_.predicate
              : id == last_.object    ? decoded_.object
                                      : decoded_.graph;
    } else {
      *term = dictionary_.Decode(id);
    }
  }

  const Dictionary& dictionary_;
  const GraphVersionPtr version_;
  QuadCursor cursor_;
  Quad last_;         // the quad of `decoded_`
  TermQuad decoded_;  // the quad before
};

}  // namespace

std::unique_ptr<QuadStream> FindInVersion(const Dictionary& dictionary, GraphVersionPtr version,
                                          const QuadQuery& query) {
  QuadPattern pattern;
  if (!Resolve(dictionary, query.subject, &pattern.subject) ||
      !Resolve(dictionary, query.predicate, &pattern.predicate) ||
      !Resolve(dictionary, query.object, &pattern.object) ||
      !Resolve(dictionary, query.graph, &pattern.graph)) {
    return StreamOf({});
  }
  return std::make_unique<VersionStream>(dictionary, std::move(version), pattern);
}

std::vector<Term> GraphsOfVersion(const Dictionary& dictionary, const GraphVersion& version) {
  std::vector<Term> graphs;
  for (TermId id : version.graphs()) graphs.push_back(dictionary.Decode(id));
  std::sort(graphs.begin(), graphs.end());
  return graphs;
}

absl::StatusOr<std::unique_ptr<QuadStream>> VersionStore::Find(const QuadQuery& query) {
  return FindInVersion(dictionary_, version_, query);
}

absl::StatusOr<uint64_t> VersionStore::Size() {
  return version_->size();
}

absl::StatusOr<std::vector<Term>> VersionStore::Graphs() {
  return GraphsOfVersion(dictionary_, *version_);
}

absl::Status VersionStore::Apply(std::vector<QuadOperation>) {
  return absl::FailedPreconditionError(
      absl::StrCat("revision ", version_->revision().value(), " of the graph is read only"));
}

WriterStore::WriterStore(Dictionary* dictionary, GraphWriter* writer, Revision start)
    : dictionary_(*dictionary), writer_(*writer), version_(writer->Freeze(start)) {}

absl::StatusOr<std::unique_ptr<QuadStream>> WriterStore::Find(const QuadQuery& query) {
  return FindInVersion(dictionary_, version_, query);
}

absl::StatusOr<uint64_t> WriterStore::Size() {
  return version_->size();
}

absl::StatusOr<std::vector<Term>> WriterStore::Graphs() {
  return GraphsOfVersion(dictionary_, *version_);
}

absl::Status WriterStore::Apply(std::vector<QuadOperation> operations) {
  const Limits limits;
  for (size_t i = 0; i < operations.size(); ++i) {
    absl::Status status = CheckQuad(operations[i].quad, limits.term_bytes);
    if (status.ok() && !operations[i].quad.graph.IsIri()) {
      status = absl::InvalidArgumentError("graph: it must be an IRI");
    }
    if (!status.ok()) {
      return absl::Status(status.code(), absl::StrCat("operations[", i, "]: ", status.message()));
    }
  }
  for (const QuadOperation& operation : operations) {
    const TermQuad& quad = operation.quad;
    const Quad ids = {dictionary_.Intern(quad.subject), dictionary_.Intern(quad.predicate),
                      dictionary_.Intern(quad.object), dictionary_.Intern(quad.graph)};
    if (operation.kind == QuadOperation::Kind::kAdd) {
      writer_.Add(ids);
    } else {
      writer_.Remove(ids);
    }
  }
  version_ = writer_.Freeze(Revision(version_->revision().value() + 1));
  return absl::OkStatus();
}

}  // namespace docent::redland
