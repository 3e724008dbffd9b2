#include "kb_server/door/followed_reads.h"

#include <gtest/gtest.h>

#include "graph/store/graph_writer.h"

namespace docent::server {
namespace {

class FollowedReadsTest : public ::testing::Test {
 protected:
  Quad Make(const std::string& s, const std::string& p, const std::string& o, const std::string& g = "g") {
    return {d_.InternIri(s), d_.InternIri(p), d_.InternIri(o), d_.InternIri(g)};
  }
  void SetUp() override {
    Make("a", "p", "b");
    Make("a", "q", "c", "h");
    reads_.Keep(true);
    Turn({Make("b", "p", "b"), Make("b", "q", "b")}, {});
  }
  void Turn(const std::vector<Quad>& add, const std::vector<Quad>& remove, bool others = false) {
    const Delta delta = writer_.Apply(add, remove);
    version_ = writer_.Freeze(Revision(++revision_));
    reads_.Add(*version_, {&delta}, others);
  }
  // Of what "a p ?" gives.
  std::shared_ptr<ReadTrace> Read() {
    FollowedReads::Begun begun = reads_.Begin();
    EXPECT_EQ(reads_.Find(begun.name), begun.trace);
    const ReadTrace::Scope scope(begun.trace.get());
    version_->Scan({*d_.FindIri("a"), *d_.FindIri("p"), {}, {}});
    begun.trace->SetWhole();
    return begun.trace;
  }
  bool MayHaveChanged(const ReadTrace& trace, uint64_t after) {
    return reads_.MayHaveChanged(trace, after, revision_);
  }

  Dictionary d_;
  FollowedReads reads_{&d_};
  GraphWriter writer_{nullptr};
  GraphVersionPtr version_;
  uint64_t revision_ = 0;
};

TEST_F(FollowedReadsTest, OnlyTurnsThatTouchAReadCount) {
  const auto trace = Read();
  EXPECT_FALSE(MayHaveChanged(*trace, 1));
  Turn({Make("a", "q", "b")}, {});
  Turn({}, {Make("a", "q", "b")});
  EXPECT_FALSE(MayHaveChanged(*trace, 1));
  Turn({Make("a", "p", "c")}, {});
  EXPECT_TRUE(MayHaveChanged(*trace, 1));
  EXPECT_FALSE(reads_.MayHaveChanged(*trace, 1, 3)) << "the version that is looked at is an earlier one";
  Turn({}, {Make("a", "p", "c")});
  EXPECT_TRUE(MayHaveChanged(*trace, 4));
  EXPECT_FALSE(MayHaveChanged(*trace, 5));
}

TEST_F(FollowedReadsTest, WhatCannotBeToldCountsAsChanged) {
  const auto trace = Read();
  Turn({}, {}, /*others=*/true);
  EXPECT_TRUE(MayHaveChanged(*trace, 1)) << "documents";
  std::vector<Quad> many;
  for (int i = 0; i < 300; ++i)
    many.push_back({TermId::Make(TermId::Tag::kInteger, i),
                    many.empty() ? Make("a", "q", "b").predicate : many[0].predicate,
                    Make("a", "q", "b").object, Make("a", "q", "b").graph});
  Turn(many, {});
  EXPECT_TRUE(MayHaveChanged(*trace, 2)) << "a large turn";
  EXPECT_TRUE(reads_.MayHaveChanged(*trace, 3, 4)) << "a turn that is not told of";
  EXPECT_TRUE(reads_.MayHaveChanged(*trace, 3, 2)) << "back";
  EXPECT_FALSE(MayHaveChanged(*trace, 3));
  for (int i = 0; i < 2000; ++i) Turn({}, {});
  EXPECT_TRUE(MayHaveChanged(*trace, 3)) << "too many turns ago";
  EXPECT_FALSE(MayHaveChanged(*trace, 1500));
  reads_.Keep(false);
  EXPECT_TRUE(MayHaveChanged(*trace, revision_)) << "turns are not kept";
  const uint64_t before = revision_;
  Turn({Make("a", "p", "c")}, {});
  reads_.Keep(true);
  EXPECT_TRUE(MayHaveChanged(*trace, before)) << "they were not kept";
  EXPECT_FALSE(MayHaveChanged(*trace, revision_));
}

TEST_F(FollowedReadsTest, GraphsAndPredicatesComeAndGo) {
  FollowedReads::Begun begun = reads_.Begin();
  {
    const ReadTrace::Scope scope(begun.trace.get());
    version_->graphs();
    begun.trace->SetWhole();
  }
  const ReadTrace& trace = *begun.trace;
  Turn({Make("a", "q", "c")}, {Make("b", "q", "b")});
  EXPECT_FALSE(MayHaveChanged(trace, 1));
  Turn({Make("a", "q", "c", "h")}, {});
  EXPECT_TRUE(MayHaveChanged(trace, 2)) << "another graph";
  Turn({Make("b", "q", "c", "h")}, {Make("a", "q", "c", "h")});
  EXPECT_FALSE(MayHaveChanged(trace, 3));
  Turn({}, {Make("b", "q", "c", "h")});
  EXPECT_TRUE(MayHaveChanged(trace, 4)) << "it has gone";
}

TEST_F(FollowedReadsTest, AReadThatIsGivenUpLeavesNothing) {
  const std::string name = reads_.Begin().name;
  EXPECT_EQ(reads_.Find(name), nullptr);
  EXPECT_EQ(reads_.Find("nobody"), nullptr);
}

}  // namespace
}  // namespace docent::server
