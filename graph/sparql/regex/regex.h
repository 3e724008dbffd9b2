// Compiled regular expression of XPath. RE2 searches if it has the same meaning and is fast, else our own
// matcher does. Every search is bounded. One thread.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_REGEX_H_
#define DOCENT_GRAPH_SPARQL_REGEX_REGEX_H_

#include <memory>
#include <optional>
#include <string_view>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/sparql/regex/match_guard.h"
#include "graph/sparql/regex/regex_parser.h"

namespace docent::sparql {

class Regex {
 public:
  // `capture`: the caller needs the texts of groups.
  static std::optional<RegexMistake> Compile(std::string_view pattern, std::string_view flags, bool capture,
                                             std::unique_ptr<Regex>* out, const RegexLimits& limits = {});
  ~Regex();

  int groups() const;
  bool literal() const;  // flag q
  bool matches_empty_text() const;
  // Size in instructions: the cost of compiling it, and the worst-case cost of a search for each byte.
  uint64_t size() const;
  // Memory that it takes at most, with what RE2 keeps of its searches.
  size_t bytes() const;
  // True if RE2 searches; for tests.
  bool is_re2() const;

  // A sequence of searches in one text. One at a time for each expression.
  class Searches {
   public:
    // All arguments must outlive it.
    Searches(Regex* regex, std::string_view text, MatchGuard* guard);
    ~Searches();
    Searches(const Searches&) = delete;
    Searches& operator=(const Searches&) = delete;

    // The leftmost match at or after `at`, which must not decrease from call to call. Fills `groups`: the
    // text of group n, 0 for the whole match; empty for a group without a match. RESOURCE_EXHAUSTED, naming
    // the limit; CANCELLED if the guard ended it.
    absl::StatusOr<bool> Find(size_t at, absl::Span<std::string_view> groups);

   private:
    Regex& regex_;
    const std::string_view text_;
    MatchGuard& guard_;
    const bool re2_is_exact_;
    bool began_ = false;  // Begin of the matcher was called
  };

 private:
  struct Impl;
  explicit Regex(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_H_
