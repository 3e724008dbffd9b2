// Shared state of the operators of one evaluation: the version, the computed terms, the limits, the first
// error. One thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_EVALUATION_CONTEXT_H_
#define DOCENT_GRAPH_SPARQL_PLAN_EVALUATION_CONTEXT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/memory_budget.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/sparql/values/value.h"
#include "graph/store/graph_version.h"

namespace docent::sparql {

// Placeholder for a constant that is not in the dictionary: it matches nothing, and is not a wildcard.
inline constexpr TermId kUnknownTerm = TermId::Make(TermId::Tag::kLocal, (uint64_t{1} << 60) - 1);

// The dataset of a query, as graph ids (section 13).
struct DatasetIds {
  bool is_explicit = false;            // the query has FROM or FROM NAMED
  std::vector<TermId> default_graphs;  // explicit: the merged graphs
  std::vector<TermId> named_graphs;    // explicit: the graphs of GRAPH ?g
  bool strict = false;                 // not explicit: the default graph is `default_graph` alone
  TermId default_graph;                // docent:default or that of WITH; kUnknownTerm: there is no such graph
  TermId unnamed_graph;                // `strict` and not explicit: the graph that GRAPH ?g leaves out
};

class EvaluationContext {
 public:
  EvaluationContext(const Dictionary& dictionary, const FunctionRegistry* functions, size_t memory_limit,
                    MemoryBudget* all_memory = nullptr)
      : dictionary(dictionary),
        functions(functions),
        memory_limit_(memory_limit),
        memory_(memory_limit, all_memory) {}

  // Begins a run: clears the computed terms and the error of the run before.
  void Begin(const GraphVersion* new_version, Cancellation* new_cancellation, TimeMicros new_now_us,
             uint64_t new_seed) {
    version = new_version;
    cancellation = new_cancellation;
    now_us = new_now_us;
    seed = new_seed;
    random_ = new_seed;
    row_number = 0;
    polls_left_ = polls_given_ = 1;
    work_bytes_ = 0;
    if (!status.ok()) status = absl::OkStatus();
    Forget();
  }
  // Drops computed terms and charged memory. The operators must drop their memory at the same time.
  void Forget() {
    memory_.Reset();
    ++run_;
    if (local_terms_.empty()) return;
    local_ids_.clear();
    if (local_terms_.capacity() <= kFewTerms) return local_terms_.clear();
    std::vector<Term>().swap(local_terms_);
  }

  // False soon after the evaluation has to end; `status` gives the reason. For inner loops.
  bool Poll() { return --polls_left_ > 0 || PollNow(); }
  bool PollNow();
  // Counts bytes of text that are read, copied or compared. False as Poll, which counts rows and not their
  // cost; a function on long texts calls this before it begins.
  bool Worked(size_t bytes) { return (work_bytes_ += bytes) < kBytesAPoll || WorkedNow(); }
  // Counts matches that were counted without a Poll: the next check comes sooner.
  void Counted(uint64_t matches) {
    const uint64_t polls = matches / kMatchesAPoll;
    polls_left_ = polls < static_cast<uint64_t>(polls_left_) ? polls_left_ - static_cast<int>(polls) : 1;
  }

  // Counts memory that the evaluation keeps; false, with `status` set, beyond the limit.
  bool Charge(size_t bytes) { return memory_.Add(bytes) || Refuse(0); }

  // True if `bytes` more could be charged; if not, sets `status` as Charge does.
  bool HasRoom(size_t bytes) { return memory_.HasRoom(bytes) || Refuse(bytes); }
  // Gives back memory that was charged.
  void Release(size_t bytes) { memory_.Release(bytes); }
  // For caches: true if `bytes` more leave enough memory free.
  bool MayKeep(size_t bytes) const { return memory_.MayKeep(bytes); }

  // The id of a term: the dictionary's, inline, or a local one of this run.
  TermId Encode(const Term& term);
  TermId Encode(const Value& value) { return value.id().IsNone() ? EncodeComputed(value) : value.id(); }
  void DecodeTo(TermId id, Term* out) const {
    return id.tag() == TermId::Tag::kLocal ? DecodeLocalTo(id, out) : dictionary.DecodeTo(id, out);
  }
  Term Decode(TermId id) const {
    Term term;
    DecodeTo(id, &term);
    return term;
  }
  Value ValueOf(TermId id) const;
  // The lexical form, IRI or label of a value; for a value from data, its original text.
  std::string LexicalOf(const Value& value) const;
  // The next pseudo-random number from the seed (splitmix64, Steele et al. 2014).
  uint64_t Random();

  const Dictionary& dictionary;
  const FunctionRegistry* functions;
  const GraphVersion* version = nullptr;
  Cancellation* cancellation = nullptr;
  TimeMicros now_us = 0;
  uint64_t seed = 0;
  absl::Status status;
  DatasetIds dataset;
  std::string base_iri;
  std::vector<TermId> constants;  // by number; kUnknownTerm where the dictionary has none
  uint64_t row_number = 0;        // number of the current solution; BNODE("x") is one node within a solution

 private:
  friend class KeptMemory;
  static constexpr int kPolls = 64;  // only the last of this many polls does the check
  static constexpr uint64_t kMatchesAPoll = 64;
  static constexpr size_t kBytesAPoll = 1 << 20;
  static constexpr size_t kFewTerms = 64;  // capacity kept for the next run

  TermId EncodeComputed(const Value& value);
  // For terms that do not fit into an id: a known one, and a new one.
  std::optional<TermId> FindTerm(const Term& term);
  TermId AddLocal(Term term);
  void DecodeLocalTo(TermId id, Term* out) const;
  bool WorkedNow();
  bool Refuse(size_t more);

  int polls_left_ = 1;     // until status, caller and clock are checked
  int polls_given_ = 1;    // value at the last check
  size_t work_bytes_ = 0;  // since the last check
  const size_t memory_limit_;
  MemoryUse memory_;
  uint64_t run_ = 0;
  uint64_t random_ = 0;
  std::vector<Term> local_terms_;
  absl::flat_hash_map<Term, TermId> local_ids_;
};

// Memory of one operator, charged to the context. An operator that restarts within a run releases it first.
class KeptMemory {
 public:
  // As EvaluationContext::Charge.
  bool Add(size_t bytes, EvaluationContext& context) {
    if (run_ != context.run_) bytes_ = 0;  // a new run starts at zero
    run_ = context.run_;
    bytes_ += bytes;
    return context.Charge(bytes);
  }
  void LetGo(EvaluationContext& context) {
    if (run_ == context.run_) context.Release(bytes_);
    bytes_ = 0;
  }
  // Releases a part of it.
  void LetGo(size_t bytes, EvaluationContext& context) {
    bytes_ -= bytes;
    context.Release(bytes);
  }

 private:
  uint64_t run_ = 0;
  size_t bytes_ = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_EVALUATION_CONTEXT_H_
