// Backtracking matcher of programs (regex_program.h). Without back-references it remembers the splits tried
// at each place, so its time is linear in text times program. With them it may take exponential time, up to a
// limit of steps. Private to this folder. One thread.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_MATCHER_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_MATCHER_H_

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/regex_limits.h"
#include "graph/sparql/regex/match_guard.h"
#include "graph/sparql/regex/regex_program.h"

namespace docent::sparql {

class RegexMatcher {
 public:
  // The program must outlive it.
  explicit RegexMatcher(const RegexProgram& program, const RegexLimits& limits = {})
      : program_(program), limits_(limits) {}

  // Begins a sequence of searches in `text`, at increasing places. Text and guard must stay valid until End.
  void Begin(std::string_view text, MatchGuard* guard);
  // The leftmost match at or after `at`, a character boundary. False: no match, or the search was ended; see
  // status().
  bool Find(size_t at);
  // Releases the memory of the searches.
  void End();

  // RESOURCE_EXHAUSTED, naming the limit; CANCELLED if the guard ended the search.
  const absl::Status& status() const { return status_; }
  // The text of group n of the last match, 0 for the whole match. nullopt: the group did not match.
  std::optional<std::string_view> Group(int number) const;

 private:
  static constexpr size_t kNowhere = static_cast<size_t>(-1);

  // A saved alternative: continue at instruction `what` in place `value`. If negative: restore register -1 -
  // what to `value`.
  struct Frame {
    int what;
    size_t value;
  };

  bool MatchAt(size_t at);
  // True if the split has not been tried at this place.
  bool IsFresh(int split, size_t at);
  bool Push(int what, size_t value);
  // Sets a register; backtracking restores the old value.
  bool Set(size_t number, size_t value);
  // Goes back to the newest alternative; false: there is none.
  bool Back(int* instruction, size_t* at);
  bool Step(const RegexInstruction& i, int* instruction, size_t* at);
  bool AtStart(size_t at) const;
  bool AtEnd(size_t at) const;
  // Matches the text of the group again and moves *at past it.
  bool Repeats(int group, size_t* at);
  // Counts steps. False: the search must end.
  bool Worked(size_t steps);
  bool CountSteps();
  bool Charge(size_t bytes);
  void Refuse(absl::Status status);

  const RegexProgram& program_;
  const RegexLimits limits_;
  std::string_view text_;
  MatchGuard* guard_ = nullptr;
  absl::Status status_;
  std::vector<Frame> stack_;
  std::vector<size_t> registers_;  // captures, then marks
  std::vector<uint64_t> tried_;    // a bit for each split and place
  bool remembers_ = false;
  bool searched_ = false;     // a search in this text was made
  size_t stack_charged_ = 0;  // frames
  size_t charged_ = 0;        // bytes in total
  uint64_t steps_ = 0;
  int steps_to_poll_ = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_MATCHER_H_
