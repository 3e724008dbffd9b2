#include "reasoner/explain/display.h"

namespace docent::explain {
namespace {

using sparql::Algebra;
using sparql::Expression;
using sparql::PatternTerm;

void Substitute(PatternTerm& term, const Values& values) {
  if (!term.IsVariable()) return;
  const auto found = values.find(term.variable().name);
  if (found != values.end()) term = found->second;
}

void Rename(sparql::Variable& variable, const Values& values) {
  PatternTerm term = PatternTerm::Of(variable);
  Substitute(term, values);
  if (term.IsVariable()) variable = term.variable();
}

void Substitute(Algebra& node, const Values& values);

void Substitute(Expression& e, const Values& values) {
  if (e.kind == Expression::Kind::kVariable) {
    PatternTerm term = PatternTerm::Of(e.variable);
    Substitute(term, values);
    if (!term.IsVariable()) e.kind = Expression::Kind::kTerm;
    e.term = term.term();
    Rename(e.variable, values);
  }
  for (const auto& argument : e.arguments) Substitute(*argument, values);
  if (e.pattern) Substitute(*e.pattern, values);
}

void Substitute(Algebra& node, const Values& values) {
  // A SELECT is left as written: its head names its variables, and some are local.
  if (node.kind == Algebra::Kind::kProject || node.kind == Algebra::Kind::kGroup) return;
  for (sparql::TriplePattern& triple : node.triples) {
    Substitute(triple.subject, values);
    Substitute(triple.predicate, values);
    Substitute(triple.object, values);
  }
  Substitute(node.subject, values);
  Substitute(node.object, values);
  if (node.kind == Algebra::Kind::kGraph) Substitute(node.name, values);
  Rename(node.variable, values);
  for (sparql::Variable& variable : node.variables) Rename(variable, values);
  if (node.expression) Substitute(*node.expression, values);
  for (const auto& child : node.children) Substitute(*child, values);
}

}  // namespace

Values ValuesOf(const Row& row, const Dictionary& dictionary,
                const absl::flat_hash_map<int, std::string>& names) {
  Values values;
  for (size_t v = 0; v < row.values.size(); ++v) {
    PatternTerm shown;
    if (!row.values[v].IsNone()) {
      shown = PatternTerm::Of(dictionary.Decode(row.values[v]));
    } else if (const auto called = names.find(row.open[v]); called != names.end()) {
      shown = PatternTerm::Of(sparql::Variable{called->second});
    } else {
      continue;
    }
    values.emplace(row.clause->names[v], shown);
    if (!row.clause->written[v].empty()) values.emplace(row.clause->written[v], shown);
  }
  return values;
}

Display::Display(std::vector<std::pair<std::string, std::string>> prefixes) {
  options_.prefixes = std::move(prefixes);
  options_.declare_prefixes = false;
}

std::string Display::Of(const Term& term) const {
  Expression e(Expression::Kind::kTerm, {});
  e.term = term;
  return sparql::PrintExpression(e, options_);
}

std::string Display::Fact(const TermQuad& fact) const {
  return Fact(sparql::TriplePattern{PatternTerm::Of(fact.subject), PatternTerm::Of(fact.predicate),
                                    PatternTerm::Of(fact.object)});
}

std::string Display::Fact(const sparql::TriplePattern& fact) const {
  return sparql::PrintTriple(fact, options_);
}

std::string Display::Filter(const Expression& expression, const Values& values) const {
  sparql::ExpressionPtr copy = expression.Clone();
  Substitute(*copy, values);
  return sparql::OnOneLine(sparql::PrintExpression(*copy, options_));
}

std::string Display::Pattern(const Algebra& pattern, const Values& values) const {
  sparql::AlgebraPtr copy = pattern.Clone();
  Substitute(*copy, values);
  std::string text = sparql::OnOneLine(sparql::PrintPattern(*copy, options_));
  if (text.empty() || text[0] != '{') text = "{ " + text + " }";
  if (text.size() > 4 && text.ends_with(" . }")) text = text.substr(0, text.size() - 4) + " }";
  return text;
}

}  // namespace docent::explain
