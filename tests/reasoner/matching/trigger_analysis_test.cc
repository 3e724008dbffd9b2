#include "reasoner/matching/trigger_analysis.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reasoner/test_world.h"

namespace docent::matching {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

// "+p{x,y}!": predicate p, positive, seeds x and y, required.
std::vector<std::string> Describe(const std::string& ask) {
  const TestWorld world;
  const sparql::Query query = world.Parse(ask);
  const TriggerAnalysis analysis = AnalyseTriggers(WithoutModifiers(*query.algebra));
  std::vector<std::string> texts;
  for (const TriggerSource& t : analysis.triggers) {
    std::string text = t.polarity == Polarity::kPositive   ? "+"
                       : t.polarity == Polarity::kNegative ? "-"
                                                           : "*";
    text +=
        t.pattern.predicate.IsVariable() ? "?" : t.pattern.predicate.term().lexical.substr(kExampleNs.size());
    std::vector<std::string> seeds = t.seeds;
    std::sort(seeds.begin(), seeds.end());
    text += "{";
    for (const std::string& seed : seeds) text += (text.back() == '{' ? "" : ",") + seed;
    text += t.required ? "}!" : "}";
    texts.push_back(text);
  }
  return texts;
}

TEST(TriggerAnalysis, AConjunctionIsPositiveAndRequired) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y . ?y :q :c FILTER(?y != :d) }"), ElementsAre("+p{x,y}!", "+q{y}!"));
}

TEST(TriggerAnalysis, NotExistsIsNegativeAndSharesWhatIsBoundOutside) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y FILTER NOT EXISTS { ?x :q ?z } }"), ElementsAre("+p{x,y}!", "-q{x}"));
}

TEST(TriggerAnalysis, NestedNegationFlipsTwice) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y FILTER NOT EXISTS { ?x :q ?z FILTER NOT EXISTS { ?z :r ?x } } }"),
              ElementsAre("+p{x,y}!", "-q{x}", "+r{x}"));
}

TEST(TriggerAnalysis, ExistsIsPositiveWithoutBeingRequired) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y FILTER EXISTS { ?x :q ?z } }"), ElementsAre("+p{x,y}!", "+q{x}"));
}

TEST(TriggerAnalysis, ExistsInsideAnExpressionCountsBothWays) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y FILTER(EXISTS { ?x :q ?z } = (?y > 3)) }"),
              ElementsAre("+p{x,y}!", "*q{x}"));
}

TEST(TriggerAnalysis, OptionalCountsBothWaysAndMinusIsNegative) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y OPTIONAL { ?x :q ?z } }"), ElementsAre("+p{x,y}!", "*q{x}"));
  EXPECT_THAT(Describe("ASK { ?x :p ?y MINUS { ?x :q ?z } }"), ElementsAre("+p{x,y}!", "-q{x}"));
}

TEST(TriggerAnalysis, BranchesOfAUnionAreNotRequired) {
  EXPECT_THAT(Describe("ASK { { ?x :p ?y } UNION { ?x :q ?z } }"), ElementsAre("+p{x,y}", "+q{x,z}"));
}

TEST(TriggerAnalysis, AGroupOfASubSelectMayBeBoundFromOutsideItsRowsAndPathsNot) {
  EXPECT_THAT(Describe("ASK { ?x :p ?y { SELECT ?x (COUNT(*) AS ?n) { ?x :q ?z } GROUP BY ?x } }"),
              UnorderedElementsAre("+p{x,y}!", "*q{x}"));
  EXPECT_THAT(Describe("ASK { ?x :p+ ?y }"), ElementsAre("+p{}"));
  EXPECT_THAT(Describe("ASK { ?x :p* ?y }"), ElementsAre("+?{}"));
}

TEST(TriggerAnalysis, AVariableThatAnInnerGroupDoesNotBindIsNotSeeded) {
  // ?x is not visible in the inner group's filter: binding it from outside would change its meaning.
  EXPECT_THAT(Describe("ASK { ?x :p ?y { ?z :q ?w FILTER NOT EXISTS { ?w :r ?x } } }"),
              UnorderedElementsAre("+p{y}!", "+q{w,z}!", "-r{w}"));
}

TEST(TriggerAnalysis, KnowsWhatDependsOnTheClock) {
  const TestWorld world;
  EXPECT_TRUE(AnalyseTriggers(*world.Parse("ASK { ?x :p ?t FILTER(?t < NOW()) }").algebra).is_volatile);
  EXPECT_FALSE(AnalyseTriggers(*world.Parse("ASK { ?x :p ?t FILTER(?t < 5) }").algebra).is_volatile);
}

}  // namespace
}  // namespace docent::matching
