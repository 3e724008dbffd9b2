#include "kb_server/turn/spatial_functions.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Tell;

Term Decimal(const std::string& text) {
  return Term::Literal(text, std::string(kXsdDecimal));
}

class SpatialFunctionsTest : public ::testing::Test {
 protected:
  SpatialFunctionsTest() { RegisterSpatialFunctions(&functions_); }

  absl::StatusOr<Term> Call(const std::string& name, const std::vector<Term>& arguments) {
    return functions_.Find(DocentIri(name))->call(arguments);
  }
  TurnResult Must(WriteBatch batch) {
    batch.time_us = 1000 * static_cast<TimeMicros>(++head_);
    absl::StatusOr<TurnResult> result = RunTurn(&stages_, std::move(batch), head_);
    EXPECT_TRUE(result.ok()) << result.status();
    return result.ok() ? *std::move(result) : TurnResult();
  }
  bool Has(const TermQuad& triple) const {
    const auto s = dictionary_.Find(triple.subject), p = dictionary_.Find(triple.predicate),
               o = dictionary_.Find(triple.object);
    return s && p && o && stages_.writer.current().Count({*s, *p, *o, {}}) > 0;
  }
  void MoveTo(const std::string& x, const std::string& y) {
    Must(Tell({Fact("R1", "docent:x", Decimal(x)), Fact("R1", "docent:y", Decimal(y))}));
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  Stages stages_{&dictionary_, &functions_, Limits()};
  uint64_t head_ = 0;
};

TEST_F(SpatialFunctionsTest, DistanceIsMetresToTheMillimetre) {
  EXPECT_EQ(*Call("distance", {Decimal("0"), Decimal("0"), Decimal("3"), Decimal("4.0")}), Decimal("5.000"));
  EXPECT_EQ(*Call("distance", {Decimal("1.5"), Decimal("-2"), Decimal("1.5"), Decimal("-2")}),
            Decimal("0.000"));
  EXPECT_FALSE(Call("distance", {Decimal("0"), Term::Literal("0"), Decimal("3"), Decimal("4")}).ok());
  EXPECT_FALSE(Call("distance", {Decimal("0"), test::Iri("a"), Decimal("3"), Decimal("4")}).ok());
}

TEST_F(SpatialFunctionsTest, RouteLengthIsMetresAlongTheRoadmap) {
  const Term roadmap = Term::Literal("0 0 4 0; 4 0 4 3");
  EXPECT_EQ(*Call("routeLength", {Term::Literal("0 0"), Term::Literal("POINT(4 3)"), roadmap}),
            Decimal("7.000"));
  EXPECT_EQ(*Call("routeLength", {Term::Literal("0 0"), Term::Literal("POINT(4 3)"), Term::Literal("")}),
            Decimal("5.000"));
  EXPECT_FALSE(Call("routeLength", {Term::Literal("4 3"), Term::Literal("0 0"), roadmap}).ok())
      << "against the ways";
  EXPECT_FALSE(Call("routeLength", {Term::Literal("0"), Term::Literal("0 0"), roadmap}).ok());
  EXPECT_FALSE(Call("routeLength", {test::Iri("a"), Term::Literal("0 0"), roadmap}).ok());
  EXPECT_FALSE(
      Call("routeLength", {Term::Literal("0 0"), Term::Literal("4 3"), Term::Literal("0 0 4")}).ok());
}

TEST_F(SpatialFunctionsTest, InRegionReadsTheOutline) {
  const Term square = Term::Literal("POLYGON((0 0, 4 0, 4 4, 0 4, 0 0))");
  const Term yes = Term::Literal("true", std::string(kXsdBoolean));
  const Term no = Term::Literal("false", std::string(kXsdBoolean));
  EXPECT_EQ(*Call("inRegion", {Decimal("1"), Decimal("3.999"), square}), yes);
  EXPECT_EQ(*Call("inRegion", {Decimal("4.001"), Decimal("3"), square}), no);
  EXPECT_FALSE(Call("inRegion", {Decimal("1"), Decimal("1"), Term::Literal("POLYGON((0 0, 4 0))")}).ok());
  EXPECT_FALSE(Call("inRegion", {Decimal("1"), Decimal("1"), test::Iri("a")}).ok());
}

TEST_F(SpatialFunctionsTest, RulesFollowPositions) {
  Must(Tell({Fact("docent:x", "a", "docent:StateProperty"), Fact("docent:y", "a", "docent:StateProperty"),
             Fact("B1", "docent:outline", Term::Literal("POLYGON((0 0, 4 0, 4 4, 0 4, 0 0))")),
             Fact("Desk", "docent:deskX", Decimal("10")), Fact("Desk", "docent:deskY", Decimal("0"))}));
  Must(test::Put(Document::Kind::kRules, "near.rules", R"(PREFIX docent: <https://w3id.org/docent#>
RULE { ?r docent:isAt ?b } WHERE {
  ?r docent:x ?x ; docent:y ?y . ?b docent:outline ?o . FILTER(docent:inRegion(?x, ?y, ?o))
}
RULE { ?r docent:isNear ?d } WHERE {
  ?r docent:x ?x ; docent:y ?y . ?d docent:deskX ?dx ; docent:deskY ?dy . FILTER(docent:distance(?x, ?y, ?dx, ?dy) < 2.5)
})"));
  MoveTo("1.000", "1.000");
  EXPECT_TRUE(Has(Fact("R1", "docent:isAt", "B1")));
  EXPECT_FALSE(Has(Fact("R1", "docent:isNear", "Desk")));
  MoveTo("8.000", "1.000");
  EXPECT_FALSE(Has(Fact("R1", "docent:isAt", "B1")));
  EXPECT_TRUE(Has(Fact("R1", "docent:isNear", "Desk")));
}

TEST_F(SpatialFunctionsTest, ConditionsFollowPositions) {
  engine::ConditionRequest request;
  request.handle = 1;
  request.ask =
      "PREFIX docent: <https://w3id.org/docent#> ASK { ?r docent:x ?x ; docent:y ?y "
      "FILTER(docent:inRegion(?x, ?y, \"POLYGON((0 0, 4 0, 4 4, 0 4, 0 0))\") && docent:distance(?x, ?y, 0, "
      "0) > 1) }";
  Must(Tell({Fact("docent:x", "a", "docent:StateProperty"), Fact("docent:y", "a", "docent:StateProperty")}));
  ASSERT_TRUE(stages_.conditions.Arm({request}, stages_.writer.current(), 0).ok());
  stages_.Commit();
  EXPECT_FALSE(stages_.conditions.Holds(1));
  MoveTo("2.000", "3.000");
  EXPECT_TRUE(stages_.conditions.Holds(1));
  MoveTo("0.500", "0.500");
  EXPECT_FALSE(stages_.conditions.Holds(1)) << "in the region, but nearer than 1 m";
  MoveTo("5.000", "0.500");
  EXPECT_FALSE(stages_.conditions.Holds(1));
}

}  // namespace
}  // namespace docent::server
