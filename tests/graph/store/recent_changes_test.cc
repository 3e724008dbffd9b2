#include "graph/store/recent_changes.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

class RecentChangesTest : public testing::Test {
 protected:
  Quad Make(const std::string& s, const std::string& p, const std::string& o) {
    return {d.InternIri(s), d.InternIri(p), d.InternIri(o), d.InternIri("g")};
  }
  static ReadPattern Reads(const std::string& predicate) { return {{}, Term::Iri(predicate), {}, {}}; }
  Dictionary d;
  RecentChanges changes{8};
};

TEST_F(RecentChangesTest, OnlyWhatCameAfterCounts) {
  changes.Add(Revision(5), {{Make("a", "p", "b")}, {}});
  changes.Add(Revision(6), {{}, {Make("a", "q", "b")}});
  EXPECT_TRUE(changes.Touched(Revision(4), {Reads("p")}, d));
  EXPECT_FALSE(changes.Touched(Revision(5), {Reads("p")}, d));
  EXPECT_TRUE(changes.Touched(Revision(5), {Reads("p"), Reads("q")}, d)) << "removals count, too";
  EXPECT_FALSE(changes.Touched(Revision(4), {Reads("unknown")}, d));
  EXPECT_FALSE(changes.Touched(Revision(4), {}, d));
  EXPECT_TRUE(changes.Touched(Revision(4), {ReadPattern{}}, d));
  EXPECT_FALSE(changes.Touched(Revision(6), {ReadPattern{}}, d));
}

TEST_F(RecentChangesTest, WhatIsForgottenMayHaveTouchedAnything) {
  for (uint64_t r = 1; r <= 10; ++r) changes.Add(Revision(r), {{Make("a", "p", "b")}, {}});
  EXPECT_TRUE(changes.Touched(Revision(5), {Reads("q")}, d));
  EXPECT_FALSE(changes.Touched(Revision(6), {Reads("q")}, d)) << "four changes of one quad fit";
  changes.Clear();
  EXPECT_TRUE(changes.Touched(Revision(9), {Reads("q")}, d));
}

}  // namespace
}  // namespace docent
