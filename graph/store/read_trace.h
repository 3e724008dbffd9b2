// Record of what a read looked at in the graph. With it one can tell which later changes may change the answer.
//
// While a Scope is open, what its thread reads of graph versions, those that it makes itself included, is noted:
// GraphVersion and GraphWriter do that. A trace claims too much rather than too little. One thread at a time.
#ifndef DOCENT_GRAPH_STORE_READ_TRACE_H_
#define DOCENT_GRAPH_STORE_READ_TRACE_H_

#include <cstddef>
#include <cstdint>

#include "absl/container/flat_hash_set.h"
#include "graph/store/quad.h"

namespace docent {

class ReadTrace {
 public:
  // `terms`: size of the dictionary before the read. What the read did not find in it may be a later term.
  explicit ReadTrace(uint64_t terms) : terms_(terms) {}
  ReadTrace(const ReadTrace&) = delete;
  ReadTrace& operator=(const ReadTrace&) = delete;

  // Null: nothing is noted.
  class Scope {
   public:
    explicit Scope(ReadTrace* trace);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    ReadTrace* const before_;
  };

  // What a read of this thread looks at; without a scope they do nothing. Quads of a pattern, whether there are any or not.
  static void Note(const QuadPattern& pattern) {
    if (current_ != nullptr) current_->Add(pattern);
  }
  // Which graphs or predicates there are.
  static void NoteNames() {
    if (current_ != nullptr) current_->names_ = true;
  }
  // What no change of the graph tells of, such as the time; or more than can be noted.
  static void NoteAnything() {
    if (current_ != nullptr) current_->AddAnything();
  }

  // The answer rests on nothing but what is noted. Before, any change may touch it.
  void SetWhole() { whole_ = true; }
  bool whole() const { return whole_ && !anything_; }

  // Whether the answer may be another one after a change: of a quad, of which graphs or predicates there are.
  bool MayTouch(const Quad& changed) const;
  bool MayTouchNames() const { return names_ || !whole(); }

 private:
  // Of patterns. Beyond, those that bind a predicate stand for all quads of that predicate.
  static constexpr size_t kMostPatterns = 256;

  void Add(const QuadPattern& pattern);
  void AddAnything();
  void Widen();

  static thread_local constinit ReadTrace* current_;

  const uint64_t terms_;
  bool whole_ = false, anything_ = false, names_ = false;
  unsigned bound_ = 0;                      // bit b: there are patterns that bind the positions b
  absl::flat_hash_set<Quad> patterns_;      // none ids are wildcards
  absl::flat_hash_set<TermId> predicates_;  // of which all quads are noted
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_READ_TRACE_H_
