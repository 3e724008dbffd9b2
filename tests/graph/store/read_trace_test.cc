#include "graph/store/read_trace.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_writer.h"

namespace docent {
namespace {

class ReadTraceTest : public ::testing::Test {
 protected:
  TermId Id(const std::string& name) { return d_.InternIri(name); }
  Quad Make(const std::string& s, const std::string& p, const std::string& o, const std::string& g = "g") {
    return {Id(s), Id(p), Id(o), Id(g)};
  }
  void SetUp() override {
    for (const char* name : {"a", "b", "c", "p", "q", "g", "h"}) Id(name);
    writer_.Add(Make("a", "p", "b"));
    version_ = writer_.Freeze(Revision(1));
  }
  // What `read` looks at.
  template <typename Read>
  ReadTrace& Trace(Read read) {
    trace_.emplace(d_.size());
    const ReadTrace::Scope scope(&*trace_);
    read(*version_);
    trace_->SetWhole();
    return *trace_;
  }

  Dictionary d_;
  GraphWriter writer_{nullptr};
  GraphVersionPtr version_;
  std::optional<ReadTrace> trace_;
};

TEST_F(ReadTraceTest, WhatMatchesAPatternTouchesIt) {
  const ReadTrace& trace = Trace([this](const GraphVersion& version) {
    version.Count({Id("a"), Id("p"), {}, {}});
    version.ContainsMatch({{}, Id("q"), Id("c"), {}});
  });
  EXPECT_TRUE(trace.whole());
  EXPECT_TRUE(trace.MayTouch(Make("a", "p", "c"))) << "there is none yet";
  EXPECT_TRUE(trace.MayTouch(Make("b", "q", "c", "h")));
  EXPECT_FALSE(trace.MayTouch(Make("b", "p", "c")));
  EXPECT_FALSE(trace.MayTouch(Make("a", "q", "b")));
  EXPECT_FALSE(trace.MayTouchNames());
}

TEST_F(ReadTraceTest, EveryWayToReadIsNoted) {
  const Quad one = Make("a", "p", "b"), other = Make("c", "q", "b");
  const QuadPattern pattern{one.subject, one.predicate, {}, {}};
  const std::vector<std::function<void(const GraphVersion&)>> kWays = {
      [&](const GraphVersion& v) { v.Contains(one); },
      [&](const GraphVersion& v) { v.ContainsMatch(pattern); },
      [&](const GraphVersion& v) { v.Scan(pattern); },
      [&](const GraphVersion& v) { v.ScanInOrder(pattern, IndexOrder::kOspg); },
      [&](const GraphVersion& v) { v.Count(pattern); },
      [&](const GraphVersion& v) { v.Sample(pattern, 3); },
      [&](const GraphVersion& v) { v.ForEach(pattern, [](const Quad&) { return true; }); },
      [&](const GraphVersion& v) {
        QuadCursor cursor;
        v.Rescan(pattern, &cursor);
      },
      [&](const GraphVersion& v) {
        QuadCursor cursor;
        v.Rescan(pattern, *GraphVersion::PathFor(3), &cursor);
      },
      [&](const GraphVersion& v) { GraphWriter(std::make_shared<GraphVersion>()).Add(one), v.Contains(one); },
      [&](const GraphVersion&) { GraphWriter(version_).Remove(one); },
      [&](const GraphVersion&) { GraphWriter(version_).RemoveAll(std::vector<Quad>(40, one)); },
      [&](const GraphVersion&) { GraphWriter(version_).AddAll(std::vector<Quad>(40, one)); }};
  for (size_t i = 0; i < kWays.size(); ++i) {
    const ReadTrace& trace = Trace(kWays[i]);
    EXPECT_TRUE(trace.MayTouch(one)) << i;
    EXPECT_FALSE(trace.MayTouch(other)) << i;
  }
  for (const auto& names : {&GraphVersion::graphs, &GraphVersion::predicates})
    EXPECT_TRUE(Trace([&](const GraphVersion& version) { (version.*names)(); }).MayTouchNames());
}

TEST_F(ReadTraceTest, ATermThatWasUnknownMayBeTheOneThatWasSought) {
  const ReadTrace& trace = Trace([this](const GraphVersion&) { d_.FindIri("later"); });
  EXPECT_FALSE(trace.MayTouch(Make("a", "p", "b")));
  EXPECT_TRUE(trace.MayTouch(Make("a", "p", "later")));
}

TEST_F(ReadTraceTest, WhatCannotBeToldTouches) {
  trace_.emplace(d_.size());
  EXPECT_TRUE(trace_->MayTouch(Make("a", "p", "b"))) << "the read has not ended";
  EXPECT_TRUE(Trace([](const GraphVersion&) { ReadTrace::NoteAnything(); }).MayTouch(Make("a", "p", "b")));
  EXPECT_TRUE(Trace([](const GraphVersion& version) { version.Scan({}); }).MayTouch(Make("b", "q", "c")));
}

// More patterns than are kept stand for whole predicates.
TEST_F(ReadTraceTest, OfManyPatternsThePredicatesAreKept) {
  std::vector<TermId> subjects;
  for (int i = 0; i < 1000; ++i) subjects.push_back(Id(absl::StrCat("s", i)));
  const auto look = [&](TermId predicate) {
    return [&subjects, predicate](const GraphVersion& version) {
      for (const TermId subject : subjects) version.Scan({subject, predicate, {}, {}});
    };
  };
  EXPECT_TRUE(Trace(look(Id("p"))).MayTouch(Make("b", "p", "c")));
  EXPECT_FALSE(trace_->MayTouch(Make("b", "q", "c")));
  EXPECT_TRUE(Trace(look(TermId())).MayTouch(Make("b", "q", "c"))) << "all of these bind a subject alone";
}

TEST_F(ReadTraceTest, OutsideOfAScopeNothingIsNoted) {
  Trace([](const GraphVersion&) {});
  version_->Scan({});
  EXPECT_FALSE(trace_->MayTouch(Make("a", "p", "b")));
}

}  // namespace
}  // namespace docent
