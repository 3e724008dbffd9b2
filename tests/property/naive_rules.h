// Naive computation of the inferences of rules from asserted facts: the reference of the property tests. It
// shares the parser, the SPARQL evaluator, the strata and the form of reports with the engine.
#ifndef DOCENT_TESTS_PROPERTY_NAIVE_RULES_H_
#define DOCENT_TESTS_PROPERTY_NAIVE_RULES_H_

#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "graph/sparql/run/evaluator.h"
#include "reasoner/rules/equality_classes.h"
#include "reasoner/rules/inconsistency.h"
#include "reasoner/rules/negation_order.h"
#include "reasoner/rules/rule_parser.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"
#include "tests/reasoner/test_world.h"

namespace docent {

inline constexpr char kRulesPrefix[] = "PREFIX : <http://example.org/>\n";

// The strata of the engine's program, each applied naively, with those below it, until nothing is new. The
// order of rules with negation is checked at the end: all results of each rule are there, and each inferred
// fact is a result. The reports of checks come last. `set`: the name of the rule set, which reports bear.
inline std::vector<std::string> NaiveInferences(const std::string& rules, const std::set<std::string>& told,
                                                const std::string& set = "rules") {
  TestWorld world;
  world.Apply(std::vector<std::string>(told.begin(), told.end()));
  const TermId inferred = world.dictionary.InternIri(kInferredGraph);
  rules::RuleSets sets;
  sets[set] = std::make_shared<const rules::ParsedRules>(rules::ParseRules(kRulesPrefix + rules, set));
  Diagnostics diagnostics;
  const auto program = rules::RuleProgram::Build(sets, world.dictionary, nullptr, diagnostics);
  std::vector<std::unique_ptr<sparql::PreparedQuery>> constructs;
  for (const rules::Rule& rule : sets[set]->rules) {
    sparql::Query construct = rule.body.Clone();
    construct.form = sparql::Query::Form::kConstruct;
    construct.construct_template = rule.head;
    auto prepared = sparql::PreparedQuery::Prepare(construct, world.dictionary);
    EXPECT_TRUE(prepared.ok()) << prepared.status();
    constructs.push_back(*std::move(prepared));
  }
  for (int stratum = 0; stratum < program->stratum_count; ++stratum) {
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t r = 0; r < program->rules.size(); ++r) {
        if (program->rules[r].stratum > stratum) continue;
        const auto triples = constructs[r]->Construct({.version = &world.writer.current()});
        EXPECT_TRUE(triples.ok()) << triples.status();
        for (const TermQuad& t : *triples) {
          const Quad quad = {world.dictionary.Intern(t.subject), world.dictionary.Intern(t.predicate),
                             world.dictionary.Intern(t.object), inferred};
          if (world.writer.current().Scan({quad.subject, quad.predicate, quad.object, TermId()}).Valid())
            continue;
          changed = world.writer.Add(quad) || changed;
        }
      }
    }
    if (stratum != program->first_entangled || program->ordered.empty()) continue;
    rules::SchemaIndex schema;
    EXPECT_TRUE(schema.Build(*program, world.writer.current(), nullptr).ok());
    rules::EqualityClasses classes;
    world.writer.current().ForEach(
        {TermId(), world.dictionary.InternIri("http://www.w3.org/2002/07/owl#sameAs"), TermId(), TermId()},
        [&](const Quad& quad) {
          classes.Join(quad.subject, quad.object);
          return true;
        });
    const auto order =
        rules::OrderNegation(*program, schema, classes, world.writer.current(), world.dictionary);
    EXPECT_TRUE(order.ok()) << order.status();
    if (order.ok()) program->Place(*order);
  }
  std::set<Quad> made;
  for (const auto& construct : constructs) {
    const auto triples = construct->Construct({.version = &world.writer.current()});
    for (const TermQuad& t : *triples) {
      made.insert({world.dictionary.Intern(t.subject), world.dictionary.Intern(t.predicate),
                   world.dictionary.Intern(t.object), inferred});
    }
  }
  world.writer.current().ForEach({TermId(), TermId(), TermId(), inferred}, [&](const Quad& quad) {
    EXPECT_TRUE(made.contains(quad)) << "nothing makes " << world.Text(quad.subject) << " "
                                     << world.Text(quad.predicate) << " " << world.Text(quad.object)
                                     << " by\n"
                                     << rules;
    return true;
  });
  for (const Quad& quad : made) {
    EXPECT_TRUE(world.writer.current().ContainsMatch({quad.subject, quad.predicate, quad.object, TermId()}))
        << rules;
  }
  rules::InconsistencyFacts inconsistencies(world.dictionary);
  std::vector<rules::Triple> reports;
  for (const rules::CompiledRule& rule : program->rules) {
    if (!rule.check) continue;
    const std::vector<TermId> nothing(rule.body->columns().size());
    const absl::Status status =
        rule.body->Evaluate({.version = &world.writer.current()}, nothing, [&](absl::Span<const TermId> row) {
          inconsistencies.Make(rule, row, reports);
          return true;
        });
    EXPECT_TRUE(status.ok()) << status;
  }
  for (const rules::Triple& t : reports) world.writer.Add({t.subject, t.predicate, t.object, inferred});
  return world.Inferred();
}

}  // namespace docent

#endif  // DOCENT_TESTS_PROPERTY_NAIVE_RULES_H_
