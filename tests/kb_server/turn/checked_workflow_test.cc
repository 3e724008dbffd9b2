// The server accepts all workflows that `docent check` accepts: random workflows that pass CheckDocument are
// deployed and run, under limits that many of them hardly meet.
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"
#include "workflow/cawl/check/check.h"
#include "workflow/cawl/parser.h"

namespace docent::server {
namespace {

using test::Fact;

class RandomWorkflow {
 public:
  explicit RandomWorkflow(uint32_t seed) : random_(seed) {}

  std::string Text() {
    std::string nodes, links = Link("s", "N0", "");
    const int count = 1 + Below(3);
    for (int i = 0; i < count; ++i) {
      const std::string name = absl::StrCat("N", i);
      absl::StrAppend(&nodes, "<node name=\"", name, "\"", Below(12) == 0 ? " ext:forEach=\"?a\"" : "", ">",
                      Below(5) == 0 ? absl::StrCat("<wait joinCondition=\"", BeforeNode(i), "\"/>") : "",
                      Below(6) == 0 ? "" : Condition(), Below(2) == 0 ? "<invoke operation=\"greet\"/>" : "",
                      "</node>");
      if (i > 0 && Below(3) == 0)
        absl::StrAppend(
            &links,
            Link(name, "N0", absl::StrCat(" ext:while=\"", Word(0), " ", Word(1), " ", Word(2), "\"")));
      absl::StrAppend(&links, Link(name, i + 1 < count ? absl::StrCat("N", i + 1) : "e", ""));
    }
    return absl::StrCat(
        "<CAWL name=\"W\" xmlns:w=\"urn:w:\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">",
        Below(2) == 0
            ? absl::StrCat("<activator name=\"A\"><activate flow=\"F\"/>", Condition(), "</activator>")
            : "",
        "<flow name=\"F\"><variable name=\"a\"/><variable name=\"b\"/><source name=\"s\"/>", nodes,
        "<sink name=\"e\"/>", links, "</flow></CAWL>");
  }

 private:
  uint32_t Below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }
  template <size_t n>
  std::string One(const char* const (&words)[n]) {
    return words[Below(n)];
  }

  static std::string Link(const std::string& from, const std::string& to, const std::string& more) {
    return absl::StrCat("<link from=\"", from, "\" to=\"", to, "\"", more, "/>");
  }
  std::string BeforeNode(int i) {
    return i == 0 ? "s" : absl::StrCat(Below(3) == 0 ? "not not " : "", "N", i - 1);
  }

  std::string Word(int place) {
    static constexpr const char* kSubjects[] = {"?a", "$a", "?b", "w:R1", "w:John", "&lt;urn:w:x&gt;"};
    static constexpr const char* kVerbs[] = {"docent:isAt", "a", "?v", "$b", "w:p", "docent:feels"};
    static constexpr const char* kObjects[] = {
        "?a",          "$b",          "w:Hall",      "&gt; 0.5",   "'x'@en-GB", "!= $a",
        "= ?b",        "-7",          "?b",          "true",       "1e400",     "'z'^^xsd:integer",
        "'q'^^w:type", "&lt; 'ä\\n'", "docent:Glad", "'&lt;&amp;'"};
    static constexpr const char* kWrong[] = {"'y'@12", "_:x", "\"\"\"", "&lt;urn:a b&gt;", "x:y", "$nobody"};
    if (Below(400) == 0) return One(kWrong);
    return place == 0 ? One(kSubjects) : place == 1 ? One(kVerbs) : One(kObjects);
  }
  std::string Typed(const std::string& element, int place) {
    const std::string word = Word(place);
    const bool variable = word[0] == '?' || word[0] == '$';
    const char* type = !variable || Below(4) != 0 ? ""
                       : Below(2) == 0            ? " type=\"docent:Robot\""
                                                  : " type=\"xsd:string\"";
    return absl::StrCat("<", element, type, ">", word, "</", element, ">");
  }
  std::string Constraint(int number) {
    return absl::StrCat("<constraint name=\"c", number, "\">", Typed("subject", 0), "<verb>", Word(1),
                        "</verb>", Typed("object", 2), "</constraint>");
  }
  // Over names `prefix`0 … `prefix`(count-1).
  std::string Expression(const std::string& prefix, int count, int depth) {
    if (depth == 0 || Below(4) == 0) return absl::StrCat(prefix, Below(count));
    if (Below(4) == 0) return absl::StrCat("not (", Expression(prefix, count, depth - 1), ")");
    return absl::StrCat("(", Expression(prefix, count, depth - 1), Below(2) == 0 ? " and " : " or ",
                        Expression(prefix, count, depth - 1), ")");
  }
  std::string Rule(int number) {
    const int count = 1 + Below(4);
    std::string constraints;
    for (int i = 0; i < count; ++i) constraints += Constraint(i);
    return absl::StrCat(
        "<rule name=\"r", number, "\"", Below(20) == 0 ? " ext:for=\"2s\"" : "",
        Below(2) == 0 ? absl::StrCat(" expression=\"", Expression("c", count, 1 + Below(6)), "\"") : "", ">",
        constraints, "</rule>");
  }
  std::string Condition() {
    std::string inside;
    const int contexts = 1 + Below(3);
    for (int c = 0; c < contexts; ++c) {
      std::string rules;
      const int count = 1 + Below(3);
      for (int i = 0; i < count; ++i) rules += Rule(i);
      absl::StrAppend(&inside, "<context name=\"x", c, "\" priority=\"", Below(3), "\">", rules,
                      "</context>");
    }
    if (Below(4) == 0) {
      absl::StrAppend(&inside, "<case name=\"x", contexts, "\"",
                      Below(2) == 0 ? " expression=\"bell or not knock\"" : "",
                      "><event operation=\"bell\"/><event operation=\"knock\"/></case>");
    }
    return absl::StrCat(
        "<condition",
        Below(4) == 0 ? absl::StrCat(" expression=\"", Expression("x", contexts, 1 + Below(3)), "\"") : "",
        ">", inside, "</condition>");
  }

  std::mt19937 random_;
};

Limits TightLimits() {
  Limits limits;
  limits.query_text_bytes = 1200;
  limits.query_nesting = 6;
  limits.query_elements = 20;
  return limits;
}

TEST(CheckedWorkflow, WhatTheCheckPassesIsDeployedAndRuns) {
  int passed = 0, refused = 0, late = 0;
  for (uint32_t seed = 0; seed < 1500; ++seed) {
    const std::string text = RandomWorkflow(seed).Text();
    Limits limits = seed % 3 == 0 ? Limits() : TightLimits();
    limits.runs_live = 100;
    const cawl::CheckReport report = cawl::CheckDocument(text, "w", nullptr, limits);
    (report.ok() ? passed : refused) += 1;
    late += !report.ok() && cawl::ParseCawl(text, "w", limits).ok();
    if (!report.ok()) continue;
    Dictionary dictionary;
    sparql::FunctionRegistry functions;
    Stages stages(&dictionary, &functions, limits);
    uint64_t head = 0;
    const auto must = [&](WriteBatch batch) {
      batch.time_us = static_cast<TimeMicros>(1'700'000'000'000'000 + 10'000'000 * head);
      const absl::StatusOr<TurnResult> result = RunTurn(&stages, std::move(batch), ++head);
      if (absl::IsResourceExhausted(result.status())) {
        ASSERT_THAT(std::string(result.status().message()), testing::HasSubstr("the limit runs_live is 100"));
        return;  // a condition of patterns that share no variable starts a run for each pair
      }
      ASSERT_TRUE(result.ok()) << "seed " << seed << ": " << result.status() << "\n" << text;
    };
    must(test::WorldFacts());
    must(test::Put(Document::Kind::kCawl, "w", text));
    must(test::Start("W/F"));
    must(test::Start("W/F", {{"a", test::Iri("John")}, {"b", test::Iri("p")}}));
    must(test::Start("W/F", {{"a", Term::Literal("x\"\\\n")}, {"b", Term::Blank("n")}}));
    must(test::Tell({Fact("John", "docent:isAt", "Hall"), Fact("John", "p", Term::Literal("7")),
                     Fact("urn:w:event", "a", "docent:Event"),
                     Fact("urn:w:event", "docent:operation", Term::Literal("bell"))}));
    WriteBatch tick;
    tick.clock_tick = true;
    must(tick);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(passed, 200) << "of " << passed + refused;
  EXPECT_GT(late, 40) << "refused for what its conditions become";
}

}  // namespace
}  // namespace docent::server
