// The robot that is chosen without the default query is the one that the query chooses.
#include "kb_server/turn/default_robot_choice.h"

#include <random>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "gtest/gtest.h"
#include "kb_server/turn/robot_ranking.h"
#include "kb_server/turn/spatial_functions.h"
#include "tests/kb_server/test_world.h"
#include "workflow/cawl/robot_choice.h"

namespace docent::server {
namespace {

using test::Fact;

class DefaultRobotChoiceTest : public testing::Test {
 protected:
  DefaultRobotChoiceTest() { RegisterSpatialFunctions(&functions_); }

  // A graph of robots of which some say more than others, and what it says of the place Goal.
  void Fill(unsigned seed, bool goal_has_place) {
    std::mt19937 dice(seed);
    const auto one_of = [&dice](int n) { return static_cast<int>(dice() % static_cast<unsigned>(n)); };
    const Term charges[] = {Term::Integer(5),
                            Term::Literal("5.0", std::string(kXsdDecimal)),
                            Term::Literal("1e1", std::string(kXsdDouble)),
                            Term::Literal("NaN", std::string(kXsdDouble)),
                            Term::Literal("full"),
                            test::Iri("Full")};
    std::vector<TermQuad> facts = {Fact("Goal", "a", "Booth")};
    if (goal_has_place) facts.push_back(Fact("Goal", "docent:x", Term::Integer(1)));
    for (int i = 0; i < 12; ++i) {
      const std::string robot = absl::StrCat("R", one_of(20));
      if (one_of(8) != 0) facts.push_back(Fact(robot, "a", "docent:Robot"));
      if (one_of(2) == 0) facts.push_back(Fact(robot, "docent:battery", charges[one_of(6)]));
      if (one_of(3) == 0) facts.push_back(Fact(robot, "docent:load", Term::Integer(one_of(3))));
      if (one_of(2) == 0)
        facts.push_back(Fact(robot, "docent:lastUsed",
                             Term::Literal(absl::StrCat("2026-01-0", 1 + one_of(3), "T00:00:00Z"),
                                           std::string(kXsdDateTime))));
      if (one_of(2) == 0) facts.push_back(Fact(robot, "docent:x", Term::Integer(one_of(9))));
    }
    for (const TermQuad& fact : facts) {
      Add(fact, "a-source");
      if (one_of(4) == 0) Add(fact, "another-source");
    }
  }
  void Add(const TermQuad& fact, const char* graph) {
    writer_.Add({dictionary_.Intern(fact.subject), dictionary_.Intern(fact.predicate),
                 dictionary_.Intern(fact.object), dictionary_.Intern(test::Iri(graph))});
  }

  static std::vector<Quad> All(const GraphVersion& version) {
    std::vector<Quad> quads;
    version.ForEach({}, [&quads](const Quad& quad) {
      quads.push_back(quad);
      return true;
    });
    return quads;
  }

  std::vector<RobotId> Robots() const {
    std::vector<RobotId> robots;
    for (int i = 0; i < 20; ++i) robots.push_back(RobotId(test::Name(absl::StrCat("R", i))));
    std::sort(robots.begin(), robots.end());
    return robots;
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  GraphWriter writer_{nullptr};
};

// The robots that are able are others each time, so that each robot is compared with each.
TEST_F(DefaultRobotChoiceTest, IsThatOfTheQueryOnRandomGraphs) {
  DefaultRobotChoice choice(&dictionary_);
  GraphRobotRanking ranking(&dictionary_, &functions_, Limits());
  int direct = 0;
  std::vector<Quad> before;
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 dice(seed);
    Fill(seed, false);
    const GraphVersionPtr version = writer_.Freeze(Revision(seed + 1));
    Delta delta;
    delta.added = All(*version);
    delta.removed = before;
    choice.Refresh(delta);
    ranking.BeginRound(*version, {&delta}, 0, nullptr);
    std::vector<RobotId> able = Robots();
    while (!able.empty()) {
      const RobotId by_query =
          ranking.BestByQuery(std::string(cawl::DefaultRobotChoice()), able, {{"goal", test::Iri("Goal")}});
      if (const auto best = choice.Best(*version, dictionary_.Find(test::Iri("Goal")), able)) {
        ++direct;
        ASSERT_EQ(best->value(), by_query.value());
      }
      able.erase(dice() % 3 == 0 ? able.begin() : std::find(able.begin(), able.end(), by_query));
    }
    before = All(*version);
    writer_.RemoveAll(before);
  }
  EXPECT_GT(direct, 5000) << "those without several values of one property";
}

TEST_F(DefaultRobotChoiceTest, WhatChangesIsReadAgain) {
  DefaultRobotChoice choice(&dictionary_);
  auto turn = [&, revision = 0](const TermQuad& fact, bool add) mutable {
    const Quad quad{dictionary_.Intern(fact.subject), dictionary_.Intern(fact.predicate),
                    dictionary_.Intern(fact.object), dictionary_.Intern(test::Iri("a-source"))};
    const Delta delta = add ? writer_.Apply({quad}, {}) : writer_.Apply({}, {quad});
    choice.Refresh(delta);
    const GraphVersionPtr version = writer_.Freeze(Revision(++revision));
    const std::vector<RobotId> able = {RobotId(test::Name("R1")), RobotId(test::Name("R2"))};
    return choice.Best(*version, std::nullopt, able)->value();
  };
  turn(Fact("R1", "a", "docent:Robot"), true);
  EXPECT_EQ(turn(Fact("R2", "a", "docent:Robot"), true), test::Name("R1"));
  EXPECT_EQ(turn(Fact("R1", "docent:load", Term::Integer(1)), true), test::Name("R2"));
  EXPECT_EQ(turn(Fact("R1", "docent:battery", Term::Integer(5)), true), test::Name("R1"));
  EXPECT_EQ(turn(Fact("R2", "docent:battery", Term::Integer(6)), true), test::Name("R2"));
  EXPECT_EQ(turn(Fact("R2", "docent:battery", Term::Integer(6)), false), test::Name("R1"));
  EXPECT_EQ(turn(Fact("R1", "a", "docent:Robot"), false), test::Name("R2"));
}

TEST_F(DefaultRobotChoiceTest, AGoalThatHasAPlaceIsForTheQuery) {
  DefaultRobotChoice choice(&dictionary_);
  Fill(1, true);
  const GraphVersionPtr version = writer_.Freeze(Revision(1));
  EXPECT_FALSE(choice.Best(*version, dictionary_.Find(test::Iri("Goal")), Robots()));
  EXPECT_TRUE(choice.Best(*version, dictionary_.Find(test::Iri("Booth")), {Robots()[0]}));
}

}  // namespace
}  // namespace docent::server
