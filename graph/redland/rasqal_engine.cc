#include "graph/redland/rasqal_engine.h"

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/overload.h"
#include "graph/rdf/term_check.h"
#include "graph/redland/rasqal_guard.h"
#include "graph/redland/redland_nodes.h"
#include "graph/redland/redland_world.h"
#include "graph/redland/storage.h"
#include "graph/redland/version_store.h"
#include "graph/sparql/syntax/algebra_printer.h"

namespace docent::redland {
namespace {

// Rasqal cannot be cancelled: once the evaluation must end, its input ends, and its answer is thrown
// away.
struct Brake {
  Cancellation* cancellation;
  absl::Status status;

  bool Pressed() {
    if (status.ok() && cancellation != nullptr) status = cancellation->Check();
    return !status.ok();
  }
};

class BrakedStream final : public QuadStream {
 public:
  BrakedStream(std::unique_ptr<QuadStream> quads, Brake* brake) : quads_(std::move(quads)), brake_(*brake) {}
  bool Next(TermQuad* quad) override { return !brake_.Pressed() && quads_->Next(quad); }

 private:
  const std::unique_ptr<QuadStream> quads_;
  Brake& brake_;
};

class BrakedStore final : public QuadStore {
 public:
  BrakedStore(std::unique_ptr<QuadStore> store, Brake* brake) : store_(std::move(store)), brake_(*brake) {}

  absl::StatusOr<std::unique_ptr<QuadStream>> Find(const QuadQuery& query) override {
    if (brake_.Pressed()) return StreamOf({});
    auto quads = store_->Find(query);
    if (!quads.ok()) return quads;
    return std::make_unique<BrakedStream>(*std::move(quads), &brake_);
  }
  absl::StatusOr<uint64_t> Size() override { return store_->Size(); }
  absl::StatusOr<std::vector<Term>> Graphs() override { return store_->Graphs(); }
  absl::Status Apply(std::vector<QuadOperation> operations) override {
    return store_->Apply(std::move(operations));
  }

 private:
  const std::unique_ptr<QuadStore> store_;
  Brake& brake_;
};

absl::Status TooManyRows(size_t limit) {
  return absl::ResourceExhaustedError(absl::StrCat("evaluation stopped at its limit rasqal_rows = ", limit));
}

// Rasqal's functions IRI, STRLANG and STRDT make terms of any text.
absl::Status CheckMade(const Term& term, const Limits& limits) {
  const absl::Status status = CheckTerm(term, limits.term_bytes);
  return status.ok() ? status
                     : WithMessage(status, absl::StrCat("Rasqal's answer holds what is no RDF term: ",
                                                        status.message()));
}

absl::Status ReadRows(librdf_query_results* results, const Limits& limits, Brake* brake,
                      RasqalAnswer* answer) {
  const int width = librdf_query_results_get_bindings_count(results);
  for (int i = 0; i < width; ++i) {
    answer->variables.emplace_back(librdf_query_results_get_binding_name(results, i));
  }
  for (; !librdf_query_results_finished(results); librdf_query_results_next(results)) {
    if (brake->Pressed()) return brake->status;
    if (answer->rows.size() == limits.rasqal_rows) return TooManyRows(limits.rasqal_rows);
    auto& row = answer->rows.emplace_back();
    for (int i = 0; i < width; ++i) {
      row.push_back(FromNode(NodePtr(librdf_query_results_get_binding_value(results, i)).get()));
      if (!row.back()) continue;
      if (absl::Status status = CheckMade(*row.back(), limits); !status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

absl::Status ReadTriples(librdf_query_results* results, const Limits& limits, Brake* brake,
                         RasqalAnswer* answer) {
  const StreamPtr stream(librdf_query_results_as_stream(results));
  if (!stream) return absl::InternalError("Rasqal gave no triples");
  absl::flat_hash_set<std::tuple<Term, Term, Term>> seen;
  for (; !librdf_stream_end(stream.get()); librdf_stream_next(stream.get())) {
    if (brake->Pressed()) return brake->status;
    if (answer->triples.size() == limits.rasqal_rows) return TooManyRows(limits.rasqal_rows);
    TermQuad triple = FromStatement(librdf_stream_get_object(stream.get()), Term::Iri(""));
    for (const Term* term : {&triple.subject, &triple.predicate, &triple.object}) {
      if (absl::Status status = CheckMade(*term, limits); !status.ok()) return status;
    }
    // Rasqal makes a triple once for each solution; a graph has it once.
    if (seen.emplace(triple.subject, triple.predicate, triple.object).second) {
      answer->triples.push_back(std::move(triple));
    }
  }
  return absl::OkStatus();
}

absl::Status Read(librdf_query_results* results, const Limits& limits, Brake* brake, RasqalAnswer* answer) {
  if (librdf_query_results_is_boolean(results)) {
    answer->boolean = librdf_query_results_get_boolean(results) > 0;
    return absl::OkStatus();
  }
  if (librdf_query_results_is_graph(results)) return ReadTriples(results, limits, brake, answer);
  return ReadRows(results, limits, brake, answer);
}

}  // namespace

absl::StatusOr<RasqalAnswer> RunRasqal(const sparql::Query& query, const Dictionary& dictionary,
                                       GraphVersionPtr version, Cancellation* cancellation,
                                       const Limits& limits) {
  if (absl::Status status = CheckForRasqal(query, limits); !status.ok()) return status;
  // The query is printed from the algebra: prefixes are resolved, and VALUES has its long form, which Rasqal
  // reads correctly.
  const std::string text = sparql::PrintQuery(query);

  const RedlandWorld world;
  Brake brake{cancellation, absl::OkStatus()};
  auto store =
      std::make_unique<BrakedStore>(std::make_unique<VersionStore>(&dictionary, std::move(version)), &brake);
  const StoragePtr storage(OpenStorage(world.get(), std::move(store), /*merged=*/true));
  const ModelPtr model(storage ? librdf_new_model(world.get(), storage.get(), nullptr) : nullptr);
  if (!model) return absl::InternalError("librdf could not make a model");
  const LibrdfQueryPtr run(librdf_new_query(world.get(), "sparql", nullptr, Bytes(text), nullptr));
  if (!run) return absl::InternalError("librdf could not make a query");
  const ResultsPtr results(librdf_query_execute(run.get(), model.get()));

  RasqalAnswer answer;
  answer.form = query.form;
  absl::Status read = results ? Read(results.get(), limits, &brake, &answer) : absl::OkStatus();
  if (brake.Pressed()) return brake.status;
  if (!read.ok()) return read;
  if (!results || !world.errors().empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("Rasqal refuses the query: ",
                     world.errors().empty() ? "no reason given" : absl::StrJoin(world.errors(), "; ")));
  }
  return answer;
}

}  // namespace docent::redland
