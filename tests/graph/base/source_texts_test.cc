#include "graph/base/source_texts.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

TEST(SourceTexts, EachIsShownWithTheLineOfItsOwnText) {
  const std::string first = "one\ntwo", second = "three\nfour";
  SourceTexts texts;
  texts.Put("a", "other");
  texts.Put("a", first);
  texts.Put("b", second);
  const Diagnostics diagnostics = {{"a", {2, 1}, "odd", ""},
                                   {"b", {2, 3}, "even", ""},
                                   {"c", {1, 1}, "unknown", "", Diagnostic::Severity::kWarning}};
  EXPECT_EQ(texts.ToStatus(diagnostics).message(),
            "a:2:1: error: odd\n  two\n  ^\nb:2:3: error: even\n  four\n    ^\nc:1:1: warning: unknown\n");
  EXPECT_TRUE(texts.ToStatus({diagnostics[2]}).ok());
}

}  // namespace
}  // namespace docent
