// For any order of additions, removals and rule changes: docent:inferred equals a computation from scratch
// (naive_rules.h).

#include <array>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "graph/base/limits.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/property/naive_rules.h"
#include "tests/property/reasoner_random.h"
#include "tests/reasoner/test_world.h"

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

std::set<Quad> InferredQuads(TestWorld& world) {
  std::set<Quad> quads;
  const TermId graph = world.dictionary.InternIri(kInferredGraph);
  world.writer.current().ForEach({TermId(), TermId(), TermId(), graph}, [&](const Quad& q) {
    quads.insert(q);
    return true;
  });
  return quads;
}

struct Step {
  RandomBatch batch;
  std::string new_rules;  // with rules, before the batch; empty: as before
};

// True if a new engine refuses these facts, too: their axioms leave rules with negation without an order.
bool IsRefused(const std::string& rules, const std::set<std::string>& told) {
  TestWorld world;
  rules::RuleEngine engine(world.dictionary);
  EXPECT_FALSE(HasErrors(engine.PutRules("rules", kRulesPrefix + rules)));
  return !engine.Update(world.writer, world.Apply({told.begin(), told.end()})).ok();
}

// Number of refused and accepted steps when rules with negation are entangled with others.
struct Tally {
  int refused = 0, taken = 0;
};

// The first step after which the two differ, or -1. `trace` explains it. A refused step changes nothing.
int FirstDifference(const std::string& rules, const std::vector<Step>& steps, std::string* trace,
                    Tally* tally = nullptr) {
  TestWorld world;
  // The order of ids is the order in which changes are processed; it must not depend on the rules alone.
  for (size_t i = 0; i < 4; ++i) world.Id("p" + std::to_string((i * 3 + rules.size()) % 4));
  Limits limits;
  limits.inferred_per_turn =
      20000;  // far more than so few things have facts: what goes on without end fails soon
  rules::RuleEngine engine(world.dictionary, limits);
  std::string current = rules;
  if (HasErrors(engine.PutRules("rules", kRulesPrefix + rules))) return -1;
  if (!engine.Update(world.writer, {}).ok()) {  // by axioms that the rules bring along
    EXPECT_TRUE(IsRefused(rules, {}));
    return -1;
  }
  engine.Commit();
  world.writer.Commit();
  std::set<std::string> told;
  for (size_t i = 0; i < steps.size(); ++i) {
    const std::string rules_before = current;
    if (!steps[i].new_rules.empty()) {
      current = steps[i].new_rules;
      EXPECT_FALSE(HasErrors(engine.PutRules("rules", kRulesPrefix + current)));
    }
    const std::set<Quad> before = InferredQuads(world);
    const Delta told_delta = world.Apply(steps[i].batch.add, steps[i].batch.remove);
    const std::set<std::string> told_before = told;
    for (const std::string& q : steps[i].batch.remove) told.erase(q);
    for (const std::string& q : steps[i].batch.add) told.insert(q);
    auto delta = engine.Update(world.writer, told_delta);
    if (tally != nullptr) ++(delta.ok() ? tally->taken : tally->refused);
    if (!delta.ok()) {
      const absl::Status delta_status = delta.status();
      const bool rightly =
          delta.status().code() == absl::StatusCode::kFailedPrecondition && IsRefused(current, told);
      engine.Rollback();
      world.writer.Rollback();
      current = rules_before;
      told = told_before;
      delta = Delta();
      if (!rightly) {
        if (trace != nullptr)
          *trace = "step " + std::to_string(i) + " is refused: " + delta_status.ToString() + "\n" + current;
        return static_cast<int>(i);
      }
    }
    engine.Commit();
    world.writer.Commit();
    const std::vector<std::string> got = WithoutReports(world.Inferred());
    const std::vector<std::string> expected = NaiveInferences(current, told);
    // The delta must lead from the old inferred graph to the new one.
    std::set<Quad> replayed = before;
    const TermId inferred = world.dictionary.InternIri(kInferredGraph);
    for (const Quad& q : delta->removed) {
      if (q.graph == inferred) replayed.erase(q);
    }
    for (const Quad& q : delta->added) {
      if (q.graph == inferred) replayed.insert(q);
    }
    const bool delta_right = replayed == InferredQuads(world);
    if (got == expected && delta_right) continue;
    if (trace != nullptr) {
      *trace = "rules:\n" + current + (delta_right ? "" : "the delta does not lead to the graph\n");
      for (size_t k = 0; k <= i; ++k) {
        *trace += "step " + std::to_string(k) + ":" +
                  (steps[k].new_rules.empty() ? "" : " with the rules\n" + steps[k].new_rules);
        for (const std::string& q : steps[k].batch.add) *trace += "  +" + q;
        for (const std::string& q : steps[k].batch.remove) *trace += "  -" + q;
        *trace += "\n";
      }
      for (const std::string& t : got) {
        if (std::find(expected.begin(), expected.end(), t) == expected.end())
          *trace += "too much: " + t + "\n";
      }
      for (const std::string& t : expected) {
        if (std::find(got.begin(), got.end(), t) == got.end()) *trace += "missing: " + t + "\n";
      }
    }
    return static_cast<int>(i);
  }
  return -1;
}

std::vector<std::string> Lines(const std::string& rules) {
  std::vector<std::string> lines = absl::StrSplit(rules, '\n', absl::SkipEmpty());
  return lines;
}

// Leaves out rules, steps and single changes as long as it still fails.
std::string Shrink(std::string rules, std::vector<Step> steps) {
  steps.resize(static_cast<size_t>(FirstDifference(rules, steps, nullptr)) + 1);
  for (bool smaller = true; smaller;) {
    smaller = false;
    const auto attempt = [&](const std::string& fewer_rules, const std::vector<Step>& fewer) {
      if (FirstDifference(fewer_rules, fewer, nullptr) < 0) return false;
      rules = fewer_rules;
      steps = fewer;
      return smaller = true;
    };
    for (size_t i = 0; i < Lines(rules).size(); ++i) {
      std::string fewer;
      const std::vector<std::string> lines = Lines(rules);
      for (size_t k = 0; k < lines.size(); ++k) fewer += k == i ? "" : lines[k] + "\n";
      if (attempt(fewer, steps)) break;
    }
    for (size_t i = 0; i < steps.size(); ++i) {
      std::vector<Step> fewer = steps;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      if (attempt(rules, fewer)) break;
    }
    for (size_t i = 0; i < steps.size() && !smaller; ++i) {
      for (auto member : {&RandomBatch::add, &RandomBatch::remove}) {
        for (size_t k = 0; k < (steps[i].batch.*member).size() && !smaller; ++k) {
          std::vector<Step> fewer = steps;
          (fewer[i].batch.*member).erase((fewer[i].batch.*member).begin() + static_cast<std::ptrdiff_t>(k));
          attempt(rules, fewer);
        }
      }
    }
  }
  std::string trace;
  FirstDifference(rules, steps, &trace);
  return trace;
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

int SequenceCount() {
  const char* asked = std::getenv("DOCENT_PROPERTY_SEQUENCES");
  return asked == nullptr ? 500 : std::atoi(asked);
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

// Rules with a schema part, over a schema that changes as often as the data: equal things, inverse and
// transitive properties, restrictions, in every combination. One rule a line, so that they shrink.
constexpr char kSchemaRules[] =
    "RULE { ?y owl:sameAs ?x } WHERE { ?x owl:sameAs ?y }\n"
    "RULE { ?x owl:sameAs ?z } WHERE { ?x owl:sameAs ?y . ?y owl:sameAs ?z }\n"
    "RULE { ?s2 ?p ?o } WHERE { ?s owl:sameAs ?s2 . ?s ?p ?o FILTER(?s != ?s2) }\n"
    "RULE { ?s ?p2 ?o } WHERE { ?p owl:sameAs ?p2 . ?s ?p ?o FILTER(?p != ?p2) }\n"
    "RULE { ?s ?p ?o2 } WHERE { ?o owl:sameAs ?o2 . ?s ?p ?o FILTER(?o != ?o2) }\n"
    "RULE { ?x a ?c } WHERE { ?p rdfs:domain ?c . ?x ?p ?y }\n"
    "RULE { ?y a ?c } WHERE { ?p rdfs:range ?c . ?x ?p ?y }\n"
    "RULE { ?y1 owl:sameAs ?y2 } WHERE { ?p a owl:FunctionalProperty . ?x ?p ?y1 . ?x ?p ?y2 FILTER(?y1 != "
    "?y2) }\n"
    "RULE { ?x ?p ?z } WHERE { ?p a owl:TransitiveProperty . ?x ?p ?y . ?y ?p ?z }\n"
    "RULE { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y FILTER(?p1 != ?p2) }\n"
    "RULE { ?y ?p2 ?x } WHERE { ?p1 owl:inverseOf ?p2 . ?x ?p1 ?y }\n"
    "RULE { ?y ?p1 ?x } WHERE { ?p1 owl:inverseOf ?p2 . ?x ?p2 ?y }\n"
    "RULE { ?x a ?c2 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?x a ?c1 FILTER(?c1 != ?c2) }\n"
    "RULE { ?c1 rdfs:subClassOf ?c3 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?c2 rdfs:subClassOf ?c3 }\n"
    "RULE { ?u a ?x } WHERE { ?x owl:someValuesFrom ?y . ?x owl:onProperty ?p . ?u ?p ?v . ?v a ?y }\n"
    "RULE { ?v a ?y } WHERE { ?x owl:allValuesFrom ?y . ?x owl:onProperty ?p . ?u a ?x . ?u ?p ?v }\n"
    "RULE { } WHERE { ?c1 owl:disjointWith ?c2 . ?x a ?c1 . ?x a ?c2 }\n"
    "RULE { ?x :p3 ?y } WHERE { ?x :p2 ?y FILTER NOT EXISTS { ?y a :n0 } }\n";

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

// Rules with negation and aggregates that only axioms can entangle with those rules.
constexpr char kNegatingRules[] =
    "RULE { ?x :q0 ?y } WHERE { ?x :p2 ?y NOT { ?y a :n0 } }\n"
    "RULE { ?x :p3 ?y } WHERE { ?x :p2 ?y NOT { ?y a :n3 } }\n"
    "RULE { ?x :p1 ?z } WHERE { ?x :p1 ?y . ?y :q0 ?z NOT { ?z a :n1 } }\n"
    "RULE { ?x :q1 ?n } WHERE { { SELECT ?x (COUNT(?y) AS ?n) WHERE { ?x :q0 ?y } GROUP BY ?x } }\n"
    "RULE { ?x :q2 ?y } WHERE { ?x :p3 ?y NOT { ?x :q0 ?y } }\n"
    "RULE { ?x :p0 ?y } WHERE { ?x :q2 ?y }\n"
    "RULE { ?x :q3 ?y } WHERE { ?x :p1 ?y NOT { ?x :p3 ?y } NOT { ?y :q2 ?x } }\n"
    "RULE { ?x a :n2 } WHERE { ?x :q3 ?y NOT { ?x a :n1 } }\n";

// Axioms that follow from facts.
constexpr char kLikes[] =
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?a owl:inverseOf ?b } WHERE { ?a :inv ?b }\n"
    "RULE { ?a rdfs:subClassOf ?b } WHERE { ?a :sub ?b }\n"
    "RULE { ?a rdfs:domain ?b } WHERE { ?a :dom ?b }\n"
    "RULE { ?a :like ?b } WHERE { { ?a :like1 ?b } UNION { ?a :like2 ?b } }\n"
    "RULE { ?x :p0 ?y } WHERE { { ?x :p1 ?y } UNION { ?x :q0 ?y } }\n";

// A pool from which rules are drawn.
struct RulePool {
  std::vector<std::string> schema, negating, likes;
  int schema_percent, negating_percent;
  std::vector<std::string> unusual;  // facts, told now and then
};

// Seeds from `first` to `last`.
void CheckNegationBeside(const RulePool& pool, int first, int last) {
  Tally tally;
  for (int seed = first; seed <= last; ++seed) {
    RandomWorld random(static_cast<unsigned>(seed));
    random.schema_percent = 10 + random.Pick(30);
    const auto property = [&] { return (random.Chance(60) ? "p" : "q") + std::to_string(random.Pick(4)); };
    const auto some = [&] {
      std::string rules;
      const bool whole_equality = random.Chance(50);
      for (const auto& [from, percent] :
           {std::pair(&pool.schema, pool.schema_percent), std::pair(&pool.likes, 60)}) {
        for (const std::string& rule : *from) {
          const bool of_equality =
              rule.find("owl:sameAs ?") != rule.npos && rule.find("Functional") == rule.npos;
          if (random.Chance(percent) || (of_equality && whole_equality)) rules += rule + "\n";
        }
      }
      for (const std::string& rule : pool.negating) {
        if (!random.Chance(pool.negating_percent)) continue;
        TestWorld world;
        rules::RuleEngine engine(world.dictionary);
        if (!HasErrors(engine.PutRules("rules", kRulesPrefix + rules + rule)) &&
            engine.Update(world.writer, {}).ok())
          rules += rule + "\n";
      }
      return rules;
    };
    const std::string rules = some();
    std::vector<Step> steps;
    std::set<std::string> told;
    for (int i = 0; i < 12; ++i) {
      Step step{random.Batch(told), {}};
      std::set<std::string> used(step.batch.add.begin(), step.batch.add.end());
      used.insert(step.batch.remove.begin(), step.batch.remove.end());
      const auto turn_over = [&](const std::string& fact) {
        if (!used.insert(fact).second) return;
        const bool is_told = told.erase(fact) != 0;
        if (!is_told) told.insert(fact);
        (is_told ? step.batch.remove : step.batch.add).push_back(fact);
      };
      for (int k = random.Pick(4); k > 0; --k) {
        const std::array<const char*, 5> words = {" like ", " like1 ", " like2 ", " inv ", " dom "};
        const size_t word = static_cast<size_t>(random.Pick(5));
        turn_over(property() + words[word] + (word == 4 ? random.Node() : property()));
      }
      if (!pool.unusual.empty() && random.Chance(25))
        turn_over(pool.unusual[static_cast<size_t>(random.Pick(static_cast<int>(pool.unusual.size())))]);
      if (i > 0 && random.Chance(8)) step.new_rules = some();
      steps.push_back(std::move(step));
    }
    std::string trace;
    if (rules.empty() || FirstDifference(rules, steps, &trace, &tally) < 0) continue;
    FAIL() << "seed " << seed << "\n" << trace << "\n" << Shrink(rules, steps);
  }
  std::cout << tally.taken << " steps taken, " << tally.refused << " refused\n";
  EXPECT_GT(tally.taken, 2 * tally.refused);
  EXPECT_GT(tally.refused, 0);
}

TEST(ReasonerRulesProperty, NegationBesideASchema) {
  std::vector<std::string> schema = Lines(kSchemaRules);
  schema.pop_back();
  CheckNegationBeside({schema, Lines(kNegatingRules), Lines(kLikes), 60, 50, {}}, 1, SequenceCount());
}

// One rule a line, and without names.
std::vector<std::string> RdfsRules() {
  std::vector<std::string> rules;
  for (const std::string& line : Lines(rules::BuiltInRuleSet("rdfs"))) {
    if (line.starts_with("PREFIX")) continue;
    if (line.starts_with("RULE")) {
      rules.push_back("RULE " + line.substr(line.find('{')));
    } else {
      rules.back() += line;
    }
  }
  return rules;
}

// The axiomatic triples, one by one.
std::vector<std::string> RdfsAxioms(const std::string& rule) {
  std::vector<std::string> axioms;
  const size_t begin = rule.find('{') + 1, end = rule.find('}');
  for (const std::string& axiom :
       std::vector<std::string>(absl::StrSplit(rule.substr(begin, end - begin), " . "))) {
    axioms.push_back("RULE { " + axiom + " } WHERE { }");
  }
  return axioms;
}

// Rules about classes and properties, some of which would make axioms or negate their results.
constexpr char kNegatingClasses[] =
    "RULE { ?c :q2 :n1 } WHERE { ?c a rdfs:Class NOT { ?c rdfs:subClassOf :n0 } }\n"
    "RULE { ?x :p3 ?c } WHERE { ?x :p0 ?c NOT { ?c rdfs:subClassOf ?c } }\n"
    "RULE { ?x rdfs:subClassOf ?x } WHERE { ?x :p1 ?y NOT { ?y a :n3 } }\n"
    "RULE { ?x a rdfs:Class } WHERE { ?x :p2 ?y NOT { ?x :p3 ?y } }\n"
    "RULE { ?x a :n4 } WHERE { ?x :p2 ?y NOT { ?x rdfs:subClassOf rdfs:Resource } }\n"
    "RULE { :n4 :q1 ?n } WHERE { { SELECT (COUNT(?d) AS ?n) WHERE { ?d rdfs:subClassOf :n0 } } }\n"
    "RULE { ?x :q0 ?p } WHERE { ?p a rdf:Property . ?x :p0 ?y NOT { ?p rdfs:subPropertyOf :p1 } }\n";

// In halves: the whole takes 330 s under the sanitizers, and a test has 300 s.
class ReasonerRulesBesideRdfs : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Halves, ReasonerRulesBesideRdfs, testing::Values(0, 1));

TEST_P(ReasonerRulesBesideRdfs, Negation) {
  const std::vector<std::string> all = RdfsRules();
  RulePool some;  // of the axiomatic triples a few: the reference is slow
  some.schema_percent = 93;
  some.negating_percent = 35;
  some.negating = Lines(kNegatingRules);
  some.likes = Lines(kLikes);
  for (const std::string& rule : all) {
    if (!rule.ends_with("WHERE { }")) {
      some.schema.push_back(rule);
      continue;
    }
    for (const std::string& axiom : RdfsAxioms(rule)) some.likes.push_back(axiom);
  }
  for (const std::string& rule : Lines(kNegatingClasses)) some.negating.push_back(rule);
  some.unusual = {"p0 rdfs:subPropertyOf rdfs:subClassOf",
                  "rdfs:subClassOf rdfs:subPropertyOf p1",
                  "rdf:type rdfs:subPropertyOf q1",
                  "rdfs:Resource rdfs:subClassOf n1",
                  "rdfs:Class rdfs:subClassOf n2",
                  "n3 rdfs:subClassOf rdfs:Class",
                  "n3 rdfs:subClassOf rdfs:Datatype",
                  "p2 a rdfs:ContainerMembershipProperty",
                  "p2 rdfs:range rdfs:Class",
                  "n1 rdf:_1 n2",
                  "rdfs:member rdfs:domain n1",
                  "rdfs:subClassOf rdfs:subPropertyOf rdfs:subPropertyOf",
                  "rdfs:subPropertyOf rdfs:subPropertyOf p1",
                  "rdf:Property rdfs:subClassOf n0",
                  "q0 rdfs:subPropertyOf rdf:type",
                  "n0 a rdfs:Class",
                  "q3 rdfs:domain n3",
                  "n2 rdfs:subClassOf n3"};
  const int half = SequenceCount() / 2;
  CheckNegationBeside(some, GetParam() == 0 ? 1 : half + 1, GetParam() == 0 ? half : SequenceCount());
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

std::string Try(const std::string& rules, const std::vector<Step>& steps) {
  std::string trace;
  FirstDifference(rules, steps, &trace);
  return trace;
}

constexpr char kSub[] =
    "RULE { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y }\n"
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?x :h ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n";

// Facts made too early by the order of the former axioms are removed again.
TEST(ReasonerRulesKnown, WhatWasRemadeIsTakenBackToo) {
  const std::string without = kSub;
  const std::string with = without + "RULE { ?x :u ?y } WHERE { ?x :z ?y }\n";
  EXPECT_EQ(Try(with, {{{{"a k b", "a z b"}, {}}, {}}, {{{"h like t", "t like u", "a m b"}, {}}, without}}),
            "");
}

TEST(ReasonerRulesKnown, WhatALowerStratumRemadeIsTakenBackToo) {
  const std::string rules =
      "RULE { ?x ?p2 :v } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 :v }\n"
      "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
      "RULE { ?x :low :w } WHERE { ?x :z0 :w }\n"
      "RULE { ?x :h2 :v } WHERE { ?x :hh :v NOT { ?x :low :w } }\n"
      "RULE { ?x :u :v } WHERE { ?x :z :w }\n"
      "RULE { ?x :h :v } WHERE { ?x :k :v NOT { ?x :m :v } }\n";
  EXPECT_EQ(
      Try(rules, {{{{"a k v", "a z w"}, {}}, {}}, {{{"h like t", "t like u", "a m v"}, {"a z w"}}, {}}}), "");
}

TEST(ReasonerRulesKnown, ProofsOfAnEarlierPassAreForgotten) {
  // c1 told and made by a UNION rule; f rests on c1 and on q
  const std::string rules = std::string(kSub) +
                            "RULE { ?x :c ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
                            "RULE { ?x :f ?y } WHERE { ?x :c ?y }\n"
                            "RULE { ?x :f ?y } WHERE { ?x :q ?y }\n";
  EXPECT_EQ(Try(rules,
                {{{{"a k b", "a z b", "a c b", "a q b"}, {}}, {}}, {{{"h like t"}, {"a c b", "a q b"}}, {}}}),
            "");
}

TEST(ReasonerRulesKnown, WhatIsTakenBackIsNoAxiom) {
  const std::string rules =
      "RULE { ?x ?p2 :v } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 :v }\n"
      "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
      "RULE { ?x :h :v } WHERE { ?x :k :v NOT { ?x :m :v } }\n"
      "RULE { ?x :got :w } WHERE { ?p rdfs:domain :v . ?x ?p ?y }\n";
  EXPECT_EQ(Try(rules, {{{{"pp k v", "x pp y"}, {}}, {}},
                        {{{"h like rdfs:domain", "pp m v"}, {}}, {}},
                        {{{"z pp y2"}, {}}, {}}}),
            "");
}

constexpr char kCOld[] =
    "RULE { ?x :q0 ?y } WHERE { ?x :p2 ?y NOT { ?y a :n0 } }\n"
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?a :like ?b } WHERE { { ?a :like1 ?b } UNION { ?a :like2 ?b } }\n"
    "RULE { ?x :p0 ?y } WHERE { { ?x :p1 ?y } UNION { ?x :q0 ?y } }\n";
constexpr char kCNew[] =
    "RULE { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y FILTER(?p1 != ?p2) }\n"
    "RULE { ?x :q3 ?y } WHERE { ?x :p1 ?y NOT { ?x :p3 ?y } NOT { ?y :q2 ?x } }\n"
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?x :p0 ?y } WHERE { { ?x :p1 ?y } UNION { ?x :q0 ?y } }\n";

TEST(ReasonerRulesKnown, ALevelThatFalls) {
  EXPECT_EQ(Try(kCOld, {{{{"q3 like1 p1", "n1 p2 n2"}, {}}, {}}, {{{"p0 like q0"}, {}}, kCNew}}), "");
}

TEST(ReasonerRulesKnown, ALevelThatFallsRefusesNothing) {
  EXPECT_EQ(Try(kCOld, {{{{"q3 like1 p1", "h p2 m"}, {}}, {}},
                        {{{"p0 like q0"}, {}},
                         std::string(kCNew) + "RULE { ?x rdfs:subPropertyOf ?y } WHERE { ?x :q0 ?y }\n"
                                              "RULE { ?x :h ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"}}),
            "");
}

TEST(ReasonerRulesKnown, ALevelThatFallsByAFact) {
  EXPECT_EQ(Try(kCNew,
                {{{{"q3 like p1", "n1 q0 n2"}, {}}, {}}, {{{"p0 like q0"}, {"q3 like p1", "n1 q0 n2"}}, {}}}),
            "");
}

TEST(ReasonerRulesKnown, APremiseThatComesBackAfterItsRuleLeft) {
  const std::string stay =
      "RULE { ?x :u ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
      "RULE { ?x :m ?y } WHERE { ?x :mm ?y }\n"
      "RULE { ?x :s ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :t ?y } WHERE { ?x :u ?y . ?x :s ?y }\n";
  const std::string leave = "RULE { ?x :u ?y } WHERE { ?x :l ?y }\nRULE { ?x :t ?y } WHERE { ?x :l ?y }\n";
  EXPECT_EQ(Try(stay + leave, {{{{"a z b", "a k b", "a l b"}, {}}, {}}, {{{"n p n"}, {}}, stay}}), "");
}

TEST(ReasonerRulesKnown, APremiseThatComesBackAfterItWasTold) {
  const std::string stay =
      "RULE { ?x :u ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
      "RULE { ?x :m ?y } WHERE { ?x :mm ?y }\n"
      "RULE { ?x :s ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :t ?y } WHERE { ?x :u ?y . ?x :s ?y }\n";
  EXPECT_EQ(Try(stay, {{{{"a z b", "a k b", "a u b", "a t b"}, {}}, {}}, {{{}, {"a t b", "a u b"}}, {}}}),
            "");
}

TEST(ReasonerRulesKnown, APremiseThatComesBack) {
  const std::string stay =
      "RULE { ?x :u ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
      "RULE { ?x :u ?y } WHERE { ?x :l ?y }\n"
      "RULE { ?x :t ?y } WHERE { ?x :l ?y }\n"
      "RULE { ?x :m ?y } WHERE { ?x :mm ?y }\n"
      "RULE { ?x :s ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :t ?y } WHERE { ?x :u ?y . ?x :s ?y }\n";
  EXPECT_EQ(Try(stay, {{{{"a z b", "a k b", "a l b"}, {}}, {}}, {{{}, {"a l b"}}, {}}}), "");
}

// It is above its premise, which is lost and made again by a fact of the same turn.
TEST(ReasonerRulesKnown, WhatRestsOnWhatIsMadeAnewIsMadeAnewToo) {
  const std::string rules = std::string(kSub) +
                            "RULE { ?x :b ?y } WHERE { ?x :c ?y }\n"
                            "RULE { ?x :a :v } WHERE { ?x :b ?y }\n"
                            "RULE { ?x :i ?y } WHERE { ?x :a ?y }\n"
                            "RULE { ?x :i ?y } WHERE { ?x :h ?y }\n";
  EXPECT_EQ(Try(rules, {{{{"x c y1"}, {}}, {}}, {{{"x c y2"}, {"x c y1"}}, {}}}), "");
}

}  // namespace
}  // namespace docent
