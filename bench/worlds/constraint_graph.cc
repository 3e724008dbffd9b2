#include "bench/worlds/constraint_graph.h"

#include <cstdio>
#include <cstdlib>

#include "graph/sparql/syntax/parser.h"

namespace docent::bench {

ConstraintGraph::ConstraintGraph(size_t constraints) {
  std::vector<Quad> quads;
  for (const TermQuad& fact : ConstraintBackground(constraints)) quads.push_back(Encode(fact));
  writer_.AddAll(quads);
  Freeze();
}

Quad ConstraintGraph::Encode(const TermQuad& fact) {
  return {dictionary_.Intern(fact.subject), dictionary_.Intern(fact.predicate),
          dictionary_.Intern(fact.object), graph_};
}

sparql::Query ParseConstraint(const std::string& text) {
  sparql::ParseOptions options;
  options.prefixes = {{"", kConstraintNs}};
  sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (!parsed.ok()) {
    std::fprintf(stderr, "%s", Render(parsed.diagnostics, text).c_str());
    std::exit(1);
  }
  return std::move(parsed.query);
}

ConstraintQueries ParseConstraints(size_t count) {
  ConstraintQueries queries;
  for (size_t i = 0; i < count; ++i) {
    const StandingConstraint constraint = StandingConstraintNumber(i);
    queries.emplace_back(ParseConstraint(constraint.ask), conditions::RegisterOptions{constraint.keys, 0});
  }
  return queries;
}

std::vector<conditions::ConditionId> RegisterAll(const ConstraintQueries& queries,
                                                 const ConstraintGraph& graph,
                                                 conditions::StandingConditions& set) {
  std::vector<conditions::ConditionId> ids;
  for (const auto& [query, options] : queries) {
    const auto id = set.Register(query, graph.version(), options);
    if (!id.ok()) {
      std::fprintf(stderr, "%s\n", id.status().ToString().c_str());
      std::exit(1);
    }
    ids.push_back(*id);
  }
  set.Commit();
  return ids;
}

}  // namespace docent::bench
