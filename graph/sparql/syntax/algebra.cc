#include "graph/sparql/syntax/algebra.h"

#include <algorithm>

#include "graph/sparql/syntax/name_numbers.h"

namespace docent::sparql {
namespace {

// Keeps the order of first occurrence.
class VariableList {
 public:
  void Add(const Variable& v) {
    if (seen_.Add(v.name, 0).second) list_.push_back(&v);
  }
  void Add(const PatternTerm& t) {
    if (t.IsVariable()) Add(t.variable());
  }
  std::vector<const Variable*> Take() { return std::move(list_); }

 private:
  std::vector<const Variable*> list_;
  NameNumbers seen_;
};

std::vector<Variable> Copies(const std::vector<const Variable*>& variables) {
  std::vector<Variable> out;
  out.reserve(variables.size());
  for (const Variable* v : variables) out.push_back(*v);
  return out;
}

// Looks for one.
class VariableSearch {
 public:
  explicit VariableSearch(std::string_view name) : name_(name) {}
  void Add(const Variable& v) { found_ = found_ || v.name == name_; }
  void Add(const PatternTerm& t) {
    if (t.IsVariable()) Add(t.variable());
  }
  bool found() const { return found_; }

 private:
  const std::string_view name_;
  bool found_ = false;
};

template <typename Out>
void AddTriples(const Algebra& a, Out* out) {
  for (const TriplePattern& t : a.triples) {
    out->Add(t.subject);
    out->Add(t.predicate);
    out->Add(t.object);
  }
}

template <typename Out>
void AddInScope(const Algebra& a, Out* out) {
  using Kind = Algebra::Kind;
  switch (a.kind) {
    case Kind::kBgp:
      AddTriples(a, out);
      return;
    case Kind::kPath:
      out->Add(a.subject);
      out->Add(a.object);
      return;
    case Kind::kMinus:
      AddInScope(*a.children[0], out);
      return;
    case Kind::kGraph:
    case Kind::kService:
      out->Add(a.name);
      break;
    case Kind::kValues:
    case Kind::kProject:
      for (const Variable& v : a.variables) out->Add(v);
      return;
    case Kind::kGroup:
      for (const GroupKey& key : a.group_keys) out->Add(key.variable);
      for (const Aggregate& aggregate : a.aggregates) out->Add(aggregate.result);
      return;
    default:
      break;
  }
  for (const AlgebraPtr& child : a.children) AddInScope(*child, out);
  if (a.kind == Kind::kExtend) out->Add(a.variable);
}

void AddMentioned(const Expression& e, VariableList* out);

// Every variable in a pattern of EXISTS, because substitution reaches all of it except the hidden variables
// of a sub-SELECT.
void AddMentioned(const Algebra& a, VariableList* out) {
  if (a.kind == Algebra::Kind::kProject) {
    for (const Variable& v : a.variables) out->Add(v);
    return;
  }
  AddTriples(a, out);
  out->Add(a.subject);
  out->Add(a.object);
  out->Add(a.name);
  if (a.kind == Algebra::Kind::kExtend) out->Add(a.variable);
  for (const Variable& v : a.variables) out->Add(v);
  if (a.expression) AddMentioned(*a.expression, out);
  for (const GroupKey& key : a.group_keys) AddMentioned(*key.expression, out);
  for (const Aggregate& aggregate : a.aggregates) {
    if (aggregate.expression) AddMentioned(*aggregate.expression, out);
  }
  for (const OrderCondition& order : a.order) AddMentioned(*order.expression, out);
  for (const AlgebraPtr& child : a.children) AddMentioned(*child, out);
}

void AddMentioned(const Expression& e, VariableList* out) {
  if (e.kind == Expression::Kind::kVariable) out->Add(e.variable);
  for (const ExpressionPtr& argument : e.arguments) AddMentioned(*argument, out);
  if (e.pattern) AddMentioned(*e.pattern, out);
}

void AddPatterns(const Algebra& a, bool monotone, std::vector<PatternOccurrence>* out);

void AddPatterns(const Expression& e, std::vector<PatternOccurrence>* out) {
  for (const ExpressionPtr& argument : e.arguments) AddPatterns(*argument, out);
  if (e.pattern) AddPatterns(*e.pattern, false, out);
}

void AddPatterns(const Algebra& a, bool monotone, std::vector<PatternOccurrence>* out) {
  using Kind = Algebra::Kind;
  // A top-level FILTER EXISTS { … } only gains solutions, too, if its pattern does; NOT EXISTS loses
  // them.
  const auto add_expression = [&](const Expression& e) {
    if (e.kind == Expression::Kind::kExists && a.kind == Kind::kFilter) {
      AddPatterns(*e.pattern, monotone, out);
    } else {
      AddPatterns(e, out);
    }
  };
  for (const TriplePattern& t : a.triples) out->push_back({&t, monotone});
  if (a.expression) {
    if (a.expression->kind == Expression::Kind::kAnd) {
      for (const ExpressionPtr& part : a.expression->arguments) add_expression(*part);
    } else {
      add_expression(*a.expression);
    }
  }
  for (const GroupKey& key : a.group_keys) AddPatterns(*key.expression, out);
  for (const Aggregate& aggregate : a.aggregates) {
    if (aggregate.expression) AddPatterns(*aggregate.expression, out);
  }
  for (const OrderCondition& order : a.order) AddPatterns(*order.expression, out);
  for (size_t i = 0; i < a.children.size(); ++i) {
    const bool right = i == 1 && (a.kind == Kind::kLeftJoin || a.kind == Kind::kMinus);
    const bool counted = a.kind == Kind::kGroup || a.kind == Kind::kSlice || a.kind == Kind::kService;
    AddPatterns(*a.children[i], monotone && !right && !counted, out);
  }
}

}  // namespace

const Term& PatternTerm::NoTerm() {
  static const Term none;
  return none;
}

Expression::Expression() = default;
Expression::Expression(Kind kind, SourceSpan span) : kind(kind), span(span) {}
Expression::~Expression() = default;

ExpressionPtr Expression::Clone() const {
  auto copy = std::make_unique<Expression>(kind, span);
  copy->variable = variable;
  copy->term = term;
  copy->builtin = builtin;
  for (const ExpressionPtr& argument : arguments) copy->arguments.push_back(argument->Clone());
  if (pattern) copy->pattern = pattern->Clone();
  return copy;
}

Algebra::Algebra() = default;
Algebra::Algebra(Kind kind, SourceSpan span) : kind(kind), span(span) {}
Algebra::~Algebra() = default;

AlgebraPtr Algebra::Clone() const {
  auto copy = std::make_unique<Algebra>(kind, span);
  for (const AlgebraPtr& child : children) copy->children.push_back(child->Clone());
  copy->triples = triples;
  copy->subject = subject;
  copy->object = object;
  copy->path = path;
  copy->name = name;
  copy->silent = silent;
  if (expression) copy->expression = expression->Clone();
  copy->variable = variable;
  copy->variables = variables;
  copy->rows = rows;
  for (const GroupKey& key : group_keys) copy->group_keys.push_back({key.variable, key.expression->Clone()});
  for (const Aggregate& a : aggregates) {
    copy->aggregates.push_back({a.function, a.distinct, a.expression ? a.expression->Clone() : nullptr,
                                a.separator, a.result, a.span});
  }
  for (const OrderCondition& o : order) copy->order.push_back({o.expression->Clone(), o.descending});
  copy->offset = offset;
  copy->limit = limit;
  return copy;
}

Query Query::Clone() const {
  Query copy;
  copy.form = form;
  copy.base_iri = base_iri;
  copy.prefixes = prefixes;
  copy.from = from;
  copy.from_named = from_named;
  copy.with = with;
  copy.algebra = algebra ? algebra->Clone() : nullptr;
  copy.projection = projection;
  copy.construct_template = construct_template;
  copy.describe = describe;
  return copy;
}

std::vector<const Variable*> VariablesInScope(const Algebra& algebra) {
  VariableList list;
  AddInScope(algebra, &list);
  return list.Take();
}

bool IsInScope(const Algebra& algebra, std::string_view variable) {
  VariableSearch search(variable);
  AddInScope(algebra, &search);
  return search.found();
}

std::vector<const Variable*> VariablesMentioned(const Expression& expression) {
  VariableList list;
  AddMentioned(expression, &list);
  return list.Take();
}

std::vector<Variable> InScopeVariables(const Algebra& algebra) {
  return Copies(VariablesInScope(algebra));
}

std::vector<Variable> MentionedVariables(const Expression& expression) {
  return Copies(VariablesMentioned(expression));
}

std::vector<PatternOccurrence> AllTriplePatterns(const Algebra& algebra) {
  std::vector<PatternOccurrence> out;
  AddPatterns(algebra, true, &out);
  return out;
}

namespace {

bool NeedsTriple(const Path& path) {
  const auto needs = [](const Path& child) { return NeedsTriple(child); };
  switch (path.kind) {
    case Path::Kind::kIri:
    case Path::Kind::kNegatedSet:
      return true;
    case Path::Kind::kZeroOrMore:
    case Path::Kind::kZeroOrOne:
      return false;
    case Path::Kind::kInverse:
    case Path::Kind::kOneOrMore:
    case Path::Kind::kSequence:
      return std::any_of(path.children.begin(), path.children.end(), needs);
    case Path::Kind::kAlternative:
      return std::all_of(path.children.begin(), path.children.end(), needs);
  }
  return false;
}

}  // namespace

bool NeedsTripleOfGraph(const Algebra& inside) {
  const auto needs = [](const AlgebraPtr& child) { return NeedsTripleOfGraph(*child); };
  switch (inside.kind) {
    case Algebra::Kind::kBgp:
      return !inside.triples.empty();
    case Algebra::Kind::kPath:
      return NeedsTriple(inside.path);
    case Algebra::Kind::kJoin:
      return std::any_of(inside.children.begin(), inside.children.end(), needs);
    case Algebra::Kind::kUnion:
      return std::all_of(inside.children.begin(), inside.children.end(), needs);
    case Algebra::Kind::kGroup:  // without keys there is one group, even of no rows
      return !inside.group_keys.empty() && needs(inside.children[0]);
    case Algebra::Kind::kGraph:
    case Algebra::Kind::kValues:
    case Algebra::Kind::kService:
      return false;
    case Algebra::Kind::kLeftJoin:
    case Algebra::Kind::kMinus:
    case Algebra::Kind::kFilter:
    case Algebra::Kind::kExtend:
    case Algebra::Kind::kOrderBy:
    case Algebra::Kind::kProject:
    case Algebra::Kind::kDistinct:
    case Algebra::Kind::kReduced:
    case Algebra::Kind::kSlice:
      return needs(inside.children[0]);
  }
  return false;
}

bool HasPath(const Algebra& algebra) {
  if (algebra.kind == Algebra::Kind::kPath) return true;
  const auto in_expression = [](const Expression& e, const auto& self) -> bool {
    if (e.pattern && HasPath(*e.pattern)) return true;
    for (const ExpressionPtr& argument : e.arguments) {
      if (self(*argument, self)) return true;
    }
    return false;
  };
  if (algebra.expression && in_expression(*algebra.expression, in_expression)) return true;
  for (const AlgebraPtr& child : algebra.children) {
    if (HasPath(*child)) return true;
  }
  return false;
}

}  // namespace docent::sparql
