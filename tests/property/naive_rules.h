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
// fact is a result.
inline std::vector<std::string> NaiveInferences(const std::string& rules, const std::set<std::string>& told) {
  TestWorld world;
  world.Apply(std::vector<std::string>(told.begin(), told.end()));
  const TermId inferred = world.dictionary.InternIri(kInferredGraph);
  rules::RuleSets sets;
  sets["rules"] =
      std::make_shared<const rules::ParsedRules>(rules::ParseRules(kRulesPrefix + rules, "rules"));
  Diagnostics diagnostics;
  const auto program = rules::RuleProgram::Build(sets, world.dictionary, nullptr, diagnostics);
  std::vector<std::unique_ptr<sparql::PreparedQuery>> constructs;
  for (const rules::Rule& rule : sets["rules"]->rules) {
    sparql::Query construct = rule.body.Clone();
    construct.form = sparql::Query::Form::kConstruct;
    construct.construct_template = rule.head;
    auto prepared = sparql::PreparedQuery::Prepare(construct, world.dictionary);
    EXPECT_TRUE(prepared.ok()) << prepared.status();
    constructs.push_back(*std::move(prepared));
  }
  rules::InconsistencyFacts inconsistencies(world.dictionary);
  inconsistencies.InternWords();
  // All results of a rule, in the graph of inferences.
  const auto results = [&](size_t r) {
    std::vector<Quad> quads;
    const rules::CompiledRule& rule = program->rules[r];
    if (rule.check) {
      std::vector<rules::Triple> facts;
      const std::vector<TermId> nothing(rule.body->columns().size());
      EXPECT_TRUE(rule.body
                      ->Evaluate({.version = &world.writer.current()}, nothing,
                                 [&](absl::Span<const TermId> row) {
                                   inconsistencies.Make(rule, row, facts);
                                   return true;
                                 })
                      .ok());
      for (const rules::Triple& t : facts) quads.push_back({t.subject, t.predicate, t.object, inferred});
      return quads;
    }
    const auto triples = constructs[r]->Construct({.version = &world.writer.current()});
    EXPECT_TRUE(triples.ok()) << triples.status();
    for (const TermQuad& t : *triples) {
      const rules::Triple made = {world.dictionary.Intern(t.subject), world.dictionary.Intern(t.predicate),
                                  world.dictionary.Intern(t.object)};
      if (!inconsistencies.IsOfReport(made))
        quads.push_back({made.subject, made.predicate, made.object, inferred});
    }
    return quads;
  };
  for (int stratum = 0; stratum < program->stratum_count; ++stratum) {
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t r = 0; r < program->rules.size(); ++r) {
        if (program->rules[r].stratum > stratum) continue;
        for (const Quad& quad : results(r)) {
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
  for (size_t r = 0; r < program->rules.size(); ++r) {
    for (const Quad& quad : results(r)) made.insert(quad);
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
  return world.Inferred();
}

}  // namespace docent

#endif  // DOCENT_TESTS_PROPERTY_NAIVE_RULES_H_
