#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

#include "graph/base/text.h"
#include "graph/sparql/syntax/builtins.h"
#include "graph/sparql/syntax/grammar.h"
#include "graph/sparql/syntax/name_numbers.h"

namespace docent::sparql {

using Kind = Algebra::Kind;

namespace {

constexpr size_t kBytesOfItem = 250;  // of a variable of SELECT or GROUP BY: here, in the plan and on the way
constexpr size_t kBytesOfPrefix = 200;  // beside its texts

}  // namespace

AlgebraPtr Grammar::Wrap(Kind kind, AlgebraPtr child) {
  AlgebraPtr node = NewAlgebra(kind, child->span);
  node->children.push_back(std::move(child));
  return node;
}

AlgebraPtr Grammar::Extend(AlgebraPtr child, Variable variable, ExpressionPtr expression) {
  CountElement(child->span);
  AlgebraPtr node = Wrap(Kind::kExtend, std::move(child));
  node->variable = std::move(variable);
  node->expression = std::move(expression);
  return node;
}

bool Grammar::Prologue() {
  while (true) {
    const Token& word = Peek();
    if (word.IsWord("PREFIX")) {
      if (!PrefixDeclaration()) return false;
    } else if (word.IsWord("BASE")) {
      if (!BaseDeclaration()) return false;
    } else {
      return true;
    }
  }
}

bool Grammar::BaseDeclaration() {
  Drop();
  if (Peek().kind != TokenKind::kIri) {
    Expected("an IRI in <> after BASE");
    return false;
  }
  std::string base;
  if (!Resolve(Peek(), &base)) return false;
  Drop();
  base_iri_ = std::move(base);
  return true;
}

bool Grammar::PrefixDeclaration() {
  Drop();
  const Token& name = Peek();
  if (name.kind != TokenKind::kPrefixedName || !name.text.empty()) {
    Expected("a prefix ending with ':' after PREFIX", "PREFIX ex: <http://example.org/>");
    return false;
  }
  const std::string_view prefix = name.prefix;  // valid as long as the lexer
  Drop();
  if (Peek().kind != TokenKind::kIri) {
    Expected("an IRI in <> after the prefix");
    return false;
  }
  std::string resolved;
  if (!Resolve(Peek(), &resolved)) return false;
  Drop();
  if (prefixes_.empty()) prefixes_.reserve(4);
  Charge(kBytesOfPrefix);
  declared_.Set(prefix, static_cast<int>(prefixes_.size()));
  prefixes_.emplace_back(prefix, std::move(resolved));
  return true;
}

bool Grammar::QueryUnit(Query* query) {
  if (!Prologue()) return false;
  bool ok = false;
  if (AtWord("SELECT")) {
    ok = SelectQuery(query);
  } else if (AtWord("ASK")) {
    ok = AskQuery(query);
  } else if (AtWord("CONSTRUCT")) {
    ok = ConstructQuery(query);
  } else if (AtWord("DESCRIBE")) {
    ok = DescribeQuery(query);
  } else {
    Expected("SELECT, ASK, CONSTRUCT or DESCRIBE",
             AtWord("INSERT") || AtWord("DELETE") ? "this is an update, not a query" : "");
  }
  if (!ok || failed()) return false;
  if (Peek().kind != TokenKind::kEnd) {
    Expected("the end of the query");
    return false;
  }
  query->base_iri = std::move(base_iri_);  // parsing is done: no further resolution
  query->prefixes = std::move(prefixes_);
  return true;
}

bool Grammar::SelectQuery(Query* query) {
  query->form = Query::Form::kSelect;
  std::vector<Aggregate> aggregates;
  aggregates_ = &aggregates;
  SelectClause select;
  if (!ParseSelectClause(&select) || !DatasetClauses(query)) return false;
  AlgebraPtr where = WhereClause();
  if (!where) return false;
  Modifiers modifiers;
  const bool modified = SolutionModifier(&modifiers);
  aggregates_ = nullptr;
  if (!modified) return false;
  query->algebra =
      ApplyModifiers(std::move(where), &select, &modifiers, std::move(aggregates), &query->projection);
  return true;
}

AlgebraPtr Grammar::SubSelect() {
  std::vector<Aggregate> aggregates;
  aggregates_ = &aggregates;
  const bool outer = std::exchange(in_aggregate_, false);
  SelectClause select;
  if (!ParseSelectClause(&select)) return nullptr;
  AlgebraPtr where = WhereClause();
  if (!where) return nullptr;
  Modifiers modifiers;
  const bool modified = SolutionModifier(&modifiers);
  aggregates_ = nullptr;
  in_aggregate_ = outer;
  if (!modified) return nullptr;
  std::vector<Variable> projection;
  return ApplyModifiers(std::move(where), &select, &modifiers, std::move(aggregates), &projection);
}

bool Grammar::ParseSelectClause(SelectClause* out) {
  SelectClause& select = *out;
  select.span = Take().span;
  if (AcceptWord("DISTINCT")) {
    select.distinct = true;
  } else if (AcceptWord("REDUCED")) {
    select.reduced = true;
  }
  if (Accept("*")) {
    select.all = true;
    return true;
  }
  while (Peek().kind == TokenKind::kVariable || At("(")) {
    Charge(kBytesOfItem);
    SelectItem& item = select.items.emplace_back();
    item.span = Peek().span;
    if (Accept("(")) {
      item.expression = ParseExpression();
      if (!item.expression || !ExpectWord("AS", "and a variable: (expression AS ?name)")) return false;
      if (Peek().kind != TokenKind::kVariable) {
        Expected("a variable after AS");
        return false;
      }
      item.span = Peek().span;
      item.variable.name = Take().text;
      if (!Expect(")", "after the variable")) return false;
    } else {
      item.variable.name = std::string(Peek().text);
      Drop();
    }
  }
  if (select.items.empty()) {
    const Token& next = Peek();
    const bool call = next.kind == TokenKind::kWord && (FindAggregate(next.text) || FindBuiltin(next.text));
    Expected("'*', a variable or (expression AS ?name) after SELECT",
             call ? Concat("in brackets and with a name: (", next.text, "(…) AS ?name)") : "");
    return false;
  }
  return true;
}

bool Grammar::AskQuery(Query* query) {
  query->form = Query::Form::kAsk;
  Take();
  if (!DatasetClauses(query)) return false;
  AlgebraPtr where = WhereClause();
  if (!where) return false;
  std::vector<Aggregate> aggregates;
  aggregates_ = &aggregates;
  Modifiers modifiers;
  const bool modified = SolutionModifier(&modifiers);
  aggregates_ = nullptr;
  if (!modified) return false;
  query->algebra = ApplyModifiers(std::move(where), nullptr, &modifiers, std::move(aggregates), nullptr);
  return true;
}

bool Grammar::ConstructQuery(Query* query) {
  query->form = Query::Form::kConstruct;
  Take();
  const bool short_form = !At("{");
  if (!short_form) {
    std::optional<std::vector<TriplePattern>> triples = TemplateInBraces();
    if (!triples) return false;
    query->construct_template = *std::move(triples);
  }
  if (!DatasetClauses(query)) return false;
  AlgebraPtr where;
  if (short_form) {  // CONSTRUCT WHERE { triples }
    if (!ExpectWord("WHERE", "or '{' after CONSTRUCT")) return false;
    const SourceSpan span = Peek().span;
    std::optional<std::vector<TriplePattern>> triples = TemplateInBraces();
    if (!triples) return false;
    for (const TriplePattern& t : *triples) {
      if (!CountPattern() || !Charge(sizeof(t) + TextMemory(t))) return false;
    }
    query->construct_template = *triples;
    where = NewAlgebra(Kind::kBgp, span);
    where->triples = *std::move(triples);
    for (TriplePattern& t : where->triples) {
      for (PatternTerm* term : {&t.subject, &t.predicate, &t.object}) {
        if (!term->IsVariable() && term->term().IsBlank())
          *term = PatternTerm::Of(Variable{".b" + term->term().lexical}, term->span);
      }
    }
  } else {
    where = WhereClause();
    if (!where) return false;
  }
  std::vector<Aggregate> aggregates;
  aggregates_ = &aggregates;
  Modifiers modifiers;
  const bool modified = SolutionModifier(&modifiers);
  aggregates_ = nullptr;
  if (!modified) return false;
  query->algebra = ApplyModifiers(std::move(where), nullptr, &modifiers, std::move(aggregates), nullptr);
  return true;
}

bool Grammar::DescribeQuery(Query* query) {
  query->form = Query::Form::kDescribe;
  Take();
  const bool all = Accept("*");
  while (!all && (Peek().kind == TokenKind::kVariable || Peek().kind == TokenKind::kIri ||
                  Peek().kind == TokenKind::kPrefixedName)) {
    std::optional<PatternTerm> target = VarOrIri();
    if (!target || !Charge(2 * sizeof(PatternTerm))) return false;
    query->describe.push_back(*std::move(target));
  }
  if (!all && query->describe.empty()) {
    Expected("'*', a variable or an IRI after DESCRIBE");
    return false;
  }
  if (!DatasetClauses(query)) return false;
  AlgebraPtr where;
  if (AtWord("WHERE") || At("{")) {
    where = WhereClause();
    if (!where) return false;
  } else {
    where = NewAlgebra(Kind::kBgp, Peek().span);
  }
  if (all) {
    for (Variable& v : InScopeVariables(*where)) {
      if (!v.IsHidden()) query->describe.push_back(PatternTerm::Of(std::move(v)));
    }
  }
  std::vector<Aggregate> aggregates;
  aggregates_ = &aggregates;
  Modifiers modifiers;
  const bool modified = SolutionModifier(&modifiers);
  aggregates_ = nullptr;
  if (!modified) return false;
  query->algebra = ApplyModifiers(std::move(where), nullptr, &modifiers, std::move(aggregates), nullptr);
  return true;
}

bool Grammar::DatasetClauses(Query* query) {
  while (AcceptWord("FROM")) {
    const bool named = AcceptWord("NAMED");
    std::optional<Term> iri = Iri();
    if (!iri || !Charge(2 * sizeof(Term))) return false;
    (named ? query->from_named : query->from).push_back(*std::move(iri));
  }
  return true;
}

AlgebraPtr Grammar::WhereClause() {
  AcceptWord("WHERE");
  return GroupGraphPattern();
}

bool Grammar::SolutionModifier(Modifiers* out) {
  if (Peek().kind != TokenKind::kWord) return true;  // all clauses begin with a word
  return GroupClause(out) && HavingClause(out) && OrderClause(out) && LimitOffsetClauses(out) &&
         ValuesClause(out);
}

bool Grammar::GroupClause(Modifiers* out) {
  if (!AtWord("GROUP")) return true;
  Take();
  if (!ExpectWord("BY", "after GROUP")) return false;
  std::vector<Aggregate>* outer = std::exchange(aggregates_, nullptr);
  out->grouped = true;
  while (true) {
    const Token token = Peek();
    const bool word = token.kind == TokenKind::kWord && !AtWord("HAVING") && !AtWord("ORDER") &&
                      !AtWord("LIMIT") && !AtWord("OFFSET") && !AtWord("VALUES");
    Charge(kBytesOfItem);
    GroupKey key;
    if (token.kind == TokenKind::kVariable) {
      key.variable = Variable{std::string(Take().text)};
      key.expression = NewExpression(Expression::Kind::kVariable, token.span);
      key.expression->variable = key.variable;
    } else if (token.Is("(")) {
      Take();
      key.expression = ParseExpression();
      if (!key.expression) return false;
      if (AcceptWord("AS")) {
        if (Peek().kind != TokenKind::kVariable) {
          Expected("a variable after AS");
          return false;
        }
        key.variable = Variable{std::string(Take().text)};
      } else {
        key.variable = Variable{".k" + std::to_string(counter_++)};
      }
      if (!Expect(")", "to close the key")) return false;
    } else if (word || token.kind == TokenKind::kIri || token.kind == TokenKind::kPrefixedName) {
      key.expression = Constraint();
      if (!key.expression) return false;
      key.variable = Variable{".k" + std::to_string(counter_++)};
    } else {
      break;
    }
    out->group_keys.push_back(std::move(key));
  }
  aggregates_ = outer;
  if (out->group_keys.empty()) {
    Expected("a variable or expression after GROUP BY");
    return false;
  }
  return true;
}

bool Grammar::HavingClause(Modifiers* out) {
  if (!AcceptWord("HAVING")) return true;
  do {
    ExpressionPtr condition = Constraint();
    if (!condition) return false;
    out->having.push_back(std::move(condition));
  } while (At("(") || (Peek().kind == TokenKind::kWord && !AtWord("ORDER") && !AtWord("LIMIT") &&
                       !AtWord("OFFSET") && !AtWord("VALUES")));
  return true;
}

bool Grammar::OrderClause(Modifiers* out) {
  if (!AtWord("ORDER")) return true;
  Take();
  if (!ExpectWord("BY", "after ORDER")) return false;
  while (true) {
    Charge(2 * sizeof(OrderCondition));
    OrderCondition condition;
    const Token token = Peek();
    if (AtWord("ASC") || AtWord("DESC")) {
      condition.descending = AtWord("DESC");
      Take();
      condition.expression = BracketedExpression();
    } else if (token.kind == TokenKind::kVariable) {
      condition.expression = NewExpression(Expression::Kind::kVariable, token.span);
      condition.expression->variable = Variable{std::string(Take().text)};
    } else if (token.Is("(") || token.kind == TokenKind::kIri || token.kind == TokenKind::kPrefixedName ||
               (token.kind == TokenKind::kWord && !AtWord("LIMIT") && !AtWord("OFFSET") &&
                !AtWord("VALUES"))) {
      condition.expression = Constraint();
    } else {
      break;
    }
    if (!condition.expression) return false;
    out->order.push_back(std::move(condition));
  }
  if (out->order.empty()) {
    Expected("a variable or expression after ORDER BY");
    return false;
  }
  return true;
}

bool Grammar::LimitOffsetClauses(Modifiers* out) {
  bool has_offset = false;
  while (AtWord("LIMIT") || AtWord("OFFSET")) {
    const Token word = Take();
    const bool limit = word.IsWord("LIMIT");
    if (limit ? out->limit.has_value() : std::exchange(has_offset, true)) {
      Error(word.span, Concat(word.text, " is given twice"));
      return false;
    }
    const Token number = Peek();
    uint64_t value = 0;
    const auto parsed = std::from_chars(number.text.data(), number.text.data() + number.text.size(), value);
    if (number.kind == TokenKind::kInteger && parsed.ec == std::errc::result_out_of_range) {
      Error(number.span, Concat(number.text, " after ", word.text, " is too large"),
            Concat("at most ", std::to_string(std::numeric_limits<uint64_t>::max())));
      return false;
    }
    if (number.kind != TokenKind::kInteger || parsed.ec != std::errc()) {
      Expected(Concat("a whole number after ", word.text));
      return false;
    }
    Take();
    if (limit) {
      out->limit = value;
    } else {
      out->offset = value;
    }
  }
  return true;
}

bool Grammar::ValuesClause(Modifiers* out) {
  if (!AcceptWord("VALUES")) return true;
  out->values = DataBlock();
  return out->values != nullptr;
}

// In HAVING and ORDER BY, a variable that is neither key nor aggregate stands for one of its values (section 18.2.4.1).
void Grammar::SampleUngrouped(const std::set<std::string>& allowed, Algebra* group, Expression* e) {
  if (e->kind == Expression::Kind::kVariable && !e->variable.IsHidden() &&
      !allowed.contains(e->variable.name)) {
    Aggregate sample;
    sample.function = Aggregate::Function::kSample;
    Charge(2 * sizeof(Aggregate) + MemoryBytes(*e));
    sample.expression = e->Clone();
    sample.result = Variable{".a" + std::to_string(counter_++)};
    sample.span = e->span;
    e->variable = sample.result;
    group->aggregates.push_back(std::move(sample));
  }
  for (const ExpressionPtr& argument : e->arguments) SampleUngrouped(allowed, group, argument.get());
}

// An expression of SELECT above a group may use keys and aggregates only (section 11.4).
void Grammar::CheckGrouped(const Expression& e, const std::set<std::string>& allowed) {
  if (e.kind == Expression::Kind::kVariable && !e.variable.IsHidden() && !allowed.contains(e.variable.name)) {
    Error(e.span, "?" + e.variable.name + " is neither a key of GROUP BY nor inside an aggregate",
          "add it to GROUP BY, or write SAMPLE(?" + e.variable.name + ")");
  }
  for (const ExpressionPtr& argument : e.arguments) CheckGrouped(*argument, allowed);
}

void Grammar::CheckAliases(const Expression& e, const std::set<std::string>& given) {
  if (e.kind == Expression::Kind::kVariable && given.contains(e.variable.name)) {
    Error(e.span, "?" + e.variable.name + " gets its value in SELECT, after HAVING",
          "write its expression in HAVING");
  }
  for (const ExpressionPtr& argument : e.arguments) CheckAliases(*argument, given);
}

AlgebraPtr Grammar::ApplyGroup(AlgebraPtr where, SelectClause* select, Modifiers* modifiers,
                               std::vector<Aggregate> aggregates) {
  AlgebraPtr group = Wrap(Kind::kGroup, std::move(where));
  std::set<std::string> allowed;
  for (const GroupKey& key : modifiers->group_keys) allowed.insert(key.variable.name);
  for (const Aggregate& a : aggregates) allowed.insert(a.result.name);
  group->group_keys = std::move(modifiers->group_keys);
  group->aggregates = std::move(aggregates);
  // A name that SELECT gives is not there yet for HAVING, and SAMPLE of it would have no value.
  std::set<std::string> given;
  for (size_t i = 0; select != nullptr && i < select->items.size(); ++i) {
    const SelectItem& item = select->items[i];
    if (item.expression && !allowed.contains(item.variable.name)) given.insert(item.variable.name);
  }
  for (const ExpressionPtr& having : modifiers->having) {
    CheckAliases(*having, given);
    SampleUngrouped(allowed, group.get(), having.get());
  }
  if (select != nullptr) {
    if (select->all)
      Error(select->span, "SELECT * is not allowed with GROUP BY", "name the keys and aggregates");
    for (const SelectItem& item : select->items) {
      if (item.expression) {
        CheckGrouped(*item.expression, allowed);
        allowed.insert(item.variable.name);
      } else if (!allowed.contains(item.variable.name)) {
        Error(item.span, "?" + item.variable.name + " is neither a key of GROUP BY nor inside an aggregate",
              "add it to GROUP BY, or write (SAMPLE(?" + item.variable.name + ") AS ?one)");
      }
    }
  }
  for (const OrderCondition& order : modifiers->order) {
    SampleUngrouped(allowed, group.get(), order.expression.get());
  }
  return group;
}

// Section 18.2.4 and 18.2.5, in its order.
AlgebraPtr Grammar::ApplyModifiers(AlgebraPtr where, SelectClause* select, Modifiers* modifiers,
                                   std::vector<Aggregate> aggregates, std::vector<Variable>* projection) {
  const bool computed =
      select != nullptr && std::any_of(select->items.begin(), select->items.end(),
                                       [](const SelectItem& item) { return item.expression != nullptr; });
  std::set<std::string> in_scope;  // names that (expression AS ?name) may not use
  if (computed) {
    for (Variable& v : InScopeVariables(*where)) in_scope.insert(std::move(v.name));
  }
  AlgebraPtr a = std::move(where);
  const bool grouped = modifiers->grouped || !aggregates.empty() || !modifiers->having.empty();
  if (grouped) a = ApplyGroup(std::move(a), select, modifiers, std::move(aggregates));
  for (ExpressionPtr& having : modifiers->having) {
    if (!CountElement(having->span)) break;
    a = Wrap(Kind::kFilter, std::move(a));
    a->expression = std::move(having);
  }
  if (modifiers->values) {
    AlgebraPtr join = Wrap(Kind::kJoin, std::move(a));
    for (const Variable& v : modifiers->values->variables) in_scope.insert(v.name);
    join->children.push_back(std::move(modifiers->values));
    a = std::move(join);
  }
  if (select != nullptr) {
    NameNumbers named;
    projection->reserve(select->items.size());
    for (SelectItem& item : select->items) {
      if (ended_) break;
      const bool first = named.Add(item.variable.name, 0).second;
      if (item.expression) {
        if (!first || in_scope.contains(item.variable.name)) {
          Error(item.span, "?" + item.variable.name + " already has a value here",
                "give the expression another name");
        }
        a = Extend(std::move(a), item.variable, std::move(item.expression));
      }
      if (first) projection->push_back(item.variable);
    }
    if (select->all) {
      for (const Variable& v : InScopeVariables(*a)) {
        if (!v.IsHidden()) projection->push_back(v);
      }
    }
  }
  if (!modifiers->order.empty()) {
    a = Wrap(Kind::kOrderBy, std::move(a));
    a->order = std::move(modifiers->order);
  }
  if (select != nullptr) {
    a = Wrap(Kind::kProject, std::move(a));
    a->variables = *projection;
    if (select->distinct) a = Wrap(Kind::kDistinct, std::move(a));
    if (select->reduced) a = Wrap(Kind::kReduced, std::move(a));
  }
  if (modifiers->offset > 0 || modifiers->limit) {
    a = Wrap(Kind::kSlice, std::move(a));
    a->offset = modifiers->offset;
    a->limit = modifiers->limit;
  }
  return a;
}

}  // namespace docent::sparql
