// Rules and fixes of diagnostics, as golden files show them, and what must hold of every fix.
#ifndef DOCENT_TESTS_GOLDEN_FINDINGS_H_
#define DOCENT_TESTS_GOLDEN_FINDINGS_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"

namespace docent::golden {

// "-- 3:12 undefined-term: 'att' → 'at'" for each that has a rule or a fix.
inline std::string RulesAndFixes(const Diagnostics& diagnostics, const std::string& source) {
  std::string out;
  for (const Diagnostic& d : diagnostics) {
    if (d.rule.empty() && d.fix.empty()) continue;
    absl::StrAppend(&out, "-- ", d.span.line, ":", d.span.column, " ", d.rule);
    for (const TextEdit& edit : d.fix)
      absl::StrAppend(&out, " '", source.substr(edit.offset, edit.length), "' → '", edit.replacement, "'");
    out += "\n";
  }
  return out;
}

// Each fix by itself: its finding is gone, and there are no more errors than before. All together can be made, too.
inline void ExpectFixesHelp(const Diagnostics& diagnostics, const std::string& source,
                            const std::function<Diagnostics(const std::string&)>& check) {
  const auto errors = [](const Diagnostics& all) {
    return std::count_if(all.begin(), all.end(),
                         [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::kError; });
  };
  const auto count = [](const Diagnostics& all, const Diagnostic& like) {
    return std::count_if(all.begin(), all.end(),
                         [&](const Diagnostic& d) { return d.message == like.message; });
  };
  for (const Diagnostic& d : diagnostics) {
    if (d.fix.empty()) continue;
    size_t applied = 0;
    const std::string fixed = ApplyFixes(source, {d}, &applied);
    EXPECT_EQ(applied, 1u) << d.message;
    const Diagnostics after = check(fixed);
    EXPECT_LT(count(after, d), count(diagnostics, d)) << d.message << "\nafter its fix:\n" << fixed;
    // What a renamed element holds is read for the first time.
    if (d.message.starts_with("unknown element")) continue;
    EXPECT_LE(errors(after), errors(diagnostics)) << d.message << "\nafter its fix:\n"
                                                  << Render(after, fixed);
  }
  size_t applied = 0;
  const std::string fixed = ApplyFixes(source, diagnostics, &applied);
  EXPECT_EQ(applied == 0, fixed == source);
  (void)check(fixed);
}

}  // namespace docent::golden

#endif  // DOCENT_TESTS_GOLDEN_FINDINGS_H_
