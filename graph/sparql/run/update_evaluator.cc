#include "graph/sparql/run/update_evaluator.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/functional/function_ref.h"
#include "absl/hash/hash.h"
#include "graph/base/memory_budget.h"
#include "graph/base/overload.h"
#include "graph/rdf/text_bytes.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/update_reads.h"
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
  std::vector<TermQuad>& quads() { return quads_; }

 private:
  struct Hash {
    const std::vector<TermQuad>* quads;
    size_t operator()(uint32_t i) const {
      const TermQuad& quad = (*quads)[i];
      return absl::HashOf(quad.subject, quad.predicate, quad.object, quad.graph);
    }
  };
  struct Equal {
    const std::vector<TermQuad>* quads;
    bool operator()(uint32_t a, uint32_t b) const { return (*quads)[a] == (*quads)[b]; }
  };

  std::vector<TermQuad> quads_;
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
        memory_(options.prepare.memory_bytes, options.prepare.all_memory) {}

  absl::StatusOr<UpdateEffect> Run(const Update& update) {
    for (const UpdateOperation& operation : update.operations) {
      ++number_;
      absl::Status status = One(operation, update);
      if (status.ok()) continue;
      if (operation.span.line == 0) return status;
      return WithMessage(status, "line " + std::to_string(operation.span.line) + ", column " +
                                     std::to_string(operation.span.column) + ": " +
                                     std::string(status.message()));
    }
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
  void Sync() {
    if (applied_ == effect_.operations.size()) return;
    if (!private_graph_) {
      private_dictionary_ = std::make_unique<Dictionary>(&shared_dictionary_);
      // The copy shares the version's nodes and is destroyed before the version.
      private_graph_ = std::make_unique<GraphWriter>(GraphVersionPtr(GraphVersionPtr(), run_.version));
    }
    Dictionary& d = *private_dictionary_;
    for (; applied_ < effect_.operations.size(); ++applied_) {
      const auto& [kind, quad] = effect_.operations[applied_];
      const Quad ids{d.Intern(quad.subject), d.Intern(quad.predicate), d.Intern(quad.object),
                     d.Intern(quad.graph)};
      if (kind == QuadOperation::Kind::kAdd) {
        private_graph_->Add(ids);
      } else {
        private_graph_->Remove(ids);
      }
    }
  }

  void Reads(ReadPattern read) {
    auto& reads = effect_.reads;
    if (std::find(reads.begin(), reads.end(), read) == reads.end()) reads.push_back(std::move(read));
  }

  // --- what operations do

  static size_t BytesOf(const TermQuad& quad) { return sizeof(QuadOperation) + TextBytes(quad); }
  absl::Status TooMuch() const {
    return memory_.Refusal(absl::ResourceExhaustedError(
        "the update changes more quads than fit into its limit query_memory_bytes = " +
        std::to_string(options_.prepare.memory_bytes)));
  }

  absl::Status Emit(QuadOperation::Kind kind, TermQuad quad) {
    if (!memory_.Add(BytesOf(quad))) return TooMuch();
    if (IsServerGraph(quad.graph.lexical)) {
      return absl::InvalidArgumentError(
          "it would write to " + Quoted(quad.graph) +
          ", which only the server writes; exclude it, as by FILTER(?g != " + Quoted(quad.graph) + ")");
    }
    effect_.operations.push_back({kind, std::move(quad)});
    return absl::OkStatus();
  }

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
    for (const QuadTemplate& quad : adds ? operation.insert : operation.remove) {
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
    std::optional<Term> term;
  };
  struct TemplateSlots {
    Slot slots[4];
  };

  static std::vector<TemplateSlots> Resolve(const std::vector<QuadTemplate>& quads,
                                            const UpdateOperation& operation,
                                            const std::vector<std::string>& columns) {
    std::vector<TemplateSlots> out;
    for (const QuadTemplate& quad : quads) {
      TemplateSlots resolved;
      const PatternTerm graph = quad.graph ? *quad.graph : PatternTerm::Of(GraphOf(quad, operation));
      const PatternTerm* terms[] = {&quad.triple.subject, &quad.triple.predicate, &quad.triple.object,
                                    &graph};
      for (int i = 0; i < 4; ++i) {
        if (!terms[i]->IsVariable()) {
          resolved.slots[i].term = terms[i]->term();
          continue;
        }
        const auto it = std::find(columns.begin(), columns.end(), terms[i]->variable().name);
        if (it != columns.end()) resolved.slots[i].column = static_cast<int>(it - columns.begin());
      }
      out.push_back(std::move(resolved));
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
      if (slot.term) {
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
    Sync();
    Query query;
    query.form = Query::Form::kConstruct;
    query.base_iri = update.base_iri;
    query.algebra = operation.where->Clone();
    query.from = operation.from;
    query.from_named = operation.from_named;
    if (query.from.empty() && query.from_named.empty()) query.with = operation.with;
    auto prepared = PreparedQuery::Prepare(query, dictionary(), options_.prepare);
    if (!prepared.ok()) return prepared.status();
    PreparedQuery& where = **prepared;
    const std::vector<TemplateSlots> remove = Resolve(operation.remove, operation, where.variables());
    const std::vector<TemplateSlots> insert = Resolve(operation.insert, operation, where.variables());
    RunOptions run = run_;
    run.version = &version();
    run.seed = run_.seed + number_ * 0x9E3779B97F4A7C15u;
    if (absl::Status status = where.Start(run); !status.ok()) return status;
    // All are removed before any is inserted (section 3.1.3).
    DistinctQuads removed, inserted;
    size_t bytes = 0;
    for (uint64_t solution = 0; where.Next(); ++solution) {
      for (const bool removes : {true, false}) {
        for (const TemplateSlots& slots : removes ? remove : insert) {
          std::optional<TermQuad> quad = Instantiate(slots, where, solution);
          if (!quad) continue;
          const size_t more = BytesOf(*quad);
          if (!(removes ? removed : inserted).Add(*std::move(quad))) continue;
          bytes += more;
          if (!memory_.Add(more)) return TooMuch();
        }
      }
    }
    if (!where.status().ok()) return where.status();
    memory_.Release(bytes);  // each quad is counted again when it is emitted
    for (TermQuad& quad : removed.quads()) {
      absl::Status status = Emit(QuadOperation::Kind::kRemove, std::move(quad));
      if (!status.ok()) return status;
    }
    for (TermQuad& quad : inserted.quads()) {
      absl::Status status = Emit(QuadOperation::Kind::kAdd, std::move(quad));
      if (!status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status Load(const UpdateOperation& operation) {
    const std::string& iri = operation.document.lexical;
    if (!options_.load) return absl::FailedPreconditionError("LOAD is not permitted here");
    absl::StatusOr<std::vector<TermQuad>> quads = options_.load(iri);
    if (!quads.ok()) return quads.status();
    const bool into = operation.target.kind == GraphTarget::Kind::kGraph;
    const Term graph = into ? operation.target.graph : Term::Iri(std::string(kDefaultGraph));
    const size_t before = effect_.operations.size(), used = memory_.used();
    for (TermQuad& quad : *quads) {
      for (Term* term : {&quad.subject, &quad.object}) {
        if (term->IsBlank()) term->lexical = BlankLabel("d" + term->lexical, 0);
      }
      absl::Status status;
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
    Reads({std::nullopt, std::nullopt, std::nullopt, graph});
    Sync();
    const std::optional<TermId> id = dictionary().Find(graph);
    if (!id) return absl::OkStatus();
    absl::Status status;
    version().ForEach({{}, {}, {}, *id}, [&](const Quad& quad) {
      if (run_.cancellation != nullptr) status = run_.cancellation->Check();
      if (status.ok()) {
        status = visit({dictionary().Decode(quad.subject), dictionary().Decode(quad.predicate),
                        dictionary().Decode(quad.object), graph});
      }
      return status.ok();
    });
    return status;
  }

  bool Exists(const Term& graph) {
    Reads({std::nullopt, std::nullopt, std::nullopt, graph});
    Sync();
    const std::optional<TermId> id = dictionary().Find(graph);
    return id && version().Count({{}, {}, {}, *id}) > 0;
  }

  absl::Status Create(const UpdateOperation& operation) {
    if (!Exists(operation.target.graph)) return absl::OkStatus();  // a graph exists once it has a triple
    return absl::FailedPreconditionError("the graph " + Quoted(operation.target.graph) +
                                         " is there already; write CREATE SILENT to pass over that");
  }

  absl::Status RemoveAll(const Term& graph) {
    return ForQuadsOf(graph,
                      [this](TermQuad quad) { return Emit(QuadOperation::Kind::kRemove, std::move(quad)); });
  }

  static absl::Status CheckWritable(const Term& graph) {
    if (!IsServerGraph(graph.lexical)) return absl::OkStatus();
    return absl::InvalidArgumentError(Quoted(graph) + " is a graph that only the server writes");
  }

  // CLEAR and DROP: a graph without triples does not exist. ALL and NAMED skip the graphs that the server keeps: a module of
  // ontology goes by its name.
  absl::Status Clear(const GraphTarget& target) {
    const Term default_graph = Term::Iri(std::string(kDefaultGraph));
    if (target.kind == GraphTarget::Kind::kDefault) return RemoveAll(default_graph);
    if (target.kind == GraphTarget::Kind::kGraph) {
      absl::Status status = CheckWritable(target.graph);
      return status.ok() ? RemoveAll(target.graph) : status;
    }
    Reads({});
    Sync();
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
    if (absl::Status status = CheckWritable(to); !status.ok()) return status;
    const bool moves = operation.kind == Kind::kMove;
    if (absl::Status status = moves ? CheckWritable(from) : absl::OkStatus(); !status.ok()) return status;
    if (operation.source.kind == GraphTarget::Kind::kGraph && !Exists(from)) {
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
  MemoryUse memory_;    // of the quads to be changed
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
