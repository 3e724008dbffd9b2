// Checks of a fuzz target's results. A violation aborts, so that libFuzzer and sanitizers see it.
#ifndef DOCENT_TESTS_FUZZ_FUZZ_CHECK_H_
#define DOCENT_TESTS_FUZZ_FUZZ_CHECK_H_

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"

namespace docent::fuzz {

inline void Require(bool good, const std::string& what) {
  if (good) return;
  std::fprintf(stderr, "fuzz finding: %s\n", what.c_str());
  std::abort();
}

// Each diagnostic has a message and points into the text.
inline void RequireSound(const Diagnostics& diagnostics, std::string_view text) {
  for (const Diagnostic& d : diagnostics) {
    Require(!d.message.empty(), "a diagnostic without message");
    Require(d.span.offset <= text.size() && d.span.length <= text.size() - d.span.offset,
            "a span outside of the text: " + d.message);
    Require(d.span.line >= 0 && (d.span.line == 0 || d.span.column > 0),
            "a place without column: " + d.message);
  }
  Require(diagnostics.empty() || !Render(diagnostics, text).empty(), "nothing rendered");
}

// Each fix by itself can be made.
inline void RequireSoundFixes(const Diagnostics& diagnostics, std::string_view text) {
  for (const Diagnostic& d : diagnostics) {
    if (d.fix.empty()) continue;
    size_t applied = 0;
    const std::string fixed = ApplyFixes(text, {d}, &applied);
    Require(applied == 1, "a fix that cannot be made: " + d.message);
    Require(fixed != text, "a fix that changes nothing: " + d.message);
  }
}

}  // namespace docent::fuzz

#endif  // DOCENT_TESTS_FUZZ_FUZZ_CHECK_H_
