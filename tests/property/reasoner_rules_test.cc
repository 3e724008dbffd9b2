// For any order of additions, removals and rule changes: docent:inferred equals a computation from scratch
// (naive_rules.h).
#include <gtest/gtest.h>

#include "tests/property/rule_sequences.h"

namespace docent {
namespace {

// A rule over variables x, y, z, v; may be unsafe or unstratified: the engine then refuses it and it is not
// used.
std::string RandomRule(RandomWorld& random) {
  const std::vector<std::string> variables = {"?x", "?y", "?z"};
  const auto node = [&] { return random.Chance(85) ? variables[random.Pick(3)] : ":" + random.Node(); };
  const auto predicate = [&] { return random.Chance(94) ? ":" + random.Predicate() : std::string("?v"); };
  std::string body;
  const int patterns = 1 + random.Pick(3);
  for (int i = 0; i < patterns; ++i) body += node() + " " + predicate() + " " + node() + " . ";
  if (random.Chance(15))
    body += "{ " + node() + " :p0 " + node() + " } UNION { " + node() + " :p1 " + node() + " } ";
  if (random.Chance(30)) {
    body += "FILTER NOT EXISTS { " + node() + " :p" + std::to_string(random.Pick(4)) + " " + node();
    if (random.Chance(25)) body += " FILTER NOT EXISTS { " + node() + " :p0 " + node() + " }";
    body += " } ";
  }
  if (random.Chance(12))
    body += "FILTER EXISTS { " + node() + " :p" + std::to_string(random.Pick(4)) + " " + node() + " } ";
  if (random.Chance(12)) body += "MINUS { " + node() + " :p2 " + node() + " } ";
  if (random.Chance(15)) body += "FILTER(?y > " + std::to_string(random.Pick(5)) + ") ";
  if (random.Chance(10)) body += "FILTER(?x != ?y) ";
  if (random.Chance(10)) body += "BIND(IF(ISNUMERIC(?y), 7, ?y) AS ?w) ";
  if (random.Chance(12)) {
    const std::vector<std::string> functions = {"COUNT(*)", "COUNT(DISTINCT ?y)", "MIN(?y)", "MAX(?y)",
                                                "SUM(?y)"};
    body += "{ SELECT ?x (" + functions[random.Pick(5)] + " AS ?w) { ?x :p" + std::to_string(random.Pick(4)) +
            " ?y } GROUP BY ?x } ";
  }
  const std::string object = body.find("?w") != std::string::npos ? "?w" : node();
  std::string head = node() + " :p" + std::to_string(random.Pick(4)) + " " + object;
  if (random.Chance(10)) head += " . " + node() + " :p3 " + node();
  return "RULE { " + head + " } WHERE { " + body + "}\n";
}

// Up to `wanted` rules that the engine accepts together.
std::string AcceptedRules(RandomWorld& random, int wanted) {
  TestWorld world;
  std::string rules;
  for (int attempt = 0; attempt < 4 * wanted; ++attempt) {
    const std::string more = rules + RandomRule(random);
    rules::RuleEngine engine(world.dictionary);
    if (!HasErrors(engine.PutRules("rules", kRulesPrefix + more))) rules = more;
    if (static_cast<int>(Lines(rules).size()) == wanted) break;
  }
  return rules;
}

TEST(ReasonerRulesProperty, IncrementalIsFromScratch) {
  int with_rules = 0;
  const int count = SequenceCount();
  for (int seed = 1; seed <= count; ++seed) {
    RandomWorld random(static_cast<unsigned>(seed));
    const std::string rules = AcceptedRules(random, 1 + random.Pick(6));
    if (rules.empty()) continue;
    ++with_rules;
    std::vector<Step> steps;
    std::set<std::string> told;
    for (int i = 0; i < 12; ++i) {
      Step step{random.Batch(told), {}};
      if (i > 0 && random.Chance(5)) step.new_rules = AcceptedRules(random, 1 + random.Pick(5));
      steps.push_back(std::move(step));
    }
    std::string trace;
    if (FirstDifference(rules, steps, &trace) < 0) continue;
    bool changes_rules = false;
    for (const Step& step : steps) changes_rules = changes_rules || !step.new_rules.empty();
    FAIL() << "seed " << seed << "\n" << (changes_rules ? trace : Shrink(rules, steps));
  }
  RecordProperty("sequences", with_rules);
  std::cout << with_rules << " sequences of 12 batches, seeds 1 to " << count << "\n";
  EXPECT_GT(with_rules, count * 3 / 4);
}

// All five equality rules or, as often, some of them.
std::string SomeSchemaRules(RandomWorld& random, int percent) {
  const std::vector<std::string> all = Lines(kSchemaRules);
  const bool whole_equality = random.Chance(50);
  std::string rules;
  for (size_t i = 0; i < all.size(); ++i) {
    // the last negates types made by the others: left out if recursion would go through it
    const bool wanted = random.Chance(percent) || (whole_equality && i < 5);
    if (wanted && i + 1 < all.size()) rules += all[i] + "\n";
  }
  return rules;
}

TEST(ReasonerRulesProperty, SchemaAndDataChangeTogether) {
  const int count = SequenceCount() / 5;
  for (int seed = 1; seed <= count; ++seed) {
    RandomWorld random(static_cast<unsigned>(seed));
    random.schema_percent = 45;
    const std::string rules = SomeSchemaRules(random, 70);
    std::vector<Step> steps;
    std::set<std::string> told;
    for (int i = 0; i < 12; ++i) {
      Step step{random.Batch(told), {}};
      if (i > 0 && random.Chance(8)) step.new_rules = SomeSchemaRules(random, 60);
      steps.push_back(std::move(step));
    }
    std::string trace;
    if (rules.empty() || FirstDifference(rules, steps, &trace) < 0) continue;
    FAIL() << "seed " << seed << "\n" << Shrink(rules, steps);
  }
}

// The rules that other reasoners are known to get wrong, on long random sequences.
TEST(ReasonerRulesProperty, InverseCyclesAndTransitivity) {
  const std::string rules =
      "RULE { ?y :p1 ?x } WHERE { ?x :p0 ?y }\n"
      "RULE { ?y :p0 ?x } WHERE { ?x :p1 ?y }\n"
      "RULE { ?x :p2 ?z } WHERE { ?x :p2 ?y . ?y :p2 ?z }\n"
      "RULE { ?x :p2 ?y } WHERE { ?x :p0 ?y }\n"
      "RULE { ?x :p3 ?y } WHERE { ?x :p2 ?y FILTER NOT EXISTS { ?y :p2 ?x } }\n";
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomWorld random(seed);
    std::vector<Step> steps;
    std::set<std::string> told;
    for (int i = 0; i < 40; ++i) steps.push_back({random.Batch(told), {}});
    std::string trace;
    ASSERT_LT(FirstDifference(rules, steps, &trace), 0) << "seed " << seed << "\n" << Shrink(rules, steps);
  }
}

}  // namespace
}  // namespace docent
