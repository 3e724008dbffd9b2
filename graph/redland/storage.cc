#include "graph/redland/storage.h"

#include <atomic>
#include <climits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "graph/rdf/vocabulary.h"
#include "graph/redland/buffered_store.h"
#include "graph/redland/redland_nodes.h"
#include "graph/redland/statement_stream.h"

namespace docent::redland {
namespace {

constexpr char kStorageName[] = "docent";
constexpr QuadOperation::Kind kAdd = QuadOperation::Kind::kAdd;
constexpr QuadOperation::Kind kRemove = QuadOperation::Kind::kRemove;

// The instance data of a librdf_storage of ours.
struct Instance {
  std::unique_ptr<QuadStore> base;
  bool merged = false;
  std::unique_ptr<BufferedStore> transaction;

  QuadStore& store() { return transaction ? static_cast<QuadStore&>(*transaction) : *base; }
};

std::atomic<StoreOpener> g_opener{nullptr};
// Argument from OpenStorage to Init, which librdf calls from this same thread.
thread_local std::unique_ptr<Instance> t_opening;

Instance& Of(librdf_storage* storage) {
  return *static_cast<Instance*>(librdf_storage_get_instance(storage));
}

// 0, or 1 after logging the reason to librdf, one line.
int Report(librdf_world* world, const absl::Status& status) {
  if (status.ok()) return 0;
  const std::string line = absl::StrReplaceAll(absl::StripAsciiWhitespace(status.message()), {{"\n", "; "}});
  librdf_log(world, 0, LIBRDF_LOG_ERROR, LIBRDF_FROM_STORAGE, nullptr, "docent: %s", line.c_str());
  return 1;
}
int Report(librdf_storage* storage, const absl::Status& status) {
  return Report(librdf_storage_get_world(storage), status);
}

Term GraphOf(librdf_node* context) {
  return FromNode(context).value_or(Term::Iri(std::string(kDefaultGraph)));
}

// A partial statement as a query; a null context is any graph.
QuadQuery QueryOf(librdf_statement* statement, librdf_node* context) {
  QuadQuery query;
  if (statement != nullptr) {
    query.subject = FromNode(librdf_statement_get_subject(statement));
    query.predicate = FromNode(librdf_statement_get_predicate(statement));
    query.object = FromNode(librdf_statement_get_object(statement));
  }
  query.graph = FromNode(context);
  return query;
}

librdf_stream* Answer(librdf_storage* storage, const QuadQuery& query, bool merged) {
  auto quads = Of(storage).store().Find(query);
  if (!quads.ok()) {
    Report(storage, quads.status());
    return nullptr;
  }
  return NewStatementStream(storage, *std::move(quads), merged);
}

// --- lifetime of a storage

int Init(librdf_storage* storage, const char* name, librdf_hash* options) {
  librdf_world* world = librdf_storage_get_world(storage);
  bool make_new = false, merged = false;
  if (options != nullptr) {
    make_new = librdf_hash_get_as_boolean(options, "new") > 0;
    merged = librdf_hash_get_as_boolean(options, "merged") > 0;
    librdf_free_hash(options);
  }
  std::unique_ptr<Instance> instance = std::move(t_opening);
  if (!instance) {
    StoreOpener opener = g_opener.load();
    if (opener == nullptr) {
      return Report(world, absl::FailedPreconditionError("this process opens its storages itself"));
    }
    auto store = opener(name == nullptr ? "" : name, make_new);
    if (!store.ok()) return Report(world, store.status());
    instance = std::make_unique<Instance>();
    instance->base = *std::move(store);
    instance->merged = merged;
  }
  librdf_storage_set_instance(storage, instance.release());
  return 0;
}

void Terminate(librdf_storage* storage) {
  std::unique_ptr<Instance> instance(static_cast<Instance*>(librdf_storage_get_instance(storage)));
  if (!instance) return;
  if (instance->transaction && instance->transaction->changes() > 0) {
    librdf_log(librdf_storage_get_world(storage), 0, LIBRDF_LOG_WARN, LIBRDF_FROM_STORAGE, nullptr,
               "docent: %zu changes of a transaction that was not committed are dropped",
               instance->transaction->changes());
  }
  librdf_storage_set_instance(storage, nullptr);
}

int Open(librdf_storage*, librdf_model*) {
  return 0;
}
int Close(librdf_storage*) {
  return 0;
}

// Acknowledged changes are already durable.
int Sync(librdf_storage*) {
  return 0;
}

// --- reading

int Size(librdf_storage* storage) {
  auto size = Of(storage).store().Size();
  if (!size.ok()) {
    Report(storage, size.status());
    return -1;
  }
  return *size > INT_MAX ? -1 : static_cast<int>(*size);
}

int Contains(librdf_storage* storage, librdf_statement* statement) {
  auto quads = Of(storage).store().Find(QueryOf(statement, nullptr));
  if (!quads.ok()) {
    Report(storage, quads.status());
    return 0;
  }
  TermQuad quad;
  return (*quads)->Next(&quad) ? 1 : 0;
}

// All statements, with all contexts, merged or not.
librdf_stream* Serialise(librdf_storage* storage) {
  return Answer(storage, {}, false);
}

librdf_stream* FindStatements(librdf_storage* storage, librdf_statement* statement) {
  return Answer(storage, QueryOf(statement, nullptr), Of(storage).merged);
}

librdf_stream* FindInContext(librdf_storage* storage, librdf_statement* statement, librdf_node* context) {
  return Answer(storage, QueryOf(statement, context), Of(storage).merged);
}

librdf_stream* SerialiseContext(librdf_storage* storage, librdf_node* context) {
  QuadQuery query;
  query.graph = GraphOf(context);
  return Answer(storage, query, false);
}

librdf_iterator* GetContexts(librdf_storage* storage) {
  auto graphs = Of(storage).store().Graphs();
  if (!graphs.ok()) {
    Report(storage, graphs.status());
    return nullptr;
  }
  std::erase(*graphs, Term::Iri(std::string(kDefaultGraph)));
  return NewNodeIterator(librdf_storage_get_world(storage), *graphs);
}

librdf_node* GetFeature(librdf_storage* storage, librdf_uri* feature) {
  const auto* name = reinterpret_cast<const char*>(librdf_uri_as_string(feature));
  if (std::string_view(name) != LIBRDF_MODEL_FEATURE_CONTEXTS) return nullptr;
  return ToNode(librdf_storage_get_world(storage), Term::Literal("1")).release();
}

// --- writing

int Apply(librdf_storage* storage, std::vector<QuadOperation> operations) {
  if (operations.empty()) return 0;
  return Report(storage, Of(storage).store().Apply(std::move(operations)));
}

int AddInContext(librdf_storage* storage, librdf_node* context, librdf_statement* statement) {
  return Apply(storage, {{kAdd, FromStatement(statement, GraphOf(context))}});
}

int Add(librdf_storage* storage, librdf_statement* statement) {
  return AddInContext(storage, nullptr, statement);
}

// The stream's own contexts are ignored, as in librdf's storages.
int AddStreamInContext(librdf_storage* storage, librdf_node* context, librdf_stream* stream) {
  const Term graph = GraphOf(context);
  BufferedStore once(Of(storage).base.get());  // drops repeats
  for (; !librdf_stream_end(stream); librdf_stream_next(stream)) {
    librdf_statement* statement = librdf_stream_get_object(stream);
    if (statement == nullptr) {
      return Report(storage, absl::InvalidArgumentError("the stream ended early; nothing was added"));
    }
    absl::Status kept = once.Apply({{kAdd, FromStatement(statement, graph)}});
    if (!kept.ok()) return Report(storage, kept);
  }
  return Apply(storage, once.Operations());
}

int AddStream(librdf_storage* storage, librdf_stream* stream) {
  return AddStreamInContext(storage, nullptr, stream);
}

// Without a context a statement is removed from docent:default. If it would remain visible through another
// graph, the removal is refused.
int Remove(librdf_storage* storage, librdf_statement* statement) {
  const TermQuad wanted = FromStatement(statement, GraphOf(nullptr));
  auto quads = Of(storage).store().Find({wanted.subject, wanted.predicate, wanted.object, std::nullopt});
  if (!quads.ok()) return Report(storage, quads.status());
  std::optional<Term> elsewhere;
  for (TermQuad quad; (*quads)->Next(&quad);) {
    if (quad.graph == wanted.graph) return Apply(storage, {{kRemove, wanted}});
    elsewhere = quad.graph;
  }
  if (!elsewhere) return 0;
  return Report(storage, absl::FailedPreconditionError(
                             absl::StrCat("the statement is in the context ", ToNTriples(*elsewhere),
                                          ": name the context to remove it there")));
}

int RemoveInContext(librdf_storage* storage, librdf_node* context, librdf_statement* statement) {
  if (context == nullptr) return Remove(storage, statement);
  return Apply(storage, {{kRemove, FromStatement(statement, GraphOf(context))}});
}

int RemoveContext(librdf_storage* storage, librdf_node* context) {
  QuadQuery query;
  query.graph = GraphOf(context);
  auto quads = Of(storage).store().Find(query);
  if (!quads.ok()) return Report(storage, quads.status());
  std::vector<QuadOperation> operations;
  for (TermQuad quad; (*quads)->Next(&quad);) operations.push_back({kRemove, std::move(quad)});
  return Apply(storage, std::move(operations));
}

// --- transactions

int StartTransaction(librdf_storage* storage) {
  Instance& instance = Of(storage);
  if (instance.transaction) {
    return Report(storage, absl::FailedPreconditionError("a transaction is under way already"));
  }
  instance.transaction = std::make_unique<BufferedStore>(instance.base.get());
  return 0;
}

int EndTransaction(librdf_storage* storage, bool commit) {
  Instance& instance = Of(storage);
  if (!instance.transaction) {
    return Report(storage, absl::FailedPreconditionError("no transaction is under way"));
  }
  const std::unique_ptr<BufferedStore> transaction = std::move(instance.transaction);
  return commit ? Report(storage, transaction->Commit()) : 0;
}

int CommitTransaction(librdf_storage* storage) {
  return EndTransaction(storage, true);
}
int RollBackTransaction(librdf_storage* storage) {
  return EndTransaction(storage, false);
}

// librdf derives the functions that are not set from these: sources, arcs and targets from find_statements,
// for example.
void FillFactory(librdf_storage_factory* factory) {
  factory->version = LIBRDF_STORAGE_INTERFACE_VERSION;
  factory->init = Init;
  factory->terminate = Terminate;
  factory->open = Open;
  factory->close = Close;
  factory->sync = Sync;
  factory->size = Size;
  factory->contains_statement = Contains;
  factory->serialise = Serialise;
  factory->find_statements = FindStatements;
  factory->find_statements_in_context = FindInContext;
  factory->context_serialise = SerialiseContext;
  factory->get_contexts = GetContexts;
  factory->get_feature = GetFeature;
  factory->add_statement = Add;
  factory->add_statements = AddStream;
  factory->context_add_statement = AddInContext;
  factory->context_add_statements = AddStreamInContext;
  factory->remove_statement = Remove;
  factory->context_remove_statement = RemoveInContext;
  factory->context_remove_statements = RemoveContext;
  factory->transaction_start = StartTransaction;
  factory->transaction_commit = CommitTransaction;
  factory->transaction_rollback = RollBackTransaction;
}

}  // namespace

void RegisterStorage(librdf_world_s* world, StoreOpener opener) {
  if (opener != nullptr) g_opener = opener;
  const char* name = nullptr;
  for (unsigned i = 0; librdf_storage_enumerate(world, i, &name, nullptr) == 0; ++i) {
    if (std::string_view(name) == kStorageName) return;
  }
  librdf_storage_register_factory(world, kStorageName, "Docent's graph: a data folder or a running server",
                                  FillFactory);
}

librdf_storage_s* OpenStorage(librdf_world_s* world, std::unique_ptr<QuadStore> store, bool merged) {
  t_opening = std::make_unique<Instance>();
  t_opening->base = std::move(store);
  t_opening->merged = merged;
  librdf_storage* storage = librdf_new_storage(world, kStorageName, "", "");
  t_opening.reset();
  return storage;
}

}  // namespace docent::redland
