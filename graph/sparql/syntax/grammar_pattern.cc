#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/grammar.h"
#include "graph/sparql/values/text.h"

namespace docent::sparql {

using Kind = Algebra::Kind;

namespace {

constexpr size_t kBytesOfColumn = 200;  // of a variable here, in the plan and on the way

}  // namespace

AlgebraPtr Grammar::GroupGraphPattern() {
  Group group;
  if (!GroupWithFilter(&group)) return nullptr;
  if (!group.filter) return std::move(group.pattern);
  auto filter = NewAlgebra(Kind::kFilter, group.pattern->span);
  filter->children.push_back(std::move(group.pattern));
  filter->expression = std::move(group.filter);
  return filter;
}

// GroupGraphPattern ::= '{' ( SubSelect | GroupGraphPatternSub ) '}'. Translated as in section 18.2.2.6.
bool Grammar::GroupWithFilter(Group* group) {
  Nested nested(this);
  const SourceSpan span = Peek().span;
  if (!nested.ok() || !Expect("{", "to open a group")) return false;
  ++bgp_;
  std::vector<Aggregate>* outer_aggregates = std::exchange(aggregates_, nullptr);
  const bool outer_in_aggregate = std::exchange(in_aggregate_, false);
  OpenGroup open;
  if (AtWord("SELECT")) {
    open.pattern = SubSelect();
    if (!open.pattern) RecoverInGroup();
  } else {
    while (!At("}") && Peek().kind != TokenKind::kEnd) {
      if (!GroupElement(&open)) RecoverInGroup();
    }
  }
  aggregates_ = outer_aggregates;
  in_aggregate_ = outer_in_aggregate;
  ++bgp_;
  if (!Accept("}")) {
    Unclosed(span);
    return false;
  }
  group->pattern = open.pattern ? std::move(open.pattern) : NewAlgebra(Kind::kBgp, span);
  if (open.filters.size() == 1) {
    group->filter = std::move(open.filters[0]);
  } else if (open.filters.size() > 1) {
    group->filter = NewExpression(Expression::Kind::kAnd, open.filters[0]->span);
    group->filter->arguments = std::move(open.filters);
  }
  return true;
}

void Grammar::Unclosed(const SourceSpan& opened) {
  Error(Peek().span, "expected '}' to close the group opened in line " + std::to_string(opened.line) +
                         ", column " + std::to_string(opened.column) + ", not " + Describe(Peek()));
}

// Skips to where the next element can begin: after a '.', before '}', or after the ')' that ends a broken
// FILTER or BIND.
void Grammar::RecoverInGroup() {
  for (int open = 0, parentheses = 0; Peek().kind != TokenKind::kEnd;) {
    if (At("}") && open == 0) return;
    const Token token = Take();
    if (token.Is("{")) ++open;
    if (token.Is("}")) --open;
    if (token.Is("(")) ++parentheses;
    if (token.Is(")")) --parentheses;
    if (open != 0) continue;
    if (token.Is(".") && parentheses <= 0) return;
    const TokenKind next = Peek().kind;
    const bool begins = next == TokenKind::kVariable || next == TokenKind::kIri ||
                        next == TokenKind::kPrefixedName || next == TokenKind::kBlankLabel ||
                        next == TokenKind::kWord || At("{");
    if (token.Is(")") && parentheses < 0 && begins) return;
  }
}

bool Grammar::GroupElement(OpenGroup* group) {
  if (At("{")) return GroupOrUnion(group);
  if (Peek().kind != TokenKind::kWord) return TriplesBlock(group);
  if (AtWord("FILTER")) return FilterElement(group);
  if (AtWord("OPTIONAL")) return OptionalElement(group);
  if (AtWord("BIND")) return BindElement(group);
  if (AtWord("MINUS")) return MinusElement(group);
  if (AtWord("GRAPH")) return GraphElement(group);
  if (AtWord("SERVICE")) return ServiceElement(group);
  if (options_.rule_elements && AtWord("NOT")) return NotElement(group);
  if (options_.rule_elements && AtWord("SET")) return SetElement(group);
  if (AcceptWord("VALUES")) {
    CloseBgp(group);
    AlgebraPtr values = DataBlock();
    if (!values) return false;
    AddToGroup(group, std::move(values));
    Accept(".");
    return true;
  }
  return TriplesBlock(group);
}

void Grammar::CloseBgp(OpenGroup* group) {
  group->bgp = nullptr;
  ++bgp_;
}

// Join, with an empty left side and nested joins simplified away (joins are associative).
void Grammar::AddToGroup(OpenGroup* group, AlgebraPtr element) {
  if (element->kind != Kind::kBgp) CountElement(element->span);
  if (!group->pattern) {
    group->pattern = std::move(element);
  } else if (group->pattern->kind == Kind::kJoin) {
    group->pattern->children.push_back(std::move(element));
  } else {
    auto join = NewAlgebra(Kind::kJoin, group->pattern->span);
    join->children.push_back(std::move(group->pattern));
    join->children.push_back(std::move(element));
    group->pattern = std::move(join);
  }
}

bool Grammar::TriplesBlock(OpenGroup* group) {
  const SourceSpan span = Peek().span;
  TriplesSink sink;
  if (group->bgp != nullptr) sink.triples.swap(group->bgp->triples);  // continue them
  const auto end = [&](bool ok) {  // a broken triple discards the triples before it
    if (group->bgp != nullptr) sink.triples.swap(group->bgp->triples);
    return ok;
  };
  while (true) {
    if (!TriplesSameSubject(&sink)) return false;
    if (!sink.triples.empty() && group->bgp == nullptr) {
      auto bgp = NewAlgebra(Kind::kBgp, span);
      group->bgp = bgp.get();
      AddToGroup(group, std::move(bgp));
    }
    for (AlgebraPtr& path : sink.paths) AddToGroup(group, std::move(path));
    sink.paths.clear();
    const bool dot = Accept(".");
    const Token& next = Peek();
    const bool triple_may_follow =
        next.kind != TokenKind::kWord && !next.Is("{") && !next.Is("}") && next.kind != TokenKind::kEnd;
    if (!dot && triple_may_follow) {
      Expected("'.' or ';' after a triple",
               "triples are separated by '.'; ';' repeats the subject, ',' the predicate");
      return end(false);
    }
    if (!dot) return end(true);
    if (!triple_may_follow && !AtWord("true") && !AtWord("false")) return end(true);
  }
}

bool Grammar::OptionalElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  CloseBgp(group);
  if (!CountElement(span)) return false;
  Group right;
  if (!GroupWithFilter(&right)) return false;
  auto join = NewAlgebra(Kind::kLeftJoin, span);
  if (!group->pattern) group->pattern = NewAlgebra(Kind::kBgp, span);
  join->children.push_back(std::move(group->pattern));
  join->children.push_back(std::move(right.pattern));
  join->expression = std::move(right.filter);
  group->pattern = std::move(join);
  Accept(".");
  return true;
}

bool Grammar::MinusElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  CloseBgp(group);
  if (!CountElement(span)) return false;
  AlgebraPtr right = GroupGraphPattern();
  if (!right) return false;
  auto minus = NewAlgebra(Kind::kMinus, span);
  if (!group->pattern) group->pattern = NewAlgebra(Kind::kBgp, span);
  minus->children.push_back(std::move(group->pattern));
  minus->children.push_back(std::move(right));
  group->pattern = std::move(minus);
  Accept(".");
  return true;
}

bool Grammar::GraphElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  CloseBgp(group);
  std::optional<PatternTerm> name = VarOrIri();
  if (!name) return false;
  AlgebraPtr inner = GroupGraphPattern();
  if (!inner || !CountPattern()) return false;
  auto graph = NewAlgebra(Kind::kGraph, span);
  graph->name = *std::move(name);
  graph->children.push_back(std::move(inner));
  AddToGroup(group, std::move(graph));
  Accept(".");
  return true;
}

bool Grammar::ServiceElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  CloseBgp(group);
  const bool silent = AcceptWord("SILENT");
  std::optional<PatternTerm> name = VarOrIri();
  if (!name) return false;
  const bool outer = std::exchange(in_service_, true);
  AlgebraPtr inner = GroupGraphPattern();
  in_service_ = outer;
  if (!inner) return false;
  auto service = NewAlgebra(Kind::kService, span);
  service->name = *std::move(name);
  service->silent = silent;
  service->children.push_back(std::move(inner));
  AddToGroup(group, std::move(service));
  Accept(".");
  return true;
}

bool Grammar::BindElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  CloseBgp(group);
  if (!CountElement(span) || !Expect("(", "after BIND")) return false;
  ExpressionPtr expression = ParseExpression();
  if (!expression || !ExpectWord("AS", "and a variable: BIND(expression AS ?name)")) return false;
  if (Peek().kind != TokenKind::kVariable) {
    Expected("a variable after AS");
    return false;
  }
  const Token variable = Take();
  if (!Expect(")", "to close BIND")) return false;
  return Assign(group, span, variable, std::move(expression));
}

// NOT { pattern } is FILTER NOT EXISTS { pattern }.
bool Grammar::NotElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  const int bgp = bgp_;
  if (!CountElement(span)) return false;
  AlgebraPtr pattern = GroupGraphPattern();
  bgp_ = bgp;
  if (!pattern) return false;
  auto negation = NewExpression(Expression::Kind::kNotExists, span);
  negation->pattern = std::move(pattern);
  group->filters.push_back(std::move(negation));
  Accept(".");
  return true;
}

// SET(?x := expression) is BIND(expression AS ?x).
bool Grammar::SetElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  CloseBgp(group);
  if (!CountElement(span) || !Expect("(", "after SET")) return false;
  if (Peek().kind != TokenKind::kVariable) {
    Expected("a variable: SET(?name := expression)");
    return false;
  }
  const Token variable = Take();
  // The lexer of SPARQL reads ":=" as an empty prefixed name and "=".
  const bool colon = Peek().kind == TokenKind::kPrefixedName && Peek().text.empty() && Peek().prefix.empty();
  if (!colon) {
    Expected("':=' after the variable of SET");
    return false;
  }
  Take();
  if (!Expect("=", "after ':' in SET(?name := expression)")) return false;
  ExpressionPtr expression = ParseExpression();
  if (!expression || !Expect(")", "to close SET")) return false;
  return Assign(group, span, variable, std::move(expression));
}

bool Grammar::Assign(OpenGroup* group, const SourceSpan& span, const Token& variable,
                     ExpressionPtr expression) {
  if (group->pattern) {
    if (Look() && IsInScope(*group->pattern, variable.text)) {  // reads the whole group
      const std::string name = Concat("?", variable.text);
      Error(variable.span, name + " already has a value in this group, BIND cannot give it another",
            "use another name, or FILTER(" + name + " = …)");
    }
  } else {
    group->pattern = NewAlgebra(Kind::kBgp, span);
  }
  auto extend = NewAlgebra(Kind::kExtend, span);
  extend->children.push_back(std::move(group->pattern));
  extend->variable = Variable{std::string(variable.text)};
  extend->expression = std::move(expression);
  group->pattern = std::move(extend);
  Accept(".");
  return true;
}

bool Grammar::FilterElement(OpenGroup* group) {
  const SourceSpan span = Take().span;
  const int bgp = bgp_;  // a filter does not end the basic graph pattern around it (section 5.1)
  if (!CountElement(span)) return false;
  ExpressionPtr condition = Constraint();
  bgp_ = bgp;
  if (!condition) return false;
  group->filters.push_back(std::move(condition));
  Accept(".");
  return true;
}

bool Grammar::GroupOrUnion(OpenGroup* group) {
  CloseBgp(group);
  AlgebraPtr first = GroupGraphPattern();
  if (!first) return false;
  if (AtWord("UNION")) {
    auto all = NewAlgebra(Kind::kUnion, first->span);
    all->children.push_back(std::move(first));
    while (AcceptWord("UNION")) {
      AlgebraPtr next = GroupGraphPattern();
      if (!next || !CountPattern()) return false;
      all->children.push_back(std::move(next));
    }
    first = std::move(all);
  }
  AddToGroup(group, std::move(first));
  Accept(".");
  return true;
}

// DataBlock ::= Var '{' value* '}' | '(' Var* ')' '{' ( '(' value* ')' )* '}'
AlgebraPtr Grammar::DataBlock() {
  auto values = NewAlgebra(Kind::kValues, Peek().span);
  const bool one = Peek().kind == TokenKind::kVariable;
  if (one) {
    values->variables.push_back(Variable{std::string(Take().text)});
  } else {
    if (!Expect("(", "or a variable after VALUES")) return nullptr;
    NameNumbers named;
    for (; Peek().kind == TokenKind::kVariable && CountValue(); Drop()) {
      Charge(kBytesOfColumn);
      const Token& token = Peek();
      if (!named.Add(token.text, 0).second)
        Error(token.span, Concat("?", token.text, " occurs twice in VALUES"));
      values->variables.push_back(Variable{std::string(token.text)});
    }
    if (!Expect(")", "after the variables of VALUES")) return nullptr;
  }
  if (!Expect("{", "before the rows of VALUES")) return nullptr;
  const size_t width = values->variables.size();
  while (!At("}")) {
    const SourceSpan span = Peek().span;
    if (!one && !Expect("(", "before a row of VALUES")) return nullptr;
    if (width == 0 && !CountValue()) return nullptr;
    Charge(2 * sizeof(values->rows[0]) + kBytesOfAllocation + width * sizeof(std::optional<Term>));
    std::vector<std::optional<Term>> row;
    row.reserve(width);
    while (one ? row.empty() : !At(")")) {
      if (!CountValue()) return nullptr;
      if (AcceptWord("UNDEF")) {
        row.emplace_back();
        continue;
      }
      std::optional<Term> term = GroundTerm();
      if (!term) return nullptr;
      row.push_back(std::move(term));
    }
    if (!one) Take();
    if (row.size() != width) {
      Error(span,
            "this row has " + std::to_string(row.size()) + " values for " + std::to_string(width) +
                " variables",
            "write UNDEF for a value that is missing");
    }
    values->rows.push_back(std::move(row));
  }
  Take();
  return values;
}

}  // namespace docent::sparql
