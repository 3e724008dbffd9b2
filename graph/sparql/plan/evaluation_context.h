// Shared state of the operators of one evaluation: the version, the computed terms, the limits, the first
// error. One thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_EVALUATION_CONTEXT_H_
#define DOCENT_GRAPH_SPARQL_PLAN_EVALUATION_CONTEXT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/hash/hash.h"
#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/memory_part.h"
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
  // `request` counts plan and runs, with what else the request keeps; null: a count of its own, bounded by the other two.
  EvaluationContext(const Dictionary& dictionary, const FunctionRegistry* functions, size_t memory_limit,
                    MemoryBudget* all_memory = nullptr, MemoryUse* request = nullptr)
      : dictionary(dictionary),
        functions(functions),
        memory_limit_(memory_limit),
        own_(memory_limit, all_memory),
        use_(request != nullptr ? request : &own_),
        plan_(use_),
        memory_(use_) {}

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
  // Spends the steps since the last check, which a short run does not reach. At the end of each run, while the cancellation
  // is there.
  void Settle() {
    if (cancellation != nullptr && status.ok()) cancellation->Spend(TakeSteps());
  }
  // Counts bytes of text that are read, copied or compared. False as Poll, which counts rows and not their
  // cost; a function on long texts calls this before it begins.
  bool Worked(size_t bytes) { return (work_bytes_ += bytes) < kBytesAPoll || WorkedNow(); }
  bool WorkedSteps(uint64_t steps) { return Worked(steps * kBytesAStep); }
  // Counts matches that were counted without a Poll: the next check comes sooner.
  void Counted(uint64_t matches) {
    const uint64_t polls = matches / kMatchesAPoll;
    polls_left_ = polls < static_cast<uint64_t>(polls_left_) ? polls_left_ - static_cast<int>(polls) : 1;
  }

  // Counts memory that the evaluation keeps; false, with `status` set, beyond the limit.
  bool Charge(size_t bytes) { return memory_.Add(bytes) || Refuse(0); }

  // True if `bytes` more could be charged; if not, sets `status` as Charge does.
  bool HasRoom(size_t bytes) { return use_->HasRoom(bytes) || Refuse(bytes); }
  // Gives back memory that was charged.
  void Release(size_t bytes) { memory_.Release(bytes); }
  // Memory for a while, counted as the request's.
  MemoryPart PartOfMemory() { return MemoryPart(use_); }
  // For caches: true if `bytes` more leave enough memory free.
  bool MayKeep(size_t bytes) const { return use_->MayKeep(bytes); }
  // Counts memory of the plan, which stays from run to run until ForgetPlan; a small plan costs nothing. False as Charge.
  bool ChargePlan(size_t bytes) {
    planned_ += bytes;
    const size_t counted = planned_ > kSmallPlan ? planned_ - kSmallPlan : 0;
    return plan_.used() >= counted || plan_.Add(counted - plan_.used()) || Refuse(0);
  }
  void ReleasePlan(size_t bytes) {
    planned_ -= bytes;
    const size_t counted = planned_ > kSmallPlan ? planned_ - kSmallPlan : 0;
    if (plan_.used() > counted) plan_.Release(plan_.used() - counted);
  }
  void ForgetPlan() {
    planned_ = 0;
    plan_.Reset();
  }

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
  // The lexical form, IRI or label of a value; for a value from data, its original text. `scratch` holds it where nothing
  // else does. Valid until the next Encode.
  std::string_view LexicalOf(const Value& value, std::string* scratch) const;
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
  static constexpr size_t kBytesAStep = 4;  // a step of Cancellation takes about as long as reading them
  static constexpr size_t kLongText = 4096;
  static constexpr size_t kSmallPlan = 64u << 10;
  static constexpr size_t kFewTerms = 64;  // capacity kept for the next run

  // By number in local_terms_.
  struct LocalHash {
    using is_transparent = void;
    const std::vector<Term>* terms;
    size_t operator()(uint32_t number) const { return absl::HashOf((*terms)[number]); }
    size_t operator()(const Term& term) const { return absl::HashOf(term); }
  };
  struct LocalEqual {
    using is_transparent = void;
    const std::vector<Term>* terms;
    const Term& Of(uint32_t number) const { return (*terms)[number]; }
    const Term& Of(const Term& term) const { return term; }
    template <typename A, typename B>
    bool operator()(const A& a, const B& b) const {
      return Of(a) == Of(b);
    }
  };

  TermId EncodeComputed(const Value& value);
  // For terms that do not fit into an id: a known one, and a new one.
  std::optional<TermId> FindTerm(const Term& term);
  TermId AddLocal(Term term);
  void DecodeLocalTo(TermId id, Term* out) const;
  bool WorkedNow();
  bool Refuse(size_t more);
  // The steps since the last check.
  uint64_t TakeSteps() {
    const uint64_t steps = static_cast<uint64_t>(polls_given_ - polls_left_) + work_bytes_ / kBytesAStep;
    polls_given_ = polls_left_;
    work_bytes_ = 0;
    return steps;
  }

  int polls_left_ = 1;     // until status, caller and clock are checked
  int polls_given_ = 1;    // value at the last check
  size_t work_bytes_ = 0;  // since the last check
  const size_t memory_limit_;
  MemoryUse own_;
  MemoryUse* const use_;
  MemoryPart plan_, memory_;  // memory_: of the run
  size_t planned_ = 0;        // bytes of the plan
  uint64_t run_ = 0;
  uint64_t random_ = 0;
  std::vector<Term> local_terms_;
  absl::flat_hash_set<uint32_t, LocalHash, LocalEqual> local_ids_{0, LocalHash{&local_terms_},
                                                                  LocalEqual{&local_terms_}};
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
