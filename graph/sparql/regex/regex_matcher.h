// Backtracking matcher of programs (regex_program.h). Without back-references it remembers the splits that it has tried at
// each place and takes time linear in text times program; with them it may take exponential time, up to a limit of steps.
// Private to this folder. One thread.
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

  // Searches follow in `text`, with rising places. Text and guard must stay until End.
  void Begin(std::string_view text, MatchGuard* guard);
  // The leftmost match at or after `at`, which is no place inside a character. False: there is none, or the search was
  // ended; see status().
  bool Find(size_t at);
  // Gives back what the searches kept.
  void End();

  // RESOURCE_EXHAUSTED, naming the limit; CANCELLED where the guard ended the search.
  const absl::Status& status() const { return status_; }
  // Of the match found: what group n matched, 0 the whole. nullopt: the group has not matched.
  std::optional<std::string_view> Group(int number) const;

 private:
  static constexpr size_t kNowhere = static_cast<size_t>(-1);

  // To try later: go on at instruction `what` in place `value`. Or, where negative: register -1 - what had that value.
  struct Frame {
    int what;
    size_t value;
  };

  bool MatchAt(size_t at);
  // Whether the split has not been tried at this place.
  bool IsFresh(int split, size_t at);
  bool Push(int what, size_t value);
  // Keeps `value` in the register, to be undone on the way back.
  bool Set(size_t number, size_t value);
  // To the newest alternative; false: there is none.
  bool Back(int* instruction, size_t* at);
  bool Step(const RegexInstruction& i, int* instruction, size_t* at);
  bool AtStart(size_t at) const;
  bool AtEnd(size_t at) const;
  // Moves *at past what the group matched before.
  bool Repeats(int group, size_t* at) const;
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
  bool searched_ = false;     // this text
  size_t stack_charged_ = 0;  // frames
  size_t charged_ = 0;        // bytes, of all
  uint64_t steps_ = 0;
  int steps_to_poll_ = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_MATCHER_H_
