// Known errors of other reasoners: facts that support only each other stay, or facts with other
// support are removed. Here thousands of facts are asserted and withdrawn one after the other under
// the whole of `owl2rl`. A fact asserted and withdrawn must leave the former graph, quad by quad; and
// from time to time all inferred facts are compared with a computation from scratch and with the naive
// one.

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/property/naive_rules.h"
#include "tests/reasoner/test_world.h"

namespace docent {
namespace {

using Facts = std::vector<std::string>;

// Facts that are always asserted, and facts that come and go.
struct Theme {
  std::string name;
  Facts always;
  Facts pool;
};
void PrintTo(const Theme& theme, std::ostream* out) {
  *out << theme.name;
}

std::string Node(int i) {
  return absl::StrCat("n", i % 6);
}

void Append(const Theme& from, Theme& to) {
  to.always.insert(to.always.end(), from.always.begin(), from.always.end());
  to.pool.insert(to.pool.end(), from.pool.begin(), from.pool.end());
}

// memberOf and member imply each other, and both are made by others; the axioms come and go, too.
Theme InverseProperties() {
  Theme theme{
      "InverseProperties",
      {"headOf rdfs:subPropertyOf worksFor", "memberOf rdfs:domain Person", "memberOf rdfs:range Group",
       "degreeFrom owl:inverseOf hasAlumnus", "hasAlumnus rdfs:range Person", "headOf rdfs:domain Chair"},
      {"worksFor rdfs:subPropertyOf memberOf", "memberOf owl:inverseOf member",
       "member owl:inverseOf memberOf"}};
  for (int i = 0; i < 6; ++i) {
    for (const char* property : {"memberOf", "headOf", "degreeFrom", "hasAlumnus"})
      theme.pool.push_back(absl::StrCat(Node(i), " ", property, " ", Node(i * 2 + 1)));
    theme.pool.push_back(absl::StrCat(Node(i * 2 + 1), " member ", Node(i)));
  }
  return theme;
}

// One type for many reasons: asserted, asserted twice, by a domain, by a range, by several superclasses.
Theme SharedSupport() {
  Theme theme{
      "SharedSupport",
      {"advises rdfs:domain Professor", "advises rdfs:range Student", "Chair rdfs:subClassOf Professor",
       "Student rdfs:subClassOf Person", "Human owl:equivalentClass Person"},
      {"Professor rdfs:subClassOf Person", "teaches rdfs:domain Professor", "Person rdfs:subClassOf Agent",
       "Professor rdfs:subClassOf Agent"}};
  for (int i = 0; i < 6; ++i) {
    for (const char* type : {"Chair", "Professor", "Student", "Human", "Person @g1"})
      theme.pool.push_back(absl::StrCat(Node(i), " a ", type));
    theme.pool.push_back(absl::StrCat(Node(i), " advises ", Node(i + 1)));
    theme.pool.push_back(absl::StrCat(Node(i), " advises ", Node(i + 3), " @g1"));
    theme.pool.push_back(absl::StrCat(Node(i), " teaches ", Node(i + 2)));
  }
  return theme;
}

// A chain of equal things with facts at its ends; some are equal because they share a badge or a place.
Theme EqualThings() {
  Theme theme{
      "EqualThings",
      {"badge a owl:InverseFunctionalProperty", "likes rdfs:range Liked", "home a owl:FunctionalProperty"},
      {"e0 likes x", "y likes e4", "e2 a Thing", "z likes e0 @g1", "e4 badge 9"}};
  for (int i = 0; i < 4; ++i) {
    theme.pool.push_back(absl::StrCat("e", i, " owl:sameAs e", i + 1));
    theme.pool.push_back(absl::StrCat("e", i, " badge ", i / 2));
    theme.pool.push_back(absl::StrCat("e", i, " badge ", (i + 1) / 2));
    theme.pool.push_back(absl::StrCat("w home e", i));
  }
  return theme;
}

// Literals, properties and classes that are equal to things, equality itself by another name, and larger
// classes that are asserted and derived in several ways at once.
Theme EqualInEveryPlace() {
  Theme theme{
      "EqualInEveryPlace",
      {"badge a owl:InverseFunctionalProperty", "code a owl:FunctionalProperty", "e0 likes x",
       "z likes e3 @g1", "e5 differs e2"},
      {"e1 owl:sameAs 5", "e3 owl:sameAs 5", "e1 code 7", "e1 code e4", "e6 code e2",
       "likes owl:sameAs loves", "loves owl:sameAs e6", "loves rdfs:domain Lover", "Lover owl:sameAs Fan",
       "e2 a Lover", "same rdfs:subPropertyOf owl:sameAs", "owl:sameAs owl:sameAs equal",
       "equal a owl:SymmetricProperty", "e3 loves e3", "e4 likes 5", "y likes 5", "e0 a Fan @g1"}};
  for (int i = 0; i < 7; ++i) {
    theme.pool.push_back(absl::StrCat("e", i, " owl:sameAs e", (i * 3 + 1) % 7));
    theme.pool.push_back(absl::StrCat("e", i, " badge ", i % 3));
    theme.pool.push_back(absl::StrCat("e", i, i % 2 == 0 ? " same e" : " equal e", (i + 2) % 7));
    theme.pool.push_back(absl::StrCat("e", i, " likes e", (i * 2) % 7));
  }
  return theme;
}

// Cycles of a transitive property and of a transitive and symmetric one, cut and closed again.
Theme TransitiveCycles() {
  Theme theme{
      "TransitiveCycles",
      {"nextTo a owl:SymmetricProperty", "nextTo a owl:TransitiveProperty", "twin rdfs:subPropertyOf nextTo",
       "partOf rdfs:range Whole"},
      {"partOf a owl:TransitiveProperty", "inside rdfs:subPropertyOf partOf", "partOf owl:inverseOf has"}};
  for (int i = 0; i < 6; ++i) {
    theme.pool.push_back(absl::StrCat(Node(i), " partOf ", Node(i + 1)));
    theme.pool.push_back(absl::StrCat(Node(i), " inside ", Node(i + 2)));
    theme.pool.push_back(absl::StrCat(Node(i + 1), " has ", Node(i)));
    if (i < 3) theme.pool.push_back(absl::StrCat("m", i, " nextTo m", i + 1));
    if (i < 3) theme.pool.push_back(absl::StrCat("m", i + 1, " twin m", (i + 2) % 4));
  }
  return theme;
}

Theme AllTogether() {
  Theme theme{
      "AllTogether",
      {"uncle owl:propertyChainAxiom c0", "c0 rdf:first advises", "c0 rdf:rest c1", "c1 rdf:first nextTo",
       "c1 rdf:rest rdf:nil", "Busy owl:onProperty teaches", "Busy owl:someValuesFrom Person"},
      {"n0 owl:sameAs m0", "n1 owl:sameAs e0", "n2 nextTo m1", "memberOf owl:sameAs worksFor",
       "Chair owl:disjointWith Student"}};
  for (const Theme& other : {InverseProperties(), SharedSupport(), EqualThings(), TransitiveCycles()})
    Append(other, theme);
  return theme;
}

// A graph under owl2rl, with its asserted facts.
class Reasoner {
 public:
  explicit Reasoner(const Facts& told) {
    // The order of ids is the order in which changes are processed.
    for (int i = 5; i >= 0; --i) world_.Id(Node(i));
    EXPECT_TRUE(engine_.PutRules("owl2rl", rules::BuiltInRuleSet("owl2rl")).empty());
    Tell(told, {});
  }
  void Tell(const Facts& add, const Facts& remove) {
    const absl::StatusOr<Delta> delta = engine_.Update(world_.writer, world_.Apply(add, remove));
    ASSERT_TRUE(delta.ok()) << delta.status();
    engine_.Commit();
    world_.writer.Freeze(Revision(++revision_));
    for (const std::string& fact : add) told_.insert(fact);
    for (const std::string& fact : remove) told_.erase(fact);
  }
  std::vector<Quad> Quads() const {
    std::vector<Quad> quads;
    quads.reserve(world_.writer.current().size());
    world_.writer.current().ForEach({}, [&](const Quad& quad) {
      quads.push_back(quad);
      return true;
    });
    return quads;
  }
  // Sorted.
  Facts Texts(const std::vector<Quad>& quads) const {
    Facts texts;
    for (const Quad& q : quads) {
      texts.push_back(absl::StrCat(world_.Text(q.subject), " ", world_.Text(q.predicate), " ",
                                   world_.Text(q.object), " ", world_.Text(q.graph)));
    }
    std::sort(texts.begin(), texts.end());
    return texts;
  }
  Facts Inferred() const { return world_.Inferred(); }
  const std::set<std::string>& told() const { return told_; }

 private:
  TestWorld world_;
  rules::RuleEngine engine_{world_.dictionary};
  std::set<std::string> told_;
  uint64_t revision_ = 0;
};

std::string Difference(const Facts& got, const Facts& expected) {
  Facts lines;
  for (const std::string& fact : got) {
    if (!std::binary_search(expected.begin(), expected.end(), fact)) lines.push_back("too much: " + fact);
  }
  for (const std::string& fact : expected) {
    if (!std::binary_search(got.begin(), got.end(), fact)) lines.push_back("missing: " + fact);
  }
  return absl::StrJoin(lines, "\n");
}

int PairCount() {
  const char* asked = std::getenv("DOCENT_PROPERTY_PAIRS");
  return asked == nullptr ? 2000 : std::atoi(asked);
}

class ReasonerRulesPairs : public testing::TestWithParam<Theme> {
 protected:
  // The reference for the incremental graph; `naive`: much slower.
  void Compare(const Reasoner& reasoner, bool naive, const std::string& when) {
    const Facts told(reasoner.told().begin(), reasoner.told().end());
    const std::string all = "\ntold:\n" + absl::StrJoin(told, "\n");
    const Facts got = reasoner.Inferred(), scratch = Reasoner(told).Inferred();
    ASSERT_EQ(Difference(got, scratch), "") << when << all;
    if (!naive) return;
    ASSERT_EQ(Difference(got, NaiveInferences(rules::BuiltInRuleSet("owl2rl"), reasoner.told(), "owl2rl")),
              "")
        << when << all;
  }
};

TEST_P(ReasonerRulesPairs, LeaveWhatACompletionFromScratchGives) {
  const Theme& theme = GetParam();
  const int pairs = PairCount();
  const int between = std::max(100, pairs / 200);  // comparisons from scratch
  std::mt19937 random(2718);
  const auto pick = [&](size_t n) { return static_cast<size_t>(random() % n); };

  const std::set<std::string> pool(theme.pool.begin(), theme.pool.end());  // each once
  Facts here, absent(pool.begin(), pool.end());
  std::shuffle(absent.begin(), absent.end(), random);
  Reasoner reasoner(theme.always);
  const std::vector<Quad> at_first = reasoner.Quads();
  for (size_t i = 0; i < pool.size() / 3; ++i) {
    here.push_back(absent.back());
    absent.pop_back();
  }
  reasoner.Tell(here, {});
  int undone = 0;
  for (int pair = 1; pair <= pairs; ++pair) {
    const std::string added = absent[pick(absent.size())];
    const bool same = pick(2) == 0;  // the fact that was just told is withdrawn; or another one
    std::string& removed = same ? *std::find(absent.begin(), absent.end(), added) : here[pick(here.size())];
    const std::vector<Quad> before = same ? reasoner.Quads() : std::vector<Quad>();
    const std::string fact = removed;
    reasoner.Tell({added}, {});
    reasoner.Tell({}, {fact});
    if (HasFatalFailure()) return;
    if (same) {
      ++undone;
      if (reasoner.Quads() != before) {
        Facts was = reasoner.Texts(before), is = reasoner.Texts(reasoner.Quads());
        Compare(reasoner, false, "");
        FAIL() << "pair " << pair << ": " << added << " told and withdrawn\n"
               << Difference(is, was) << "\ntold:\n"
               << absl::StrJoin(reasoner.told(), "\n");
      }
    } else {
      std::swap(removed, *std::find(absent.begin(), absent.end(), added));
    }
    if (pair % between == 0) {
      Compare(reasoner, pair % (4 * between) == 0, absl::StrCat("after pair ", pair));
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(undone, pairs / 3);
  for (const std::string& fact : here) reasoner.Tell({}, {fact});
  EXPECT_EQ(reasoner.Quads(), at_first) << "all withdrawn";
}

INSTANTIATE_TEST_SUITE_P(Themes, ReasonerRulesPairs,
                         testing::Values(InverseProperties(), SharedSupport(), EqualThings(),
                                         EqualInEveryPlace(), TransitiveCycles(), AllTogether()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace docent
