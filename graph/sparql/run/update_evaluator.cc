#include "graph/sparql/run/update_evaluator.h"

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "absl/hash/hash.h"
#include "graph/base/memory_part.h"
#include "graph/base/overload.h"
#include "graph/rdf/text_bytes.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/update_reads.h"
#include "graph/sparql/syntax/algebra_memory.h"
#include "graph/store/graph_writer.h"
#include "graph/store/server_graphs.h"

namespace docent::sparql {
namespace {

using Kind = UpdateOperation::Kind;

std::string Quoted(const Term& graph) {
  return ToDisplay(graph);
}

// Distinct quads in insertion order.
class DistinctQuads {
 public:
  // False if the quad is already there.
  bool Add(TermQuad quad) {
    quads_.push_back(std::move(quad));
    const bool added = numbers_.insert(static_cast<uint32_t>(quads_.size() - 1)).second;
    if (!added) quads_.pop_back();
    return added;
  }
  size_t size() const { return quads_.size(); }
  // Moves them out, the first one first; nothing may be added any more.
  TermQuad Take() {
    TermQuad quad = std::move(quads_.front());
    quads_.pop_front();
    return quad;
  }
  static constexpr size_t kBytes = 120;  // for each quad beside itself

 private:
  struct Hash {
    const std::deque<TermQuad>* quads;
    size_t operator()(uint32_t i) const {
      const TermQuad& quad = (*quads)[i];
      return absl::HashOf(quad.subject, quad.predicate, quad.object, quad.graph);
    }
  };
  struct Equal {
    const std::deque<TermQuad>* quads;
    bool operator()(uint32_t a, uint32_t b) const { return (*quads)[a] == (*quads)[b]; }
  };

  std::deque<TermQuad> quads_;  // grows without a copy
  absl::flat_hash_set<uint32_t, Hash, Equal> numbers_{0, Hash{&quads_}, Equal{&quads_}};
};

// Evaluation of one request. Operations that read see a private copy of the version with the earlier
// operations applied.
class Evaluation {
 public:
  Evaluation(const Dictionary& dictionary, const RunOptions& run, const UpdateOptions& options)
      : shared_dictionary_(dictionary),
        run_(run),
        options_(options),
        own_(options.prepare.memory_bytes, options.prepare.all_memory),
        use_(options.prepare.memory != nullptr ? options.prepare.memory : &own_),
        memory_(use_),
        state_memory_(use_),
        prepare_(options.prepare) {
    prepare_.memory = use_;
    prepare_.cancellation = run.cancellation;
  }

  absl::StatusOr<UpdateEffect> Run(const Update& update) {
    for (const UpdateOperation& operation : update.operations) {
      ++number_;
      absl::Status status = run_.cancellation != nullptr ? run_.cancellation->CheckNow() : absl::OkStatus();
      if (status.ok()) status = One(operation, update);
      if (status.ok()) continue;
      if (operation.span.line == 0) return status;
      return WithMessage(status, "line " + std::to_string(operation.span.line) + ", column " +
                                     std::to_string(operation.span.column) + ": " +
                                     std::string(status.message()));
    }
    effect_.bytes = memory_.Detach();
    if (use_ == &own_) effect_.bytes = 0;
    return std::move(effect_);
  }

 private:
  absl::Status One(const UpdateOperation& operation, const Update& update) {
    switch (operation.kind) {
      case Kind::kInsertData:
      case Kind::kDeleteData:
        return Data(operation);
      case Kind::kModify:
        return Modify(operation, update);
      case Kind::kLoad:
        return Silenced(operation, Load(operation));
      case Kind::kCreate:
        return Silenced(operation, Create(operation));
      case Kind::kClear:
      case Kind::kDrop:
        return Silenced(operation, Clear(operation.target));
      default:
        return Silenced(operation, Transfer(operation));
    }
  }

  // SILENT hides errors of the operation's graphs and documents, but not limits.
  static absl::Status Silenced(const UpdateOperation& operation, absl::Status status) {
    const bool limit = status.code() == absl::StatusCode::kResourceExhausted ||
                       status.code() == absl::StatusCode::kCancelled ||
                       status.code() == absl::StatusCode::kDeadlineExceeded;
    if (operation.silent && !limit) return absl::OkStatus();
    return status;
  }

  // --- the state that operations read

  const Dictionary& dictionary() const {
    return private_dictionary_ ? *private_dictionary_ : shared_dictionary_;
  }
  const GraphVersion& version() const { return private_graph_ ? private_graph_->current() : *run_.version; }

  // Applies the operations so far to the private copy.
  absl::Status Sync() {
    if (applied_ == effect_.operations.size()) return absl::OkStatus();
    if (!private_graph_) {
      private_dictionary_ = std::make_unique<Dictionary>(&shared_dictionary_);
      // The copy shares the version's nodes and is destroyed before the version.
      private_graph_ = std::make_unique<GraphWriter>(GraphVersionPtr(GraphVersionPtr(), run_.version));
    }
    Dictionary& d = *private_dictionary_;
    for (; applied_ < effect_.operations.size(); ++applied_) {
      const auto& [kind, quad] = effect_.operations[applied_];
      if (!state_memory_.Add(kBytesOfApplied + TextBytes(quad))) return TooMuch();
      if (absl::Status status = Poll(); !status.ok()) return status;
      const Quad ids{d.Intern(quad.subject), d.Intern(quad.predicate), d.Intern(quad.object),
                     d.Intern(quad.graph)};
      if (kind == QuadOperation::Kind::kAdd) {
        private_graph_->Add(ids);
      } else {
        private_graph_->Remove(ids);
      }
    }
    return absl::OkStatus();
  }

  absl::Status Poll() { return run_.cancellation != nullptr ? run_.cancellation->Check() : absl::OkStatus(); }

  // --- what operations do

  static size_t BytesOf(const TermQuad& quad) { return sizeof(QuadOperation) + TextBytes(quad); }
  absl::Status TooMuch() const {
    return use_->Refusal(absl::ResourceExhaustedError(
        "the update changes more quads than fit into its limit query_memory_bytes = " +
        std::to_string(options_.prepare.memory_bytes)));
  }

  // Before many operations: an array that grows by itself is there twice meanwhile.
  void Reserve(size_t more) {
    const size_t needed = effect_.operations.size() + more, held = effect_.operations.capacity();
    if (needed > held) effect_.operations.reserve(std::max(needed, held + held / 2));
  }

  absl::Status Emit(QuadOperation::Kind kind, TermQuad quad) {
    if (!memory_.Add(BytesOf(quad))) return TooMuch();
    const bool adds = kind == QuadOperation::Kind::kAdd;
    if (adds ? IsToldByServer(quad.graph.lexical) : IsServerGraph(quad.graph.lexical)) {
      return absl::InvalidArgumentError(
          "it would write to " + Quoted(quad.graph) +
          ", which only the server writes; name another graph, or exclude it, as by FILTER(?g != " +
          Quoted(quad.graph) + ")");
    }
    effect_.operations.push_back({kind, std::move(quad)});
    return absl::OkStatus();
  }

  static constexpr size_t kBytesOfApplied =
      512;  // of a quad in the private copy, beside its texts: six index entries

  static Term GraphOf(const QuadTemplate& quad, const UpdateOperation& operation) {
    if (quad.graph) return quad.graph->term();
    return operation.with ? *operation.with : Term::Iri(std::string(kDefaultGraph));
  }

  std::string BlankLabel(std::string_view label, uint64_t solution) const {
    // ".0" is a label of the parser, for []; others are the user's.
    const bool own = label[0] == '.';
    return "u" + std::to_string(run_.seed) + "o" + std::to_string(number_) + "s" + std::to_string(solution) +
           (own ? "a" : "n") + std::string(own ? label.substr(1) : label);
  }

  absl::Status Data(const UpdateOperation& operation) {
    const bool adds = operation.kind == Kind::kInsertData;
    const QuadTemplates& quads = adds ? operation.insert : operation.remove;
    Reserve(quads.size());
    for (const QuadTemplate& quad : quads) {
      if (absl::Status status = Poll(); !status.ok()) return status;
      TermQuad out{quad.triple.subject.term(), quad.triple.predicate.term(), quad.triple.object.term(),
                   GraphOf(quad, operation)};
      if (out.subject.IsLiteral()) {
        return absl::InvalidArgumentError(ToNTriples(out.subject) + " is a literal and cannot be a subject");
      }
      if (out.subject.IsBlank()) out.subject.lexical = BlankLabel(out.subject.lexical, 0);
      if (out.object.IsBlank()) out.object.lexical = BlankLabel(out.object.lexical, 0);
      absl::Status status =
          Emit(adds ? QuadOperation::Kind::kAdd : QuadOperation::Kind::kRemove, std::move(out));
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // A position of a template, resolved against the columns of a solution.
  struct Slot {
    int column = -1;  // -1: the term, or a variable that WHERE never binds
    const Term* term = nullptr;
  };
  struct TemplateSlots {
    Slot slots[4];
  };

  // The result points into `quads` and the graphs around them.
  static std::vector<TemplateSlots> Resolve(const QuadTemplates& quads, const PatternTerm& default_graph,
                                            const std::vector<std::string>& columns) {
    absl::flat_hash_map<std::string_view, int> column_of;
    for (const std::string& name : columns) column_of.emplace(name, static_cast<int>(column_of.size()));
    std::vector<TemplateSlots> out(quads.size());
    auto resolved = out.begin();
    for (const QuadTemplate& quad : quads) {
      const PatternTerm* terms[] = {&quad.triple.subject, &quad.triple.predicate, &quad.triple.object,
                                    quad.graph ? quad.graph.get() : &default_graph};
      for (int i = 0; i < 4; ++i) {
        Slot& slot = resolved->slots[i];
        if (!terms[i]->IsVariable()) {
          slot.term = &terms[i]->term();
        } else if (const auto it = column_of.find(terms[i]->variable().name); it != column_of.end()) {
          slot.column = it->second;
        }
      }
      ++resolved;
    }
    return out;
  }

  // The quad of one solution; nullopt if it would not be RDF (section 3.1.3.1).
  std::optional<TermQuad> Instantiate(const TemplateSlots& quad, const PreparedQuery& query,
                                      uint64_t solution) {
    TermQuad out;
    Term* terms[] = {&out.subject, &out.predicate, &out.object, &out.graph};
    for (int i = 0; i < 4; ++i) {
      const Slot& slot = quad.slots[i];
      if (slot.term != nullptr) {
        *terms[i] = *slot.term;
        if (slot.term->IsBlank()) terms[i]->lexical = BlankLabel(slot.term->lexical, solution);
      } else {
        if (slot.column < 0) return std::nullopt;
        const TermId id = query.row()[static_cast<size_t>(slot.column)];
        if (id.IsNone()) return std::nullopt;
        *terms[i] = query.Decode(id);
      }
    }
    if (out.subject.IsLiteral() || !out.predicate.IsIri() || !out.graph.IsIri()) return std::nullopt;
    return out;
  }

  absl::Status Modify(const UpdateOperation& operation, const Update& update) {
    AddReads(*operation.where, &effect_.reads);
    if (absl::Status status = Sync(); !status.ok()) return status;
    MemoryPart copies(use_);
    const size_t templates = operation.remove.size() + operation.insert.size();
    if (!copies.Add(MemoryBytes(*operation.where) + templates * sizeof(TemplateSlots))) return TooMuch();
    Query query;
    query.form = Query::Form::kConstruct;
    query.base_iri = update.base_iri;
    query.algebra = operation.where->Clone();
    query.from = operation.from;
    query.from_named = operation.from_named;
    if (query.from.empty() && query.from_named.empty()) query.with = operation.with;
    auto prepared = PreparedQuery::Prepare(std::move(query), dictionary(), prepare_);
    if (!prepared.ok()) return prepared.status();
    PreparedQuery& where = **prepared;
    const PatternTerm default_graph =
        PatternTerm::Of(operation.with ? *operation.with : Term::Iri(std::string(kDefaultGraph)));
    const std::vector<TemplateSlots> remove = Resolve(operation.remove, default_graph, where.variables());
    const std::vector<TemplateSlots> insert = Resolve(operation.insert, default_graph, where.variables());
    RunOptions run = run_;
    run.version = &version();
    run.seed = run_.seed + number_ * 0x9E3779B97F4A7C15u;
    if (absl::Status status = where.Start(run); !status.ok()) return status;
    // All are removed before any is inserted (section 3.1.3).
    DistinctQuads removed, inserted;
    MemoryPart bytes(use_);
    for (uint64_t solution = 0; where.Next(); ++solution) {
      for (const bool removes : {true, false}) {
        for (const TemplateSlots& slots : removes ? remove : insert) {
          if (absl::Status status = Poll(); !status.ok()) return status;
          std::optional<TermQuad> quad = Instantiate(slots, where, solution);
          if (!quad) continue;
          const size_t more = BytesOf(*quad);
          if (!(removes ? removed : inserted).Add(*std::move(quad))) continue;
          if (!bytes.Add(more + DistinctQuads::kBytes)) return TooMuch();
        }
      }
    }
    if (!where.status().ok()) return where.status();
    bytes.Reset();  // each quad is counted again when it is emitted
    Reserve(removed.size() + inserted.size());
    while (removed.size() > 0) {
      if (absl::Status status = Emit(QuadOperation::Kind::kRemove, removed.Take()); !status.ok())
        return status;
    }
    while (inserted.size() > 0) {
      if (absl::Status status = Emit(QuadOperation::Kind::kAdd, inserted.Take()); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status Load(const UpdateOperation& operation) {
    const std::string& iri = operation.document.lexical;
    if (!options_.load) return absl::FailedPreconditionError("LOAD is not permitted here");
    absl::StatusOr<DocumentQuads> quads = options_.load(iri);
    if (!quads.ok()) return quads.status();
    const bool into = operation.target.kind == GraphTarget::Kind::kGraph;
    const Term graph = into ? operation.target.graph : Term::Iri(std::string(kDefaultGraph));
    const size_t before = effect_.operations.size(), used = memory_.used();
    Reserve((*quads)->size());
    for (TermQuad quad : **quads) {
      for (Term* term : {&quad.subject, &quad.object}) {
        if (term->IsBlank()) term->lexical = BlankLabel("d" + term->lexical, 0);
      }
      absl::Status status = Poll();
      if (quad.graph.lexical.empty()) {
        quad.graph = graph;
      } else if (into || !quad.graph.IsIri()) {
        status = absl::InvalidArgumentError("<" + iri + "> holds named graphs, which INTO GRAPH cannot take");
      }
      if (status.ok()) status = Emit(QuadOperation::Kind::kAdd, std::move(quad));
      if (!status.ok()) {
        memory_.Release(memory_.used() - used);
        effect_.operations.resize(before);
        return status;
      }
    }
    return absl::OkStatus();
  }

  // Calls `visit` for the quads of a graph in the current state, until it fails.
  absl::Status ForQuadsOf(const Term& graph, absl::FunctionRef<absl::Status(TermQuad quad)> visit) {
    AddRead({std::nullopt, std::nullopt, std::nullopt, graph}, &effect_.reads);
    absl::Status status = Sync();
    if (!status.ok()) return status;
    const std::optional<TermId> id = dictionary().Find(graph);
    if (!id) return absl::OkStatus();
    version().ForEach({{}, {}, {}, *id}, [&](const Quad& quad) {
      status = Poll();
      if (status.ok()) {
        status = visit({dictionary().Decode(quad.subject), dictionary().Decode(quad.predicate),
                        dictionary().Decode(quad.object), graph});
      }
      return status.ok();
    });
    return status;
  }

  absl::StatusOr<bool> Exists(const Term& graph) {
    AddRead({std::nullopt, std::nullopt, std::nullopt, graph}, &effect_.reads);
    if (absl::Status status = Sync(); !status.ok()) return status;
    const std::optional<TermId> id = dictionary().Find(graph);
    return id && version().Count({{}, {}, {}, *id}) > 0;
  }

  absl::Status Create(const UpdateOperation& operation) {
    const absl::StatusOr<bool> exists = Exists(operation.target.graph);
    if (!exists.ok()) return exists.status();
    if (!*exists) return absl::OkStatus();  // a graph exists once it has a triple
    return absl::FailedPreconditionError("the graph " + Quoted(operation.target.graph) +
                                         " is there already; write CREATE SILENT to pass over that");
  }

  absl::Status RemoveAll(const Term& graph) {
    return ForQuadsOf(graph,
                      [this](TermQuad quad) { return Emit(QuadOperation::Kind::kRemove, std::move(quad)); });
  }

  static absl::Status Check(const std::string& refusal) {
    return refusal.empty() ? absl::OkStatus() : absl::InvalidArgumentError(refusal);
  }

  // CLEAR and DROP: a graph without triples does not exist. ALL and NAMED skip the graphs that the server keeps: a module of
  // ontology goes by its name.
  absl::Status Clear(const GraphTarget& target) {
    const Term default_graph = Term::Iri(std::string(kDefaultGraph));
    if (target.kind == GraphTarget::Kind::kDefault) return RemoveAll(default_graph);
    if (target.kind == GraphTarget::Kind::kGraph) {
      absl::Status status = Check(RefuseRemoval(target.graph));
      return status.ok() ? RemoveAll(target.graph) : status;
    }
    AddRead({}, &effect_.reads);
    if (absl::Status status = Sync(); !status.ok()) return status;
    std::vector<Term> graphs;
    for (const TermId id : version().graphs()) graphs.push_back(dictionary().Decode(id));
    for (const Term& graph : graphs) {
      if (IsServerGraph(graph.lexical) || IsModuleGraph(graph.lexical)) continue;
      if (target.kind == GraphTarget::Kind::kNamed && graph == default_graph) continue;
      if (absl::Status status = RemoveAll(graph); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // COPY, MOVE, ADD.
  absl::Status Transfer(const UpdateOperation& operation) {
    const auto name = [](const GraphTarget& t) {
      return t.kind == GraphTarget::Kind::kDefault ? Term::Iri(std::string(kDefaultGraph)) : t.graph;
    };
    const Term from = name(operation.source), to = name(operation.target);
    if (absl::Status status = Check(RefuseGraph(to)); !status.ok()) return status;
    const bool moves = operation.kind == Kind::kMove;
    if (absl::Status status = moves ? Check(RefuseRemoval(from)) : absl::OkStatus(); !status.ok())
      return status;
    if (operation.source.kind == GraphTarget::Kind::kGraph) {
      const absl::StatusOr<bool> exists = Exists(from);
      if (!exists.ok()) return exists.status();
      if (!*exists)
        return absl::FailedPreconditionError("there is no graph " + Quoted(from) + "; nothing was changed");
    }
    if (from == to) return absl::OkStatus();
    if (operation.kind != Kind::kAdd) {
      if (absl::Status status = RemoveAll(to); !status.ok()) return status;
    }
    return ForQuadsOf(from, [&](TermQuad quad) {
      TermQuad copy = quad;
      copy.graph = to;
      absl::Status status = Emit(QuadOperation::Kind::kAdd, std::move(copy));
      if (status.ok() && moves) status = Emit(QuadOperation::Kind::kRemove, std::move(quad));
      return status;
    });
  }

  const Dictionary& shared_dictionary_;
  const RunOptions& run_;
  const UpdateOptions& options_;
  uint64_t number_ = 0;  // of the operation
  UpdateEffect effect_;
  MemoryUse own_;  // where the request has none
  MemoryUse* const use_;
  MemoryPart memory_;        // of the quads to be changed
  MemoryPart state_memory_;  // of the private copy
  PrepareOptions prepare_;
  size_t applied_ = 0;  // operations that the private copy has
  std::unique_ptr<Dictionary> private_dictionary_;
  std::unique_ptr<GraphWriter> private_graph_;
};

}  // namespace

absl::StatusOr<UpdateEffect> EvaluateUpdate(const Update& update, const Dictionary& dictionary,
                                            const RunOptions& run, const UpdateOptions& options) {
  if (run.version == nullptr) return absl::InvalidArgumentError("a run needs a graph version");
  return Evaluation(dictionary, run, options).Run(update);
}

}  // namespace docent::sparql
