// Sequences of additions, removals and rule changes, on which a rule engine is compared with a computation from scratch
// (naive_rules.h).
#ifndef DOCENT_TESTS_PROPERTY_RULE_SEQUENCES_H_
#define DOCENT_TESTS_PROPERTY_RULE_SEQUENCES_H_

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

inline std::set<Quad> InferredQuads(TestWorld& world) {
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
inline bool IsRefused(const std::string& rules, const std::set<std::string>& told,
                      const std::string& set = "") {
  TestWorld world;
  rules::RuleEngine engine(world.dictionary);
  if (!set.empty()) engine.PutRules(set, rules::BuiltInRuleSet(set));
  EXPECT_FALSE(HasErrors(engine.PutRules("rules", kRulesPrefix + rules)));
  return !engine.Update(world.writer, world.Apply({told.begin(), told.end()})).ok();
}

// What a new engine infers, with a built-in set.
inline std::vector<std::string> FreshInferences(const std::string& rules, const std::set<std::string>& told,
                                                const std::string& set) {
  TestWorld world;
  rules::RuleEngine engine(world.dictionary);
  engine.PutRules(set, rules::BuiltInRuleSet(set));
  EXPECT_FALSE(HasErrors(engine.PutRules("rules", kRulesPrefix + rules)));
  EXPECT_TRUE(engine.Update(world.writer, world.Apply({told.begin(), told.end()})).ok());
  return world.Inferred();
}

// Number of refused and accepted steps when rules with negation are entangled with others.
struct Tally {
  int refused = 0, taken = 0;
};

// The first step after which the two differ, or -1. `trace` explains it. A refused step changes nothing. `set`: a
// built-in set beside the rules; the reference is then a new engine, which is faster.
inline int FirstDifference(const std::string& rules, const std::vector<Step>& steps, std::string* trace,
                           Tally* tally = nullptr, const std::string& set = "") {
  TestWorld world;
  // The order of ids is the order in which changes are processed; it must not depend on the rules alone.
  for (size_t i = 0; i < 4; ++i) world.Id("p" + std::to_string((i * 3 + rules.size()) % 4));
  Limits limits;
  limits.inferred_per_turn =
      20000;  // far more than so few things have facts: what goes on without end fails soon
  rules::RuleEngine engine(world.dictionary, limits);
  std::string current = rules;
  if (!set.empty()) engine.PutRules(set, rules::BuiltInRuleSet(set));
  if (HasErrors(engine.PutRules("rules", kRulesPrefix + rules))) return -1;
  if (!engine.Update(world.writer, {}).ok()) {  // by axioms that the rules bring along
    EXPECT_TRUE(IsRefused(rules, {}, set));
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
          delta.status().code() == absl::StatusCode::kFailedPrecondition && IsRefused(current, told, set);
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
    const std::vector<std::string> got = world.Inferred();
    const std::vector<std::string> expected =
        set.empty() ? NaiveInferences(current, told) : FreshInferences(current, told, set);
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

inline std::vector<std::string> Lines(const std::string& rules) {
  std::vector<std::string> lines = absl::StrSplit(rules, '\n', absl::SkipEmpty());
  return lines;
}

// Leaves out rules, steps and single changes as long as it still fails.
inline std::string Shrink(std::string rules, std::vector<Step> steps, const std::string& set = "") {
  steps.resize(static_cast<size_t>(FirstDifference(rules, steps, nullptr, nullptr, set)) + 1);
  for (bool smaller = true; smaller;) {
    smaller = false;
    const auto attempt = [&](const std::string& fewer_rules, const std::vector<Step>& fewer) {
      if (FirstDifference(fewer_rules, fewer, nullptr, nullptr, set) < 0) return false;
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
  FirstDifference(rules, steps, &trace, nullptr, set);
  return trace;
}

inline int SequenceCount() {
  const char* asked = std::getenv("DOCENT_PROPERTY_SEQUENCES");
  return asked == nullptr ? 500 : std::atoi(asked);
}

// Rules with a schema part, over a schema that changes as often as the data: equal things, inverse and
// transitive properties, restrictions, in every combination. One rule a line, so that they shrink.
inline constexpr char kSchemaRules[] =
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

}  // namespace docent

#endif  // DOCENT_TESTS_PROPERTY_RULE_SEQUENCES_H_
