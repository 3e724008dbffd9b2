#include "reasoner/matching/body.h"
#include "graph/base/step_costs.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/reasoner/test_world.h"

namespace docent::matching {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class BodyTest : public ::testing::Test {
 protected:
  std::unique_ptr<Body> Compile(const std::string& ask) {
    auto body = Body::Compile(world_.Parse(ask), world_.dictionary, nullptr);
    EXPECT_TRUE(body.ok()) << body.status();
    return body.ok() ? *std::move(body) : nullptr;
  }
  // Rows as "x=a y=b", sorted; `seed` as {"x", "a"} pairs.
  std::vector<std::string> Rows(Body& body,
                                const std::vector<std::pair<std::string, std::string>>& seed = {}) {
    std::vector<TermId> ids(body.columns().size());
    for (const auto& [name, word] : seed) ids[static_cast<size_t>(body.ColumnOf(name))] = world_.Id(word);
    std::vector<std::string> rows;
    const absl::Status status =
        body.Evaluate({.version = &world_.writer.current()}, ids, [&](absl::Span<const TermId> row) {
          rows.push_back(TextOf(body, row));
          return true;
        });
    EXPECT_TRUE(status.ok()) << status;
    std::sort(rows.begin(), rows.end());
    return rows;
  }
  // The solutions that `quad` gives through the trigger with this number, which it matches: by EvaluateFrom,
  // sorted.
  std::vector<std::string> RowsFrom(Body& body, size_t trigger, const std::string& quad, bool all = true) {
    std::vector<TermId> seed;
    body.SeedFrom(body.triggers()[trigger], world_.QuadOf(quad), seed);
    std::vector<std::string> rows;
    const absl::Status status =
        body.EvaluateFrom(body.triggers()[trigger], {.version = &world_.writer.current()}, seed,
                          [&](absl::Span<const TermId> row) {
                            rows.push_back(TextOf(body, row));
                            return all;
                          });
    EXPECT_TRUE(status.ok()) << status;
    std::sort(rows.begin(), rows.end());
    return rows;
  }
  std::string TextOf(const Body& body, absl::Span<const TermId> row) {
    std::string text;
    for (size_t i = 0; i < row.size(); ++i) {
      if (!body.columns()[i].visible || row[i].IsNone()) continue;
      text += (text.empty() ? "" : " ") + body.columns()[i].name + "=" + world_.Text(row[i]);
    }
    return text;
  }
  TestWorld world_;
};

TEST_F(BodyTest, JoinsPatternsInAnyOrder) {
  world_.Apply({"r at b1", "s at b2", "b1 in hall", "b2 in yard", "hall a Hall"});
  const auto body = Compile("ASK { ?x :at ?b . ?b :in ?h . ?h a :Hall }");
  EXPECT_THAT(Rows(*body), ElementsAre("x=r b=b1 h=hall"));
  EXPECT_THAT(Rows(*body, {{"x", "s"}}), IsEmpty());
  EXPECT_THAT(Rows(*body, {{"b", "b1"}}), ElementsAre("x=r b=b1 h=hall"));
}

TEST_F(BodyTest, ATripleInTwoGraphsIsOneMatch) {
  world_.Apply({"r at b1", "r at b1 @other"});
  EXPECT_THAT(Rows(*Compile("ASK { ?x :at ?b }")), ElementsAre("x=r b=b1"));
  EXPECT_THAT(Rows(*Compile("ASK { :r :at :b1 }")), ElementsAre(""));
}

TEST_F(BodyTest, ARepeatedVariableHasOneValue) {
  world_.Apply({"x knows y", "z knows z"});
  EXPECT_THAT(Rows(*Compile("ASK { ?x :knows ?x }")), ElementsAre("x=z"));
}

TEST_F(BodyTest, NumbersAreComparedByValueAlsoWhereIdsCannotTell) {
  world_.Apply({"a n 5", "b n 5.0", "c n 4.999", "d n 'five"});
  EXPECT_THAT(Rows(*Compile("ASK { ?x :n ?v FILTER(?v >= 5) }")), ElementsAre("x=a v=5", "x=b v=5.0"));
  EXPECT_THAT(Rows(*Compile("ASK { ?x :n ?v FILTER(5 > ?v) }")), ElementsAre("x=c v=4.999"));
  EXPECT_THAT(Rows(*Compile("ASK { ?x :n ?v . ?y :n ?w FILTER(?v < ?w) }")),
              ElementsAre("x=c v=4.999 y=a w=5", "x=c v=4.999 y=b w=5.0"));
}

TEST_F(BodyTest, AFilterOfAnInnerGroupSeesOnlyThatGroup) {
  world_.Apply({"a n 1", "b n 2"});
  EXPECT_THAT(Rows(*Compile("ASK { ?x :n ?v { ?y :n ?w FILTER(?w > ?v) } }")), IsEmpty())
      << "?v is unbound in there";
  EXPECT_THAT(Rows(*Compile("ASK { ?x :n ?v { ?y :n ?w } FILTER(?w > ?v) }")),
              ElementsAre("x=a v=1 y=b w=2"));
}

TEST_F(BodyTest, ComputedValuesAreInterned) {
  world_.Apply({"a n 1"});
  EXPECT_THAT(Rows(*Compile("ASK { ?x :n ?v BIND(CONCAT(\"n\", STR(?v)) AS ?t) }")),
              ElementsAre("x=a v=1 t='n1"));
}

TEST_F(BodyTest, ConstantsThatNobodyHasSaidYetAreFoundLater) {
  const auto flat = Compile("ASK { :new :at ?b }");
  const auto general = Compile("ASK { { :new2 :at ?b } UNION { ?b :never :new3 } }");
  world_.Apply({"new at b1", "new2 at b2"});
  EXPECT_THAT(Rows(*flat), ElementsAre("b=b1"));
  EXPECT_THAT(Rows(*general), ElementsAre("b=b2"));
}

// Results cached by an EXISTS in one run must not be used in the next, on a changed graph.
TEST_F(BodyTest, EveryEvaluationReadsTheGraphAsItIs) {
  const std::string inside = "{ SELECT ?x (COUNT(?y) AS ?n) { ?x :p ?y } GROUP BY ?x } ?z :p ?x";
  const auto flat = Compile("ASK { ?y :q :b FILTER NOT EXISTS { " + inside + " } }");
  const auto general =
      Compile("ASK { { ?y :q :b } UNION { ?y :q :c } FILTER NOT EXISTS { " + inside + " } }");
  world_.Apply({"a q b", "n p n"});
  EXPECT_THAT(Rows(*flat), IsEmpty());
  EXPECT_THAT(Rows(*general), IsEmpty());
  world_.Apply({"m p n"}, {"n p n"});
  EXPECT_THAT(Rows(*flat), ElementsAre("y=a"));
  EXPECT_THAT(Rows(*general), ElementsAre("y=a"));
}

// The rest of the query is nothing, one lookup, one scan, or a join.
TEST_F(BodyTest, ASolutionFromAQuadHasWhatIsLeftOfTheQuery) {
  world_.Apply({"r at b1", "r at b1 @other", "s at b2", "b1 in hall", "b1 in yard", "b1 in yard @other",
                "b2 in b2", "r likes r"});
  EXPECT_THAT(RowsFrom(*Compile("ASK { ?x :at ?b }"), 0, "r at b1"), ElementsAre("x=r b=b1"));
  const auto lookup = Compile("ASK { ?x :at ?b . ?b :in :hall }");
  EXPECT_THAT(RowsFrom(*lookup, 0, "r at b1"), ElementsAre("x=r b=b1"));
  EXPECT_THAT(RowsFrom(*lookup, 0, "s at b2"), IsEmpty());
  EXPECT_THAT(RowsFrom(*lookup, 1, "b1 in hall"), ElementsAre("x=r b=b1")) << "its other pattern is open";
  const auto scan = Compile("ASK { ?x :at ?b . ?b :in ?where }");
  EXPECT_THAT(RowsFrom(*scan, 0, "r at b1"), ElementsAre("x=r b=b1 where=hall", "x=r b=b1 where=yard"));
  EXPECT_EQ(RowsFrom(*scan, 0, "r at b1", /*all=*/false).size(), 1u);
  EXPECT_THAT(RowsFrom(*scan, 1, "b1 in yard"), ElementsAre("x=r b=b1 where=yard"));
  EXPECT_THAT(RowsFrom(*Compile("ASK { ?x :at ?b . ?y :in ?y }"), 0, "s at b2"),
              ElementsAre("x=s b=b2 y=b2"));
  EXPECT_THAT(RowsFrom(*Compile("ASK { ?x :at ?b . ?x ?p ?y }"), 0, "s at b2").size(), 1u);
  EXPECT_THAT(RowsFrom(*Compile("ASK { ?x :likes ?x . ?x :at ?b }"), 0, "r likes r"),
              ElementsAre("x=r b=b1"));
}

TEST_F(BodyTest, AScanForWhatIsLeftCountsItsSteps) {
  for (int i = 0; i < 100; ++i) world_.Apply({"b in h" + std::to_string(i)});
  world_.Apply({"r at b"});
  const auto body = Compile("ASK { ?x :at ?b . ?b :in ?where }");
  Cancellation cancellation;
  cancellation.AllowSteps(50 + kStepsOfLookup);
  std::vector<TermId> seed;
  body->SeedFrom(body->triggers()[0], world_.QuadOf("r at b"), seed);
  int rows = 0;
  const absl::Status status = body->EvaluateFrom(
      body->triggers()[0], {.version = &world_.writer.current(), .cancellation = &cancellation}, seed,
      [&](absl::Span<const TermId>) { return ++rows < 1000; });
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_EQ(rows, 50);
}

// An EXISTS that the seed decides is looked up before the join (among the first 64 filters); the others when
// a row is complete.
TEST_F(BodyTest, EveryExistsDecidesHoweverManyThereAre) {
  std::string text = "ASK { ?x :at ?b ";
  for (int i = 0; i < 70; ++i) text += "FILTER NOT EXISTS { ?x :lacks" + std::to_string(i) + " ?z } ";
  const auto body = Compile(text + "}");
  world_.Apply({"r at b", "s at b"});
  EXPECT_THAT(Rows(*body), ElementsAre("x=r b=b", "x=s b=b"));
  for (const int decisive : {0, 63, 64, 69}) {
    const std::string fact = "r lacks" + std::to_string(decisive) + " it";
    world_.Apply({fact});
    EXPECT_THAT(Rows(*body), ElementsAre("x=s b=b")) << fact;
    EXPECT_THAT(Rows(*body, {{"x", "r"}}), IsEmpty()) << fact;
    EXPECT_THAT(Rows(*body, {{"x", "s"}}), ElementsAre("x=s b=b")) << fact;
    world_.Apply({}, {fact});
  }
}

TEST_F(BodyTest, OfFiltersThoseAreAskedThatTheRowBinds) {
  world_.Apply({"r a Robot", "r banned yes", "s a Robot", "b in hall"});
  const auto body = Compile(
      "ASK { ?x a :Robot . ?x :at ?b FILTER NOT EXISTS { ?x :banned :yes } "
      "FILTER EXISTS { ?b :in :yard } }");
  const size_t x = static_cast<size_t>(body->ColumnOf("x")), b = static_cast<size_t>(body->ColumnOf("b"));
  const auto solutions = [&](const std::string& robot, const std::string& booth, Body::Filters filters) {
    std::vector<TermId> seed(body->columns().size());
    seed[x] = world_.Id(robot);
    if (!booth.empty()) seed[b] = world_.Id(booth);
    int count = 0;
    EXPECT_TRUE(body->EvaluateRest({.version = &world_.writer.current()}, seed, 0b10, filters,
                                   [&](auto) { return ++count; })
                    .ok());
    return count;
  };
  EXPECT_EQ(solutions("r", "", Body::Filters::kNone), 1);
  EXPECT_EQ(solutions("r", "", Body::Filters::kBound), 0);
  EXPECT_EQ(solutions("s", "", Body::Filters::kBound), 1)
      << "where the booth is open, nothing is asked of it";
  EXPECT_EQ(solutions("s", "b", Body::Filters::kBound), 0) << "it is in the hall";
  world_.Apply({"b in yard"});
  EXPECT_EQ(solutions("s", "b", Body::Filters::kBound), 1);
}

TEST_F(BodyTest, GuardsComeFromFiltersOnThePatternsObject) {
  const auto body = Compile("ASK { ?x :n ?v . ?x a :T FILTER(0.5 < ?v) }");
  ASSERT_EQ(body->triggers().size(), 2u);
  ASSERT_TRUE(body->triggers()[0].match.object_guard.has_value());
  EXPECT_EQ(body->triggers()[0].match.object_guard->op, Comparison::kGreater);
  EXPECT_EQ(body->triggers()[0].match.object_guard->bound, 0.5);
  EXPECT_FALSE(body->triggers()[1].match.object_guard.has_value());
}

}  // namespace
}  // namespace docent::matching
