#include "graph/sparql/regex/regex_matcher.h"

#include <algorithm>
#include <string>
#include <utility>

#include "graph/rdf/utf8.h"
#include "graph/sparql/regex/unicode_sets.h"

namespace docent::sparql {
namespace {

using Op = RegexInstruction::Kind;

constexpr int kStepsAPoll = 1024;
constexpr size_t kBytesAStep = 4;        // a step takes about as long as reading them
constexpr size_t kFramesAtFirst = 1024;  // not counted
constexpr size_t kBytesCompared = 8;     // in the time of a step
constexpr size_t kStepsOfVariants = 8;   // to look up whether two characters differ in case alone
constexpr size_t kBytesKept = 1u << 20;  // of buffers, for the next text

}  // namespace

void RegexMatcher::Begin(std::string_view text, MatchGuard* guard) {
  text_ = text;
  guard_ = guard;
  status_ = absl::OkStatus();
  steps_ = 0;
  steps_to_poll_ = kStepsAPoll;
  stack_charged_ = kFramesAtFirst;
  registers_.resize(static_cast<size_t>(2 * (program_.groups + 1) + program_.marks));
  searched_ = false;
  remembers_ = !program_.has_back_references && program_.splits > 0;
  if (!remembers_) return;
  const size_t words = (static_cast<size_t>(program_.splits) * (text.size() + 1) + 63) / 64;
  remembers_ = Charge(words * sizeof(uint64_t));
  if (remembers_) tried_.assign(words, 0);
}

void RegexMatcher::End() {
  if (charged_ > 0) guard_->Release(charged_);
  charged_ = 0;
  if (stack_.capacity() * sizeof(Frame) > kBytesKept) stack_ = {};
  if (tried_.capacity() * sizeof(uint64_t) > kBytesKept) tried_ = {};
}

void RegexMatcher::Refuse(absl::Status status) {
  if (status_.ok()) status_ = std::move(status);
}

bool RegexMatcher::Charge(size_t bytes) {
  charged_ += bytes;
  if (guard_->Charge(bytes)) return true;
  Refuse(absl::CancelledError("the memory of the evaluation is at its limit"));
  return false;
}

bool RegexMatcher::CountSteps() {
  steps_ += kStepsAPoll;
  steps_to_poll_ = kStepsAPoll;
  if (program_.has_back_references && steps_ > limits_.regex_backtracking_steps) {
    Refuse(absl::ResourceExhaustedError("evaluation stopped at its limit regex_backtracking_steps = " +
                                        std::to_string(limits_.regex_backtracking_steps) +
                                        ": a regular expression with back-references on a text of " +
                                        std::to_string(text_.size()) + " bytes"));
    return false;
  }
  if (guard_->Worked(kStepsAPoll * kBytesAStep)) return true;
  Refuse(absl::CancelledError("the evaluation has ended"));
  return false;
}

bool RegexMatcher::IsFresh(int split, size_t at) {
  if (!remembers_) return true;
  const size_t bit = static_cast<size_t>(split) * (text_.size() + 1) + at;
  const uint64_t mask = uint64_t{1} << (bit & 63);
  if ((tried_[bit >> 6] & mask) != 0) return false;
  tried_[bit >> 6] |= mask;
  return true;
}

bool RegexMatcher::Push(int what, size_t value) {
  if (stack_.size() >= stack_charged_) {
    if (!Charge(stack_charged_ * sizeof(Frame))) return false;
    stack_charged_ *= 2;
  }
  stack_.push_back({what, value});
  return true;
}

bool RegexMatcher::Set(size_t number, size_t value) {
  const bool kept = Push(-1 - static_cast<int>(number), registers_[number]);
  registers_[number] = value;
  return kept;
}

bool RegexMatcher::Back(int* instruction, size_t* at) {
  while (!stack_.empty()) {
    const Frame frame = stack_.back();
    stack_.pop_back();
    if (frame.what >= 0) {
      *instruction = frame.what;
      *at = frame.value;
      return true;
    }
    registers_[static_cast<size_t>(-1 - frame.what)] = frame.value;
  }
  return false;
}

// Flag m (XPath and XQuery Functions 3.1, 5.6.2): no anchor matches after a newline that ends the text.
bool RegexMatcher::AtStart(size_t at) const {
  return at == 0 || (program_.multi_line && at < text_.size() && text_[at - 1] == '\n');
}

bool RegexMatcher::AtEnd(size_t at) const {
  if (!program_.multi_line) return at == text_.size();
  return at < text_.size() ? text_[at] == '\n' : text_.empty() || text_.back() != '\n';
}

bool RegexMatcher::Worked(size_t steps) {
  while (steps > 0) {
    const auto now = std::min(steps, static_cast<size_t>(steps_to_poll_));
    steps -= now;
    steps_to_poll_ -= static_cast<int>(now);
    if (steps_to_poll_ == 0 && !CountSteps()) return false;
  }
  return true;
}

bool RegexMatcher::Repeats(int group, size_t* at) {
  const std::string_view before = Group(group).value_or(std::string_view());
  if (!program_.ignore_case) {
    const std::string_view rest = text_.substr(*at, before.size());
    const auto same =
        static_cast<size_t>(std::mismatch(rest.begin(), rest.end(), before.begin()).first - rest.begin());
    if (!Worked(same / kBytesCompared) || same < before.size()) return false;
    *at += before.size();
    return true;
  }
  for (size_t i = 0; i < before.size();) {
    if (*at >= text_.size() || !Worked(1)) return false;
    const char32_t a = NextCodePoint(before, &i), b = NextCodePoint(text_, at);
    if (a == b) continue;
    if (!Worked(kStepsOfVariants) || !AreCaseVariants(a, b)) return false;
  }
  return true;
}

std::optional<std::string_view> RegexMatcher::Group(int number) const {
  const size_t begin = registers_[static_cast<size_t>(2 * number)];
  const size_t end = registers_[static_cast<size_t>(2 * number + 1)];
  if (end == kNowhere || begin == kNowhere || end < begin) return std::nullopt;
  return text_.substr(begin, end - begin);
}

// Executes one instruction. False: it does not match.
bool RegexMatcher::Step(const RegexInstruction& i, int* instruction, size_t* at) {
  ++*instruction;
  switch (i.kind) {
    case Op::kCharacter:
      return *at < text_.size() && NextCodePoint(text_, at) == i.character;
    case Op::kSet:
      return *at < text_.size() && i.set->Contains(NextCodePoint(text_, at));
    case Op::kStart:
      return AtStart(*at);
    case Op::kEnd:
      return AtEnd(*at);
    case Op::kSplit:
      *instruction = i.next;
      return IsFresh(i.number, *at) && Push(i.other, *at);
    case Op::kJump:
      *instruction = i.next;
      return true;
    case Op::kSave:
      return Set(static_cast<size_t>(i.number), *at);
    case Op::kMark:
      return Set(static_cast<size_t>(2 * (program_.groups + 1) + i.number), *at);
    case Op::kLeaveIfEmpty:
      if (registers_[static_cast<size_t>(2 * (program_.groups + 1) + i.number)] == *at) *instruction = i.next;
      return true;
    case Op::kBackReference:
      return Repeats(i.number, at);
    case Op::kMatch:
      break;
  }
  return true;
}

bool RegexMatcher::MatchAt(size_t start) {
  std::fill(registers_.begin(), registers_.end(), kNowhere);
  stack_.clear();
  int instruction = 0;
  size_t at = start;
  while (true) {
    if (--steps_to_poll_ == 0 && !CountSteps()) return false;
    const RegexInstruction& i = program_.instructions[static_cast<size_t>(instruction)];
    if (i.kind == Op::kMatch) {
      registers_[0] = start;
      registers_[1] = at;
      return true;
    }
    if (Step(i, &instruction, &at)) continue;
    if (!status_.ok() || !Back(&instruction, &at)) return false;
  }
}

bool RegexMatcher::Find(size_t at) {
  // A failed attempt cannot succeed in the next search, except when empty matches are skipped.
  if (searched_ && program_.matches_empty_text) std::fill(tried_.begin(), tried_.end(), 0);
  searched_ = true;
  while (status_.ok()) {
    if (MatchAt(at)) return true;
    if (at >= text_.size() || program_.only_at_start) return false;
    NextCodePoint(text_, &at);
  }
  return false;
}

}  // namespace docent::sparql
