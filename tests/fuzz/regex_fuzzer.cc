// Any bytes as flags, pattern and text, a line each: a mistake with its place in the pattern or the flags; or an expression
// that RE2 and our own matcher find in the same texts.
#include "graph/sparql/regex/regex.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "graph/rdf/utf8.h"
#include "graph/sparql/regex/regex_matcher.h"
#include "graph/sparql/regex/regex_replacement.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent::sparql {
namespace {

class Guard : public MatchGuard {
 public:
  bool Worked(size_t) override { return true; }
  bool Charge(size_t bytes) override { return (held += bytes) < (8u << 20); }
  void Release(size_t bytes) override { held -= bytes; }
  size_t held = 0;
};

std::string_view TakeLine(std::string_view* input) {
  const size_t end = input->find('\n');
  const std::string_view line = input->substr(0, end);
  *input = end == std::string_view::npos ? std::string_view() : input->substr(end + 1);
  return line;
}

void CheckSearch(std::string_view pattern, std::string_view flags, std::string_view text, Regex* regex,
                 const RegexLimits& limits) {
  Guard guard;
  std::optional<bool> found;
  {
    Regex::Searches searches(regex, text, &guard);
    std::string_view whole;
    const absl::StatusOr<bool> answer = searches.Find(0, {&whole, 1});
    if (answer.ok()) found = *answer;
    if (answer.ok() && *answer) {
      fuzz::Require(whole.empty() || (whole.data() >= text.data() && whole.end() <= text.end()),
                    "a match outside of the text");
    }
  }
  fuzz::Require(guard.held == 0, "a search that keeps memory");
  if (text.empty() && found)
    fuzz::Require(*found == regex->matches_empty_text(), "another answer on the empty text");
  if (!regex->is_re2() || !found) return;
  RegexTree tree;
  ParseRegex(pattern, flags, &tree, limits);
  const RegexProgram program = CompileRegexProgram(tree);
  RegexMatcher matcher(program, limits);
  matcher.Begin(text, &guard);
  const bool ours = matcher.Find(0);
  if (matcher.status().ok()) {
    fuzz::Require(ours == *found, "RE2 and our matcher differ on '" + std::string(pattern) + "', flags '" +
                                      std::string(flags) + "', text '" + std::string(text) + "'");
  }
  matcher.End();
}

void CheckOne(std::string_view input) {
  if (FindInvalidUtf8(input)) return;
  const std::string_view flags = TakeLine(&input), pattern = TakeLine(&input);
  RegexLimits limits;
  limits.regex_instructions = 2000;
  limits.regex_steps = 10'000'000;
  limits.regex_backtracking_steps = 20000;
  std::unique_ptr<Regex> regex;
  if (const auto mistake = Regex::Compile(pattern, flags, true, &regex, limits)) {
    const std::string_view about = mistake->where == RegexMistake::Where::kFlags ? flags : pattern;
    fuzz::Require(!mistake->message.empty() && mistake->offset <= about.size() && mistake->length > 0,
                  "a mistake without message or place");
    return;
  }
  CheckSearch(pattern, flags, input, regex.get(), limits);
  CheckSearch(pattern, flags, "", regex.get(), limits);
  RegexReplacement replacement;
  ReadReplacement(input, regex->groups(), regex->literal(), &replacement);
  fuzz::Require(replacement.texts.size() == replacement.groups.size() + 1, "a group without its place");
}

}  // namespace
}  // namespace docent::sparql

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  docent::sparql::CheckOne(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
