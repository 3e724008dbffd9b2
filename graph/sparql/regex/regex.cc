#include "graph/sparql/regex/regex.h"

#include <re2/re2.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "graph/sparql/regex/re2_source.h"
#include "graph/sparql/regex/regex_matcher.h"
#include "graph/sparql/regex/regex_program.h"

namespace docent::sparql {

// For a program and the states of its searches; the second for what is too large for the first.
constexpr int64_t kRe2MemoryBytes[] = {512 << 10, 8 << 20};
constexpr size_t kBytesOfInstruction = 64;  // of our matcher

struct Regex::Impl {
  RegexTree tree;
  RegexLimits limits;
  std::unique_ptr<re2::RE2> re2;  // null: the matcher searches
  size_t re2_bytes = 0;
  std::vector<re2::StringPiece> pieces;
  std::optional<RegexProgram> program;
  std::optional<RegexMatcher> matcher;

  RegexMatcher& Matcher() {
    if (!program) {
      program = CompileRegexProgram(tree);
      matcher.emplace(*program, limits);
    }
    return *matcher;
  }
};

Regex::Regex(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Regex::~Regex() = default;

std::optional<RegexMistake> Regex::Compile(std::string_view pattern, std::string_view flags, bool capture,
                                           std::unique_ptr<Regex>* out, const RegexLimits& limits) {
  auto impl = std::make_unique<Impl>();
  impl->limits = limits;
  if (std::optional<RegexMistake> mistake = ParseRegex(pattern, flags, &impl->tree, limits)) return mistake;
  if (const std::optional<std::string> source = Re2Source(impl->tree, capture)) {
    re2::RE2::Options options;
    options.set_log_errors(false);
    for (const int64_t bytes : kRe2MemoryBytes) {
      options.set_max_mem(bytes);
      impl->re2 = std::make_unique<re2::RE2>(*source, options);
      impl->re2_bytes = static_cast<size_t>(bytes);
      if (impl->re2->ok()) break;
    }
    if (!impl->re2->ok()) impl->re2 = nullptr;  // too large for RE2
  }
  if (impl->re2 == nullptr) impl->Matcher();
  *out = std::unique_ptr<Regex>(new Regex(std::move(impl)));
  return std::nullopt;
}

int Regex::groups() const {
  return impl_->tree.groups;
}
bool Regex::literal() const {
  return impl_->tree.literal;
}
bool Regex::matches_empty_text() const {
  return MatchesEmptyText(impl_->tree.root);
}
bool Regex::is_re2() const {
  return impl_->re2 != nullptr;
}
size_t Regex::bytes() const {
  const size_t instructions = impl_->program ? impl_->program->instructions.size() : 0;
  return (impl_->re2 != nullptr ? impl_->re2_bytes : 0) + instructions * kBytesOfInstruction;
}
uint64_t Regex::size() const {
  return impl_->re2 != nullptr ? static_cast<uint64_t>(impl_->re2->ProgramSize())
                               : impl_->program->instructions.size();
}

Regex::Searches::Searches(Regex* regex, std::string_view text, MatchGuard* guard)
    : regex_(*regex),
      text_(text),
      guard_(*guard),
      re2_is_exact_(!regex->impl_->tree.multi_line || !regex->impl_->tree.has_anchors || text.empty() ||
                    text.back() != '\n') {}

Regex::Searches::~Searches() {
  if (began_) regex_.impl_->matcher->End();
}

absl::StatusOr<bool> Regex::Searches::Find(size_t at, absl::Span<std::string_view> groups) {
  Impl& impl = *regex_.impl_;
  if (!impl.tree.has_back_references) {
    // An instruction of our matcher takes about four times as long.
    const uint64_t steps = regex_.size() * (impl.re2 != nullptr ? 1 : 4) * (text_.size() - at);
    if (steps > impl.limits.regex_steps) {
      return absl::ResourceExhaustedError(
          "evaluation stopped at its limit regex_steps = " + std::to_string(impl.limits.regex_steps) + ": " +
          std::to_string(regex_.size()) + " instructions of a regular expression on a text of " +
          std::to_string(text_.size() - at) + " bytes");
    }
  }
  if (impl.re2 != nullptr) {
    impl.pieces.assign(re2_is_exact_ ? groups.size() : 0, {});
    const re2::StringPiece whole(text_.data(), text_.size());
    const bool found = impl.re2->Match(whole, at, text_.size(), re2::RE2::UNANCHORED, impl.pieces.data(),
                                       static_cast<int>(impl.pieces.size()));
    if (re2_is_exact_ || !found) {  // RE2 matches at least as much as XPath
      for (size_t i = 0; i < impl.pieces.size(); ++i) {
        const re2::StringPiece& piece = impl.pieces[i];
        groups[i] =
            piece.data() == nullptr ? std::string_view() : std::string_view(piece.data(), piece.size());
      }
      return found;
    }
  }
  RegexMatcher& matcher = impl.Matcher();
  if (!began_) matcher.Begin(text_, &guard_);
  began_ = true;
  const bool found = matcher.Find(at);
  if (!matcher.status().ok()) return matcher.status();
  for (size_t i = 0; found && i < groups.size(); ++i)
    groups[i] = matcher.Group(static_cast<int>(i)).value_or(std::string_view());
  return found;
}

}  // namespace docent::sparql
