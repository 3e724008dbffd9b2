// The same of rules with negation beside rules of a schema, whose axioms may entangle them: what is refused is what a new
// engine refuses.
#include <gtest/gtest.h>

#include "reasoner/rules/rule_sets.h"
#include "tests/property/rule_sequences.h"

namespace docent {
namespace {

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

// Checks, and rules with patterns that would match the reports of checks.
constexpr char kChecks[] =
    "RULE { } WHERE { ?x :q0 ?y , ?z FILTER(STR(?y) < STR(?z)) }\n"
    "RULE { } WHERE { ?x a :n0 . ?x a :n3 }\n"
    "RULE { } WHERE { ?x :p2 ?y NOT { ?y a :n1 } }\n"
    "RULE { } WHERE { ?x :p3 ?y MINUS { ?x :q2 ?y } }\n"
    "RULE { } WHERE { { SELECT ?x (COUNT(?y) AS ?n) WHERE { ?x :q3 ?y } GROUP BY ?x } FILTER(?n > 1) }\n"
    "RULE { } WHERE { ?x :p1 ?y NOT { ?x a ?c } }\n"
    "RULE { } WHERE { ?x ?p ?y . ?y ?p ?x }\n"
    "RULE { } WHERE { { SELECT (COUNT(*) AS ?n) WHERE { ?s ?p ?o } } }\n"
    "RULE { ?x :p1 ?c } WHERE { ?x a ?c . ?x ?p ?y }\n"
    "RULE { ?x :p2 ?y } WHERE { ?e rdf:subject ?x ; rdf:object ?y }\n"
    "RULE { :all :p1 ?n } WHERE { { SELECT (COUNT(?e) AS ?n) WHERE { ?e rdf:object ?o } } }\n"
    "RULE { ?x :untold ?y } WHERE { ?x :p0 ?y NOT { ?e rdf:subject ?x } }\n"
    "RULE { ?x :typeless ?y } WHERE { ?x :p1 ?y MINUS { ?x a ?c } }\n";

// A pool from which rules are drawn.
struct RulePool {
  std::vector<std::string> schema, negating, likes;
  int schema_percent, negating_percent;
  std::vector<std::string> unusual;  // facts, told now and then
  std::string set;  // a built-in set that is always there: the reference is then a new engine
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
        if (!pool.set.empty()) engine.PutRules(pool.set, rules::BuiltInRuleSet(pool.set));
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
    if (rules.empty() || FirstDifference(rules, steps, &trace, &tally, pool.set) < 0) continue;
    FAIL() << "seed " << seed << "\n" << trace << "\n" << Shrink(rules, steps, pool.set);
  }
  std::cout << tally.taken << " steps taken, " << tally.refused << " refused\n";
  EXPECT_GT(tally.taken, 2 * tally.refused);
  EXPECT_GT(tally.refused, 0);
}

TEST(ReasonerRulesProperty, NegationBesideASchema) {
  std::vector<std::string> schema = Lines(kSchemaRules);
  schema.pop_back();
  CheckNegationBeside({schema, Lines(kNegatingRules), Lines(kLikes), 60, 50, {}, ""}, 1, SequenceCount());
}

// Facts in the words of reports, and axioms about these words.
const std::vector<std::string> kReportWords = {"docent:Inconsistency rdfs:subClassOf n4",
                                               "docent:rule rdfs:domain n4",
                                               "docent:evidence rdfs:subPropertyOf q0",
                                               "rdf:subject rdfs:subPropertyOf p0",
                                               "p0 rdf:subject p1",
                                               "p0 rdf:object p2",
                                               "n1 a docent:Inconsistency",
                                               "docent:Inconsistency owl:sameAs n3"};

std::vector<std::string> NegatingRulesAndChecks() {
  std::vector<std::string> rules = Lines(kNegatingRules);
  for (const std::string& rule : Lines(kChecks)) rules.push_back(rule);
  return rules;
}

TEST(ReasonerRulesProperty, ChecksAndNegationBesideASchema) {
  std::vector<std::string> schema = Lines(kSchemaRules);
  schema.pop_back();
  CheckNegationBeside({schema, NegatingRulesAndChecks(), Lines(kLikes), 60, 35, kReportWords, ""}, 1,
                      SequenceCount() / 2);
}

// Of sequences one in `share`: each turn is compared with a new engine, which is slow beside owl2rl.
struct BuiltInSet {
  const char* name;
  int share;
};
class ReasonerRulesBesideASet : public testing::TestWithParam<BuiltInSet> {};
INSTANTIATE_TEST_SUITE_P(Sets, ReasonerRulesBesideASet,
                         testing::Values(BuiltInSet{"rdfs", 10}, BuiltInSet{"owl2rl", 20}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(ReasonerRulesBesideASet, ChecksAndNegation) {
  CheckNegationBeside({{}, NegatingRulesAndChecks(), {}, 0, 35, kReportWords, GetParam().name}, 1,
                      SequenceCount() / GetParam().share);
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

}  // namespace
}  // namespace docent
