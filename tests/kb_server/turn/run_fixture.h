// Turns with one workflow whose nodes write facts, set variables or give back results.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_RUN_FIXTURE_H_
#define DOCENT_TESTS_KB_SERVER_TURN_RUN_FIXTURE_H_

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {

class RunActionsTest : public ::testing::Test {
 protected:
  // A workflow W of one flow F: `nodes` one after the other, unless links are given.
  void Deploy(const std::string& nodes, std::vector<std::string> names, const std::string& before = "",
              const std::string& links = "") {
    std::string text = absl::StrCat(
        "<CAWL name=\"W\" xmlns:w=\"urn:w:\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">", before,
        "<flow name=\"F\"><variable name=\"x\"/><variable name=\"y\"/><source name=\"s\"/>", nodes,
        "<sink name=\"e\"/>", links);
    if (links.empty()) {
      names.insert(names.begin(), "s");
      names.push_back("e");
      for (size_t i = 0; i + 1 < names.size(); ++i)
        absl::StrAppend(&text, "<link from=\"", names[i], "\" to=\"", names[i + 1], "\"/>");
    }
    Must(test::Put(Document::Kind::kCawl, "w.xml", absl::StrCat(text, "</flow></CAWL>")));
  }
  void DeployOne(const std::string& inside) { Deploy("<node name=\"A\">" + inside + "</node>", {"A"}); }
  static std::string When(const std::string& s, const std::string& v, const std::string& o) {
    return absl::StrCat("<condition><context name=\"c\"><rule><constraint><subject>", s, "</subject><verb>",
                        v, "</verb><object>", o, "</object></constraint></rule></context></condition>");
  }

  // The same, and an event of the operation "ring".
  static std::string WhenRungAnd(const std::string& s, const std::string& v, const std::string& o) {
    std::string when = When(s, v, o);
    const std::string_view begin = "<condition>";
    return when.replace(
        0, begin.size(),
        "<condition expression=\"rang and c\"><case name=\"rang\"><event operation=\"ring\"/></case>");
  }
  TurnResult Ring() {
    return Must(test::Tell({test::Fact("bell", "a", "docent:Event"),
                            test::Fact("bell", "docent:operation", Term::Literal("ring"))}));
  }

  TurnResult Must(WriteBatch batch) {
    batch.time_us = now_us_ += 1000;
    absl::StatusOr<TurnResult> result = RunTurn(&stages_, std::move(batch), ++head_);
    EXPECT_TRUE(result.ok()) << result.status();
    if (!result.ok()) return {};
    return *std::move(result);
  }
  TurnResult Run(std::vector<std::pair<std::string, Term>> variables = {}) {
    return Must(test::Start("W", std::move(variables)));
  }
  // The clock's turns that runs which go on later ask for; what was said in them.
  std::vector<std::string> Settle() {
    std::vector<std::string> said;
    for (int turns = 0; stages_.engine.AwaitsTick() && turns < 2000; ++turns) {
      WriteBatch tick;
      tick.clock_tick = true;
      const std::vector<std::string> more = Said(Must(std::move(tick)));
      said.insert(said.end(), more.begin(), more.end());
    }
    return said;
  }
  // "SUBJECT from>to: cause" of each transition.
  static std::vector<std::string> Said(const TurnResult& result) {
    std::vector<std::string> said;
    for (const Transition& t : result.record.transitions)
      said.push_back(absl::StrCat(t.subject, " ", t.from, ">", t.to, ": ", t.cause));
    return said;
  }
  // The graphs in which the fact stands.
  std::vector<std::string> Sources(const TermQuad& fact) const {
    std::vector<std::string> sources;
    const auto s = dictionary_.Find(fact.subject), p = dictionary_.Find(fact.predicate),
               o = dictionary_.Find(fact.object);
    if (!s || !p || !o) return sources;
    stages_.writer.current().ForEach({*s, *p, *o, {}}, [&](const Quad& quad) {
      sources.push_back(dictionary_.Decode(quad.graph).lexical);
      return true;
    });
    std::sort(sources.begin(), sources.end());
    return sources;
  }
  bool Has(const TermQuad& fact) const { return !Sources(fact).empty(); }
  size_t Size() const { return stages_.writer.current().size(); }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  Stages stages_{&dictionary_, &functions_, Limits{}};
  uint64_t head_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
};

}  // namespace docent::server

#endif  // DOCENT_TESTS_KB_SERVER_TURN_RUN_FIXTURE_H_
