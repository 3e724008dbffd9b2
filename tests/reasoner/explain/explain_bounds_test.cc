// Searches that would not end, and proofs that are long.
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "tests/reasoner/explain/explain_world.h"

namespace docent {
namespace {

using ::testing::HasSubstr;

constexpr char kCross[] =
    "RULE { ?x :went ?a } WHERE { ?x :go ?y . ?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = -1) }";

class ExplainBoundsTest : public ExplainWorld {
 protected:
  // Its rule goes on for hours once a fact of :go is there.
  void SetUpCross() {
    Rules("cross.rules", kCross);
    std::vector<std::string> facts;
    for (int i = 0; i < 3000; ++i) facts.push_back(absl::StrCat("k", i, " p ", i));
    Tell(facts);
  }
  absl::Status WhyNotOf(const std::string& ask, Cancellation* cancellation) {
    settings_.cancellation = cancellation;
    return Explain()->WhyNot(Parse(ask), 3).status();
  }
  // Facts n0 `p` n1, n1 `p` n2, … as asserted; `inferred`: all others of the closure, as if rules had made them.
  void SetUpChain(int length, bool inferred) {
    std::vector<TermId> nodes;
    for (int i = 0; i <= length; ++i)
      nodes.push_back(dictionary.InternIri(absl::StrCat(std::string(kExampleNs), "n", i)));
    const TermId next = dictionary.InternIri(absl::StrCat(std::string(kExampleNs), "next"));
    const TermId told = dictionary.InternIri(kDefaultGraph), made = dictionary.InternIri(kInferredGraph);
    std::vector<Quad> quads;
    for (int i = 0; i < length; ++i) {
      quads.push_back({nodes[i], next, nodes[i + 1], told});
      for (int j = i + 2; inferred && j <= length; ++j) quads.push_back({nodes[i], next, nodes[j], made});
    }
    writer.AddAll(quads);
  }
  explain::Proof Proof(const std::string& ask) {
    const auto proof = Explain()->WhyAsk(Parse(ask));
    EXPECT_TRUE(proof.ok() && proof->has_value()) << proof.status();
    return proof.ok() && *proof ? **proof : explain::Proof();
  }
  // Each step is told or follows by a rule from steps of smaller depth.
  static void CheckSound(const explain::Proof& proof) {
    for (const explain::ProofStep& step : proof.steps) {
      EXPECT_EQ(step.told.empty(), !step.rule.empty());
      for (const size_t premise : step.premises) EXPECT_LT(proof.steps[premise].depth, step.depth);
    }
  }
};

TEST_F(ExplainBoundsTest, RulesOfAWhyNotEndAtTheStepsOfATurn) {
  SetUpCross();
  settings_.limits.steps_per_turn = 1000000;
  Cancellation cancellation;
  const absl::Status status = WhyNotOf("ASK { :x :go :y . :x :never :y }", &cancellation);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("steps_per_turn"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("cross.rules rule 1"));
}

TEST_F(ExplainBoundsTest, RulesOfAWhyNotEndAtItsTimeAndWithItsClient) {
  SetUpCross();
  settings_.limits.steps_per_turn = uint64_t{1} << 60;
  Cancellation timed(std::chrono::milliseconds(300));
  EXPECT_EQ(WhyNotOf("ASK { :x :go :y . :x :never :y }", &timed).code(), absl::StatusCode::kDeadlineExceeded);
  Cancellation cancelled;
  cancelled.OnLook([&cancelled](const Cancellation&) { cancelled.Cancel(); });
  EXPECT_EQ(WhyNotOf("ASK { :x :go :y . :x :never :y }", &cancelled).code(), absl::StatusCode::kCancelled);
}

TEST_F(ExplainBoundsTest, ASearchThatNothingSatisfiesEndsAtItsTime) {
  BuiltIn("owl2rl");
  Tell({"a q 2", "a q c", "a a A", "c a B", "q owl:inverseOf p"});
  settings_.limits.steps_per_turn = uint64_t{1} << 60;
  Cancellation timed(std::chrono::milliseconds(500));
  settings_.cancellation = &timed;
  auto answer = Explain()->WhyNot(Parse("ASK { :d :p ?y . FILTER(?z > 1) }"), 3);
  if (answer.ok()) {
    EXPECT_FALSE(answer->whole);
  } else {
    EXPECT_EQ(answer.status().code(), absl::StatusCode::kDeadlineExceeded) << answer.status();
  }
}

TEST_F(ExplainBoundsTest, AFactOfALongTransitiveChainIsProven) {
  Rules("next.rules", "RULE { ?x :next ?z } WHERE { ?x :next ?y . ?y :next ?z }");
  SetUpChain(400, true);
  const explain::Proof proof = Proof("ASK { :n0 :next :n400 }");
  CheckSound(proof);
  EXPECT_EQ(proof.steps.size(), 400u + 399u);
  ASSERT_FALSE(proof.roots.empty());
  EXPECT_LT(proof.steps[proof.roots[0]].depth, 60u) << "halves are proven, not all but one";
}

TEST_F(ExplainBoundsTest, AFactFarFromWhatIsToldIsProven) {
  Rules("reach.rules",
        "RULE { :n0 :reached :n0 } WHERE { }\n"
        "RULE { :n0 :reached ?z } WHERE { :n0 :reached ?y . ?y :next ?z }");
  SetUpChain(3000, false);
  Tell({"x y z"});
  const explain::Proof proof = Proof("ASK { :n0 :reached :n3000 }");
  CheckSound(proof);
  EXPECT_EQ(proof.steps[proof.roots[0]].depth, 3001u);
  const std::string text = explain::ToText(proof, {});
  EXPECT_THAT(text, HasSubstr("(level 2000) "));
  EXPECT_LT(text.size(), 4u << 20);
}

TEST_F(ExplainBoundsTest, ALongProofUnderOwlRulesDoesNotGoInCircles) {
  BuiltIn("owl2rl");
  std::vector<std::string> facts = {"p a owl:TransitiveProperty", "p owl:inverseOf q",
                                    "p a owl:SymmetricProperty"};
  for (int i = 0; i < 40; ++i) facts.push_back(absl::StrCat("n", i, " p n", i + 1));
  Tell(facts);
  for (const char* ask : {"ASK { :n0 :p :n40 }", "ASK { :n40 :q :n0 }", "ASK { :n0 :p :n0 }"}) {
    const explain::Proof proof = Proof(ask);
    CheckSound(proof);
    EXPECT_FALSE(proof.steps.empty());
  }
}

}  // namespace
}  // namespace docent
