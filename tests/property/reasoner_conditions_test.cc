// For any order of additions, removals, registrations, commits and rollbacks: the state of a standing
// condition equals a new run of its query, and its binding changes are the difference of two runs.

#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "graph/sparql/run/evaluator.h"
#include "reasoner/conditions/standing_conditions.h"
#include "tests/property/reasoner_random.h"
#include "tests/reasoner/test_world.h"

namespace docent {
namespace {

std::string RandomGroup(RandomWorld& random, int depth);

// GRAPH around a pattern that may have solutions without a triple of the graph; the graphs come and go.
std::string RandomGraph(RandomWorld& random, const std::string& triple, int depth) {
  const std::vector<std::string> names = {":g0", ":g1", ":g1", ":none", "?g"};
  std::string inside;
  switch (random.Pick(12)) {
    case 0:
      break;
    case 1:
      inside = "BIND(1 AS ?k) ";
      break;
    case 2:
      inside = "VALUES ?x { :n1 :n2 3 } ";
      break;
    case 3:
      inside = "FILTER(true) ";
      break;
    case 4:
      inside = "OPTIONAL { " + triple + "} ";
      break;
    case 5:
      inside = "{ " + triple + "} UNION { VALUES ?y { :n0 } } ";
      break;
    case 6:
      inside = "VALUES ?x { :n1 :n2 } MINUS { " + triple + "} ";
      break;
    case 7:
      inside = "SELECT (COUNT(*) AS ?m) { " + triple + "} ";
      break;
    case 8:
      inside = ":n1 :p0* ?y . ";
      break;
    case 9:
      inside = "GRAPH ?h { " + triple + "} ";
      break;
    case 10:
      inside = "FILTER NOT EXISTS { " + triple + "} ";
      break;
    default:
      inside = RandomGroup(random, depth - 1);
  }
  return "GRAPH " + names[static_cast<size_t>(random.Pick(5))] + " { " + inside + "} ";
}

std::string RandomGroup(RandomWorld& random, int depth) {
  const std::vector<std::string> variables = {"?x", "?y", "?z"};
  const auto node = [&] { return random.Chance(75) ? variables[random.Pick(3)] : ":" + random.Node(); };
  const auto triple = [&] {
    return node() + (random.Chance(95) ? " :" + random.Predicate() : " ?v") + " " + node() + " . ";
  };
  std::string body;
  const bool graph_alone = depth > 0 && random.Chance(7);
  if (graph_alone) body += RandomGraph(random, triple(), depth);
  const int patterns = graph_alone ? random.Pick(2) : 1 + random.Pick(3);
  for (int i = 0; i < patterns; ++i) body += triple();
  if (random.Chance(20)) {
    body += "FILTER(" + variables[random.Pick(3)] + (random.Chance(50) ? " > " : " <= ") +
            std::to_string(random.Pick(6)) + ") ";
  }
  if (random.Chance(6)) body += "FILTER(?x < ?y) ";
  if (random.Chance(8)) body += "FILTER(?x != ?y || ?z = 3) ";
  if (depth == 0) return body;
  if (random.Chance(25)) body += "FILTER NOT EXISTS { " + RandomGroup(random, depth - 1) + "} ";
  if (random.Chance(10)) body += "FILTER EXISTS { " + RandomGroup(random, depth - 1) + "} ";
  if (random.Chance(12)) body += "MINUS { " + RandomGroup(random, depth - 1) + "} ";
  if (random.Chance(12)) body += "OPTIONAL { " + RandomGroup(random, depth - 1) + "} ";
  if (random.Chance(8)) body += "FILTER(!BOUND(?z)) ";
  if (random.Chance(14)) {
    body += "{ " + RandomGroup(random, depth - 1) + "} UNION { " + RandomGroup(random, depth - 1) + "} ";
  }
  if (random.Chance(8)) body += "GRAPH ?g { " + triple() + "} ";
  if (random.Chance(5)) body += "GRAPH :g1 { " + triple() + "} ";
  if (random.Chance(8)) body += RandomGraph(random, triple(), depth);
  if (random.Chance(6)) body += "VALUES ?x { :n1 :n2 3 } ";
  if (random.Chance(6)) body += "{ " + RandomGroup(random, depth - 1) + "} ";
  if (random.Chance(6)) body += "BIND(?x AS ?b) ";
  if (random.Chance(5)) body += "{ SELECT ?x (COUNT(?y) AS ?n) { ?x :p0 ?y } GROUP BY ?x } ";
  if (random.Chance(4)) body += "{ SELECT DISTINCT ?x { ?x :p1 ?y } } ";
  return body;
}

struct Asked {
  std::string text;
  std::vector<std::string> keys;
};

Asked RandomConstraint(RandomWorld& random, const TestWorld& world) {
  while (true) {
    Asked asked{"ASK { " + RandomGroup(random, 2) + "}", {}};
    sparql::ParseOptions options;
    options.prefixes = {{"", std::string(kExampleNs)}};
    const sparql::ParsedQuery parsed = sparql::ParseQuery(asked.text, options);
    if (!parsed.ok()) continue;  // e.g. BIND of a variable in use
    if (!sparql::PreparedQuery::Prepare(parsed.query, world.dictionary).ok()) continue;
    if (random.Chance(40)) {
      std::vector<std::string> names;
      for (const sparql::Variable& v : sparql::InScopeVariables(*parsed.query.algebra)) {
        if (!v.IsHidden()) names.push_back(v.name);
      }
      for (const std::string& name : names) {
        if (asked.keys.size() < 2 && random.Chance(60)) asked.keys.push_back(name);
      }
    }
    return asked;
  }
}

using KeySet = std::set<std::string>;

class Followed {
 public:
  Followed(TestWorld& world, const Asked& asked)
      : world_(world), asked_(asked), query_(world.Parse(asked.text)) {}

  // The distinct key bindings by running the query: one empty one if it holds and has no keys.
  KeySet Run() const {
    auto prepared = sparql::PreparedQuery::Prepare(query_, world_.dictionary);
    EXPECT_TRUE(prepared.ok());
    KeySet keys;
    const auto& names = (*prepared)->variables();
    const absl::Status status =
        (*prepared)->Select({.version = &world_.writer.current()}, {}, [&](absl::Span<const TermId> row) {
          std::string key = "{";
          for (const std::string& wanted : asked_.keys) {
            for (size_t i = 0; i < names.size(); ++i) {
              if (names[i] != wanted || row[i].IsNone()) continue;
              key += wanted + "=" + ToNTriples((*prepared)->Decode(row[i])) + " ";
            }
          }
          keys.insert(key + "}");
          return true;
        });
    EXPECT_TRUE(status.ok()) << status;
    return keys;
  }
  KeySet Texts(const std::vector<conditions::Binding>& bindings) const {
    KeySet keys;
    for (const conditions::Binding& binding : bindings) {
      std::string key = "{";
      for (const auto& [name, id] : binding)
        key += name + "=" + ToNTriples(world_.dictionary.Decode(id)) + " ";
      keys.insert(key + "}");
    }
    return keys;
  }
  const Asked& asked() const { return asked_; }
  const sparql::Query& query() const { return query_; }

  conditions::ConditionId id;
  KeySet expected;  // as of the last update
  KeySet committed;

 private:
  TestWorld& world_;
  Asked asked_;
  sparql::Query query_;
};

std::string Show(const KeySet& keys) {
  std::string text;
  for (const std::string& key : keys) text += key + " ";
  return text.empty() ? "nothing" : text;
}

struct Step {
  RandomBatch batch;
  enum class End { kNothing, kCommit, kRollback } end = End::kCommit;
};

// The failure of `asked` through `steps`; empty if there is none.
std::string Difference(const std::vector<Asked>& asked, const std::vector<Step>& steps,
                       size_t register_late) {
  TestWorld world;
  conditions::StandingConditions set(world.dictionary);
  std::vector<std::unique_ptr<Followed>> followed;
  const auto follow = [&](const Asked& a) {
    auto f = std::make_unique<Followed>(world, a);
    const auto id = set.Register(f->query(), world.writer.current(), {a.keys, 0});
    EXPECT_TRUE(id.ok()) << id.status() << " " << a.text;
    f->id = *id;
    f->expected = f->committed = f->Run();
    followed.push_back(std::move(f));
  };
  for (size_t i = 0; i < asked.size() && i < register_late; ++i) follow(asked[i]);
  set.Commit();
  std::string history;
  uint64_t revision = 0;
  for (size_t i = 0; i < steps.size(); ++i) {
    if (i == 2) {
      for (size_t k = register_late; k < asked.size(); ++k) follow(asked[k]);
      set.Commit();
      for (auto& f : followed) f->committed = f->expected;
      world.writer.Freeze(Revision(++revision));
    }
    history += "step " + std::to_string(i) + ":";
    for (const std::string& q : steps[i].batch.add) history += "  +" + q;
    for (const std::string& q : steps[i].batch.remove) history += "  -" + q;
    history += "\n";
    const Delta delta = world.Apply(steps[i].batch.add, steps[i].batch.remove);
    const auto changes = set.Update(world.writer.current(), delta);
    EXPECT_TRUE(changes.ok()) << changes.status();
    for (auto& f : followed) {
      const KeySet before = f->expected;
      const KeySet after = f->Run();
      f->expected = after;
      KeySet appeared, disappeared;
      std::string edge = "none";
      for (const conditions::ConditionChange& change : *changes) {
        if (change.id != f->id) continue;
        appeared = f->Texts(change.appeared);
        disappeared = f->Texts(change.disappeared);
        edge = change.edge == conditions::ConditionChange::Edge::kRose   ? "rose"
               : change.edge == conditions::ConditionChange::Edge::kFell ? "fell"
                                                                         : "bindings";
      }
      KeySet new_keys, old_keys;
      std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                          std::inserter(new_keys, new_keys.end()));
      std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                          std::inserter(old_keys, old_keys.end()));
      std::string wanted = before.empty() != after.empty() ? (after.empty() ? "fell" : "rose") : "none";
      if (f->asked().keys.empty()) {
        new_keys.clear();
        old_keys.clear();
      } else if (wanted == "none" && !(new_keys.empty() && old_keys.empty())) {
        wanted = "bindings";
      }
      const bool levels = set.Holds(f->id) == !after.empty() && f->Texts(set.Keys(f->id)) == after;
      if (levels && edge == wanted && appeared == new_keys && disappeared == old_keys) continue;
      std::string keys;
      for (const std::string& key : f->asked().keys) keys += " ?" + key;
      return f->asked().text + " keys" + keys + "\n" + history + "answer " + Show(after) + "but followed " +
             Show(f->Texts(set.Keys(f->id))) + "\nedge " + edge + " appeared " + Show(appeared) +
             "disappeared " + Show(disappeared) + "\nwanted " + wanted + " appeared " + Show(new_keys) +
             "disappeared " + Show(old_keys);
    }
    if (steps[i].end == Step::End::kCommit) {
      set.Commit();
      world.writer.Freeze(Revision(++revision));
      for (auto& f : followed) f->committed = f->expected;
      history += "  commit\n";
    } else if (steps[i].end == Step::End::kRollback) {
      set.Rollback();
      world.writer.Rollback();
      for (auto& f : followed) f->expected = f->committed;
      history += "  rollback\n";
    }
  }
  return "";
}

// Leaves out conditions, steps and single changes as long as the case still fails.
std::string Shrink(std::vector<Asked> asked, std::vector<Step> steps, size_t register_late) {
  const auto fails = [&](const std::vector<Asked>& a, const std::vector<Step>& s) {
    return !Difference(a, s, register_late).empty();
  };
  for (const Asked& one : asked) {
    const size_t late = register_late;
    register_late = 1;
    if (fails({one}, steps)) {
      asked = {one};
      break;
    }
    register_late = 0;
    if (fails({one}, steps)) {
      asked = {one};
      break;
    }
    register_late = late;
  }
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (size_t i = 0; i < steps.size() && !smaller; ++i) {
      std::vector<Step> fewer = steps;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      if (fails(asked, fewer)) smaller = true, steps = fewer;
    }
    for (size_t i = 0; i < steps.size() && !smaller; ++i) {
      for (auto member : {&RandomBatch::add, &RandomBatch::remove}) {
        for (size_t k = 0; k < (steps[i].batch.*member).size() && !smaller; ++k) {
          std::vector<Step> fewer = steps;
          (fewer[i].batch.*member).erase((fewer[i].batch.*member).begin() + static_cast<std::ptrdiff_t>(k));
          if (fails(asked, fewer)) smaller = true, steps = fewer;
        }
      }
    }
  }
  return Difference(asked, steps, register_late);
}

// Many conditions of one shape that differ in a number, so that they are followed as a group.
std::vector<Asked> RandomThresholds(RandomWorld& random, int count) {
  const std::vector<std::string> shapes = {"?x :p0 ?v", ":n1 :p0 ?v", "?x :p0 ?v . ?x :p1 ?y",
                                           "?x :p0 ?v FILTER NOT EXISTS { ?x :p2 ?z }",
                                           "?x :p0 ?v . ?y :p1 ?v FILTER(?x != ?y)"};
  const std::vector<std::string> numbers = {"0",
                                            "1",
                                            "2",
                                            "2.0",
                                            "2.5",
                                            "3",
                                            "4",
                                            "5",
                                            "0.1",
                                            "2.00",
                                            "9007199254740993",
                                            "9007199254740992",
                                            "2.0e0",
                                            "1.0e-1"};
  const std::string shape = shapes[static_cast<size_t>(random.Pick(static_cast<int>(shapes.size())))];
  const std::vector<std::string> operators = {" > ", " >= ", " < ", " <= "};
  std::vector<Asked> asked;
  for (int i = 0; i < count; ++i) {
    const std::string number = numbers[static_cast<size_t>(random.Pick(static_cast<int>(numbers.size())))];
    const std::string op = operators[static_cast<size_t>(random.Pick(4))];
    const std::string test = random.Chance(50) ? "?v" + op + number : number + op + "?v";
    asked.push_back({"ASK { " + shape + " FILTER(" + test + ") }", {}});
  }
  return asked;
}

// Many conditions of one shape that differ in constants, so that they are watched together.
std::vector<Asked> RandomShapes(RandomWorld& random, int count) {
  const std::vector<std::string> shapes = {"?x :p0 ?y . ?y :p1 @1",
                                           "?x :p0 ?y . ?y :p1 @1 . ?x :p2 @2",
                                           "?x :p0 @1 FILTER NOT EXISTS { ?x :p1 ?z }",
                                           "?x :p0 ?y . ?y ?p @1",
                                           "?x :p0 @1 MINUS { ?x :p1 ?z . ?z :p2 ?w }",
                                           "?x :p0 @1 OPTIONAL { ?x :p1 ?z } FILTER(!BOUND(?z))",
                                           "?x :p0 ?y . ?y :p1 @1 FILTER(?x != @2)",
                                           "?x :p0 ?v . ?x :p1 @1 FILTER(?v > 2)",
                                           "GRAPH ?g { ?x :p0 ?y . ?y :p1 @1 }",
                                           "?x :p0 @1 GRAPH :g1 { VALUES ?k { 1 } }",
                                           "?x :p0 @1 FILTER NOT EXISTS { GRAPH :g0 { FILTER(true) } }",
                                           "@1 :p0 ?y . ?y :p1 ?z . ?z :p2 @2",
                                           "{ ?x :p0 ?y . ?y :p1 @1 } { ?x :p1 ?z }",
                                           "?x :p0 ?y . ?y :p1 ?x . ?x :p2 @1"};
  std::string shape = shapes[static_cast<size_t>(random.Pick(static_cast<int>(shapes.size())))];
  std::vector<Asked> asked;
  for (int i = 0; i < count; ++i) {
    std::string text = shape;
    for (const char* place : {"@1", "@2"}) {
      const size_t at = text.find(place);
      if (at != std::string::npos)
        text.replace(at, 2,
                     at == 0 || random.Chance(80) ? ":" + random.Node() : std::to_string(random.Pick(4)));
    }
    Asked one{"ASK { " + text + " }", {}};
    if (random.Chance(30) && text.find("?x") != std::string::npos) one.keys.push_back("x");
    asked.push_back(std::move(one));
  }
  return asked;
}

void CheckSequences(int count, int percent_numbers,
                    const std::function<std::vector<Asked>(RandomWorld&)>& ask) {
  const size_t register_late = 4;
  for (int seed = 1; seed <= count; ++seed) {
    RandomWorld random(static_cast<unsigned>(seed));
    random.numbers_percent = percent_numbers;
    const std::vector<Asked> asked = ask(random);
    std::vector<Step> steps;
    std::set<std::string> told, committed;
    for (int i = 0; i < 15; ++i) {
      Step step{random.Batch(told), Step::End::kCommit};
      if (i != 1 && random.Chance(15)) step.end = Step::End::kNothing;
      if (i > 2 && random.Chance(15)) step.end = Step::End::kRollback;
      if (step.end == Step::End::kCommit) committed = told;
      if (step.end == Step::End::kRollback) told = committed;
      steps.push_back(std::move(step));
    }
    const std::string difference = Difference(asked, steps, register_late);
    ASSERT_EQ(difference, "") << "seed " << seed << "\n" << Shrink(asked, steps, register_late);
  }
  std::cout << count << " sequences of 15 batches, seeds 1 to " << count << "\n";
}

int SequenceCount(int usual) {
  const char* asked = std::getenv("DOCENT_PROPERTY_SEQUENCES");
  return asked == nullptr ? usual : std::atoi(asked);
}

TEST(ReasonerConditionsProperty, StandingAnswersAreRunAnswers) {
  CheckSequences(SequenceCount(500), 25, [](RandomWorld& random) {
    const TestWorld scratch;
    std::vector<Asked> asked;
    for (int i = 0; i < 8; ++i) asked.push_back(RandomConstraint(random, scratch));
    return asked;
  });
}

TEST(ReasonerConditionsProperty, ShapesThatDifferInConstants) {
  CheckSequences(SequenceCount(300), 25, [](RandomWorld& random) { return RandomShapes(random, 40); });
}

TEST(ReasonerConditionsProperty, ThresholdsInGroups) {
  CheckSequences(SequenceCount(200), 80, [](RandomWorld& random) { return RandomThresholds(random, 40); });
}

}  // namespace
}  // namespace docent
