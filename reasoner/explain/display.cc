#include "reasoner/explain/display.h"

namespace docent::explain {
namespace {

using sparql::Algebra;
using sparql::Expression;
using sparql::PatternTerm;

void Substitute(PatternTerm& term, const Values& values) {
  if (!term.IsVariable()) return;
  const auto found = values.find(term.variable->name);
  if (found != values.end()) term = PatternTerm::Of(found->second);
}

void Substitute(Algebra& node, const Values& values);

void Substitute(Expression& e, const Values& values) {
  if (e.kind == Expression::Kind::kVariable) {
    const auto found = values.find(e.variable.name);
    if (found != values.end()) {
      e.kind = Expression::Kind::kTerm;
      e.term = found->second;
    }
  }
  for (const auto& argument : e.arguments) Substitute(*argument, values);
  if (e.pattern) Substitute(*e.pattern, values);
}

void Substitute(Algebra& node, const Values& values) {
  for (sparql::TriplePattern& triple : node.triples) {
    Substitute(triple.subject, values);
    Substitute(triple.predicate, values);
    Substitute(triple.object, values);
  }
  Substitute(node.subject, values);
  Substitute(node.object, values);
  if (node.kind == Algebra::Kind::kGraph) Substitute(node.name, values);
  if (node.expression) Substitute(*node.expression, values);
  for (const auto& child : node.children) Substitute(*child, values);
}

void Rename(Expression& e, const std::map<std::string, std::string>& names) {
  if (e.kind == Expression::Kind::kVariable) {
    const auto found = names.find(e.variable.name);
    if (found != names.end()) e.variable.name = found->second;
  }
  for (const auto& argument : e.arguments) Rename(*argument, names);
}

// Runs of white space as one blank.
std::string OnOneLine(const std::string& text) {
  std::string out;
  for (char c : text) {
    const bool space = c == ' ' || c == '\n' || c == '\t';
    if (!space) {
      out += c;
    } else if (!out.empty() && out.back() != ' ') {
      out += ' ';
    }
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

}  // namespace

Values ValuesOf(const Clause& clause, absl::Span<const TermId> row, const Dictionary& dictionary) {
  Values values;
  for (size_t v = 0; v < clause.names.size() && v < row.size(); ++v) {
    if (row[v].IsNone()) continue;
    const Term term = dictionary.Decode(row[v]);
    values.emplace(clause.names[v], term);
    if (!clause.written[v].empty()) values.emplace(clause.written[v], term);
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

std::string Display::Filter(const Expression& expression, const Values& values,
                            const std::map<std::string, std::string>& names) const {
  sparql::ExpressionPtr copy = expression.Clone();
  Substitute(*copy, values);
  Rename(*copy, names);
  return OnOneLine(sparql::PrintExpression(*copy, options_));
}

std::string Display::Pattern(const Algebra& pattern, const Values& values) const {
  sparql::AlgebraPtr copy = pattern.Clone();
  Substitute(*copy, values);
  std::string text = OnOneLine(sparql::PrintPattern(*copy, options_));
  if (text.empty() || text[0] != '{') text = "{ " + text + " }";
  if (text.size() > 4 && text.ends_with(" . }")) text = text.substr(0, text.size() - 4) + " }";
  return text;
}

}  // namespace docent::explain
