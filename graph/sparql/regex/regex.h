// Regular expression of XPath, ready to search texts: by RE2 where that has the same meaning and is quick, else by our own
// matcher. Every search is bounded. One thread.
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
  // `capture`: searches are asked for what groups matched.
  static std::optional<RegexMistake> Compile(std::string_view pattern, std::string_view flags, bool capture,
                                             std::unique_ptr<Regex>* out, const RegexLimits& limits = {});
  ~Regex();

  int groups() const;
  bool literal() const;  // flag q
  bool matches_empty_text() const;
  // Instructions: what compiling it has taken, and what a search takes for each byte at worst.
  uint64_t size() const;
  // Whether RE2 searches, for tests.
  bool is_re2() const;

  // Searches that follow each other in one text. One at a time for each expression.
  class Searches {
   public:
    // All must outlive it.
    Searches(Regex* regex, std::string_view text, MatchGuard* guard);
    ~Searches();
    Searches(const Searches&) = delete;
    Searches& operator=(const Searches&) = delete;

    // The leftmost match at or after `at`; the places of later calls are larger. Fills `groups`: what group n matched, 0 the
    // whole; one that has not matched gets an empty text. RESOURCE_EXHAUSTED, naming the limit; CANCELLED where the guard
    // ended it.
    absl::StatusOr<bool> Find(size_t at, absl::Span<std::string_view> groups);

   private:
    Regex& regex_;
    const std::string_view text_;
    MatchGuard& guard_;
    const bool re2_is_exact_;
    bool began_ = false;  // the matcher
  };

 private:
  struct Impl;
  explicit Regex(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_REGEX_H_
