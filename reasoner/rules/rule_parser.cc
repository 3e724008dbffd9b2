#include "reasoner/rules/rule_parser.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/base/query_limits.h"
#include "graph/base/rule_limits.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"
#include "reasoner/matching/trigger_analysis.h"
#include "reasoner/rules/inconsistency.h"

namespace docent::rules {
namespace {

using sparql::Algebra;
using sparql::Builtin;
using sparql::Expression;
using sparql::PatternTerm;
using Names = absl::flat_hash_set<std::string>;

struct Refusal {
  std::string what;
  std::string hint;
};

// The outermost part of a path that is not a fixed number of steps; null: none.
const sparql::Path* EndlessPart(const sparql::Path& path) {
  using Kind = sparql::Path::Kind;
  if (path.kind == Kind::kZeroOrMore || path.kind == Kind::kOneOrMore || path.kind == Kind::kZeroOrOne ||
      path.kind == Kind::kNegatedSet) {
    return &path;
  }
  for (const sparql::Path& child : path.children) {
    if (const sparql::Path* part = EndlessPart(child)) return part;
  }
  return nullptr;
}

Refusal RefusalOfPath(const sparql::Path& path) {
  using Kind = sparql::Path::Kind;
  const sparql::Path* part = EndlessPart(path);
  if (part == nullptr) return {"this property path", "write its steps as triple patterns"};
  if (part->kind == Kind::kNegatedSet) {
    return {"a negated property set",
            "match any property and leave those out: ?a ?p ?b FILTER(?p NOT IN (…))"};
  }
  if (part->kind == Kind::kZeroOrOne) {
    return {"a property path with a step that may be left out (?)",
            "write one rule with the step and one without it"};
  }
  const std::string step =
      part->children[0].kind == Kind::kIri ? ToNTriples(part->children[0].iri) : std::string("PATH");
  std::string hint = absl::StrCat(
      "derive the closure with a property of your own, and match that: RULE { ?a ex:reaches ?b } WHERE { ?a ",
      step, " ?b }  RULE { ?a ex:reaches ?c } WHERE { ?a ex:reaches ?b . ?b ", step, " ?c }");
  if (part->kind == Kind::kZeroOrMore) absl::StrAppend(&hint, "; for no step at all write a second rule");
  return {"a property path of any length (+ or *)", std::move(hint)};
}

// A construct that a body must not contain, with the remedy.
std::optional<Refusal> RefusalOf(const Algebra& node) {
  switch (node.kind) {
    case Algebra::Kind::kLeftJoin:
      return Refusal{"OPTIONAL", "write one rule with the optional part and one without it"};
    case Algebra::Kind::kGraph:
      return Refusal{"GRAPH", "rules match the union of all graphs; leave GRAPH out"};
    case Algebra::Kind::kPath:
      return RefusalOfPath(node.path);
    case Algebra::Kind::kService:
      return Refusal{"SERVICE", "load the data first"};
    case Algebra::Kind::kGroup:
      return Refusal{"an aggregate", ""};
    case Algebra::Kind::kProject:
    case Algebra::Kind::kOrderBy:
    case Algebra::Kind::kDistinct:
    case Algebra::Kind::kReduced:
    case Algebra::Kind::kSlice:
      return Refusal{"a sub-SELECT", "write its pattern into the body, or derive it by a rule of its own"};
    default:
      return std::nullopt;
  }
}

std::string_view VolatileName(Builtin builtin) {
  switch (builtin) {
    case Builtin::kNow:
      return "NOW";
    case Builtin::kRand:
      return "RAND";
    case Builtin::kUuid:
      return "UUID";
    case Builtin::kStrUuid:
      return "STRUUID";
    case Builtin::kBnode:
      return "BNODE";
    default:
      return "";
  }
}

class Checker {
 public:
  Checker(std::string_view file, RuleTextOrigin origin, Diagnostics& diagnostics)
      : file_(file), is_new_(origin == RuleTextOrigin::kNew), diagnostics_(diagnostics) {}

  void Check(const Rule& rule) {
    const Algebra& body = *rule.body.algebra;
    refused_ = names_reports_ = false;
    CheckBody(body);
    if (refused_) return;  // the variables of such a body are not known here
    Names bound = matching::CertainVariables(body);
    AddAssigned(body, bound);
    Names in_scope;
    for (const sparql::Variable& v : sparql::InScopeVariables(body)) in_scope.insert(v.name);
    for (const sparql::TriplePattern& triple : rule.head) {
      CheckHeadTerm(triple.subject, rule, bound, in_scope);
      CheckHeadTerm(triple.predicate, rule, bound, in_scope);
      CheckHeadTerm(triple.object, rule, bound, in_scope);
      if (!triple.subject.IsVariable() && triple.subject.term().IsLiteral()) {
        Report(triple.subject.span, rule, "a literal cannot be the subject of a triple", "");
      }
      if (!triple.predicate.IsVariable() && !triple.predicate.term().IsIri()) {
        Report(triple.predicate.span, rule, "the predicate of a triple is an IRI", "");
      }
    }
  }

 private:
  void Report(const SourceSpan& span, const Rule& rule, std::string message, std::string_view hint) {
    Report(span.line > 0 ? span : rule.span, std::move(message), hint);
  }
  void Report(const SourceSpan& span, std::string message, std::string_view hint) {
    diagnostics_.push_back({std::string(file_), span, std::move(message), std::string(hint)});
  }

  void CheckHeadTerm(const PatternTerm& term, const Rule& rule, const Names& bound, const Names& in_scope) {
    if (!term.IsVariable()) {
      if (term.term().IsBlank()) {
        Report(term.span, rule, "a blank node in a rule head would give new facts without end",
               "name the thing by an IRI, or bind one: BIND(IRI(CONCAT(…)) AS ?new)");
      }
      return;
    }
    const std::string& name = term.variable().name;
    if (bound.contains(name)) return;
    if (term.variable().IsHidden()) {
      Report(term.span, rule, "a blank node in a rule head would give new facts without end",
             "name the thing by an IRI");
    } else if (in_scope.contains(name)) {
      Report(term.span, rule,
             absl::StrCat("?", name, " of the head is not bound in every solution of the body"),
             absl::StrCat("bind ?", name, " in every branch of the UNION, or write one rule for each"));
    } else {
      Report(term.span, rule, absl::StrCat("?", name, " of the head does not occur in the body"),
             absl::StrCat("add a pattern or BIND that binds ?", name));
    }
  }

  // Variables that BIND assigns in the conjunction.
  void AddAssigned(const Algebra& node, Names& names) {
    switch (node.kind) {
      case Algebra::Kind::kExtend:
        names.insert(node.variable.name);
        return AddAssigned(*node.children[0], names);
      case Algebra::Kind::kFilter:
      case Algebra::Kind::kMinus:
        return AddAssigned(*node.children[0], names);
      case Algebra::Kind::kJoin:
        for (const auto& child : node.children) AddAssigned(*child, names);
        return;
      case Algebra::Kind::kUnion:
        return AddAssignedByAll(node, names);
      case Algebra::Kind::kProject:
        if (matching::GroupOf(node) == nullptr) return;
        for (const sparql::Variable& v : node.variables) names.insert(v.name);
        return;
      case Algebra::Kind::kValues:
        for (size_t i = 0; i < node.variables.size(); ++i) {
          bool always = true;
          for (const auto& row : node.rows) always = always && row[i].has_value();
          if (always) names.insert(node.variables[i].name);
        }
        return;
      default:
        return;
    }
  }

  // Variables that each branch of a UNION binds by a pattern or assigns.
  void AddAssignedByAll(const Algebra& node, Names& names) {
    Names common;
    for (size_t i = 0; i < node.children.size(); ++i) {
      Names here = matching::CertainVariables(*node.children[i]);
      AddAssigned(*node.children[i], here);
      if (i > 0) absl::erase_if(here, [&](const std::string& name) { return !common.contains(name); });
      common = std::move(here);
    }
    names.insert(common.begin(), common.end());
  }

  // COUNT, SUM, MIN and MAX of an aggregating sub-SELECT, with the pattern that they aggregate.
  void CheckSelect(const Algebra& select, const Algebra& group) {
    using Function = sparql::Aggregate::Function;
    for (const sparql::Aggregate& aggregate : group.aggregates) {
      const Function f = aggregate.function;
      if (f == Function::kCount || f == Function::kSum || f == Function::kMin || f == Function::kMax)
        continue;
      Report(aggregate.span.line > 0 ? aggregate.span : select.span,
             "a rule body cannot contain this aggregate", "COUNT, SUM, MIN and MAX can be kept up to date");
    }
    const int outer = std::exchange(depth_, depth_ + 1);  // HAVING and SELECT see the aggregates
    for (const Algebra* node = select.children[0].get(); node != &group; node = node->children[0].get()) {
      if (node->expression) CheckExpression(*node->expression, {}, "SELECT");
    }
    for (const sparql::Aggregate& aggregate : group.aggregates) {
      if (aggregate.expression) CheckExpression(*aggregate.expression, {}, "SELECT");
    }
    depth_ = outer;
    CheckBody(*group.children[0]);
  }

  void CheckBody(const Algebra& node) {
    if (const Algebra* group = matching::GroupOf(node)) return CheckSelect(node, *group);
    if (const std::optional<Refusal> refusal = RefusalOf(node)) {
      refused_ = true;
      Report(node.span, absl::StrCat("a rule body cannot contain ", refusal->what), refusal->hint);
      return;
    }
    CheckTriples(node);
    for (const auto& child : node.children) CheckBody(*child);
    if (!node.expression) return;
    Names scope;
    for (const sparql::Variable& v : sparql::InScopeVariables(*node.children[0])) scope.insert(v.name);
    CheckExpression(*node.expression, scope, node.kind == Algebra::Kind::kExtend ? "BIND" : "FILTER");
  }

  // Rules do not see reports (inconsistency.h), so such a pattern would match nothing. One error for each rule.
  void CheckTriples(const Algebra& node) {
    const auto iri = [](const PatternTerm& term) {
      return !term.IsVariable() && term.term().IsIri() ? std::string_view(term.term().lexical)
                                                       : std::string_view();
    };
    for (const sparql::TriplePattern& triple : node.triples) {
      if (!is_new_ || names_reports_ ||
          !InconsistencyFacts::AreNamedBy(iri(triple.predicate), iri(triple.object)))
        continue;
      names_reports_ = true;
      Report(triple.predicate.span.line > 0 ? triple.predicate.span : node.span,
             "a rule cannot match the reports of checks: nothing follows from them",
             "match what the check matches; queries, subscriptions and conditions of workflows see reports");
    }
  }

  // An expression may use `outer` variables; inside EXISTS also those of its own pattern, by CheckBody.
  void CheckExpression(const Expression& expression, const Names& scope, std::string_view where) {
    if (expression.kind == Expression::Kind::kVariable && !scope.contains(expression.variable.name) &&
        depth_ == 0) {
      Report(expression.span,
             absl::StrCat("?", expression.variable.name, " is not bound where the ", std::string(where),
                          " uses it"),
             "bind it by a pattern in the same group");
    }
    if (expression.kind == Expression::Kind::kBuiltin && !VolatileName(expression.builtin).empty()) {
      Report(expression.span,
             absl::StrCat(std::string(VolatileName(expression.builtin)),
                          "() in a rule: what it derives would not be a function of the facts"),
             "assert the value as a fact and match it");
    }
    if (expression.pattern) {
      ++depth_;
      CheckBody(*expression.pattern);
      --depth_;
    }
    for (const auto& argument : expression.arguments) CheckExpression(*argument, scope, where);
  }

  std::string_view file_;
  const bool is_new_;
  Diagnostics& diagnostics_;
  int depth_ = 0;  // of EXISTS
  bool refused_ = false;
  bool names_reports_ = false;
};

// True for an expression that may give a new value each time when it is applied to its own result.
bool Grows(const Expression& e) {
  using K = Expression::Kind;
  if (e.kind == K::kAdd || e.kind == K::kSubtract || e.kind == K::kMultiply || e.kind == K::kDivide ||
      (e.kind == K::kFunction && !e.term.lexical.starts_with(kXsdNs))) {
    return true;
  }
  if (e.kind == K::kBuiltin && (e.builtin == Builtin::kConcat || e.builtin == Builtin::kReplace ||
                                e.builtin == Builtin::kEncodeForUri)) {
    return true;
  }
  return std::any_of(e.arguments.begin(), e.arguments.end(), [](const auto& a) { return Grows(*a); });
}

bool Compares(const Expression& e) {
  using K = Expression::Kind;
  if (e.kind == K::kLess || e.kind == K::kLessOrEqual || e.kind == K::kGreater ||
      e.kind == K::kGreaterOrEqual)
    return true;
  return std::any_of(e.arguments.begin(), e.arguments.end(), [](const auto& a) { return Compares(*a); });
}

// A comparison in a FILTER may bound the growth: such a rule is left to the limits.
void FindGrowth(const Algebra& node, Names& grown, SourceSpan& span, bool& bounded) {
  if (node.kind == Algebra::Kind::kFilter) bounded = bounded || Compares(*node.expression);
  for (const auto& child : node.children) FindGrowth(*child, grown, span, bounded);
  if (node.kind != Algebra::Kind::kExtend) return;
  bool of_grown = false;
  for (const sparql::Variable& v : sparql::MentionedVariables(*node.expression)) {
    of_grown = of_grown || grown.contains(v.name);
  }
  if (!of_grown && !Grows(*node.expression)) return;
  grown.insert(node.variable.name);
  span = node.span;
}

void NoteGrowth(Rule& rule) {
  Names grown;
  bool bounded = false;
  FindGrowth(*rule.body.algebra, grown, rule.growing_span, bounded);
  if (bounded) return;
  for (const sparql::TriplePattern& triple : rule.head) {
    for (const PatternTerm* term : {&triple.subject, &triple.predicate, &triple.object}) {
      if (term->IsVariable() && grown.contains(term->variable().name))
        rule.growing.push_back(term->variable().name);
    }
  }
}

class RulesReader {
 public:
  RulesReader(std::string_view text, const sparql::ParseOptions& options) : parser_(text, options) {}

  void Read(ParsedRules& out) {
    parser_.Prologue();
    while (!parser_.AtEnd()) {
      const SourceSpan start = parser_.Here();
      if (parser_.AcceptKeyword("RULE")) {
        ReadRule(start, out);
      } else if (parser_.AcceptKeyword("IF")) {
        ReadIfThen(start, out);
      } else if (parser_.AcceptKeyword("DATA")) {
        ReadData(start, out);
      } else if (parser_.AtKeyword("PREFIX") || parser_.AtKeyword("BASE")) {
        parser_.Prologue();
      } else {
        parser_.Error("expected RULE, IF, DATA, PREFIX or BASE", "a rule is RULE { head } WHERE { body }");
        parser_.SkipPastBrace();
      }
      if (parser_.Here().offset == start.offset && !parser_.AtEnd()) parser_.SkipPastBrace();
      if (parser_.Here().offset == start.offset) break;
    }
    out.diagnostics = parser_.diagnostics();
  }

 private:
  void ReadRule(const SourceSpan& start, ParsedRules& out) {
    std::string name;
    if (!parser_.AtPunctuation("{")) {
      if (parser_.AtWord()) {
        parser_.Error("the name of a rule is an IRI", "write RULE prefix:name { … }, or leave the name away");
        return Recover();
      }
      std::optional<Term> iri = parser_.Iri();
      if (!iri) return Recover();
      name = iri->lexical;
    }
    auto head = parser_.TriplesTemplateInBraces();
    if (!head) return Recover();
    if (!parser_.AcceptKeyword("WHERE")) {
      parser_.Error("expected WHERE after the head of the rule", "a rule is RULE { head } WHERE { body }");
      return Recover();
    }
    sparql::AlgebraPtr body = parser_.GroupGraphPattern();
    if (!body) return Recover();
    Add(start, std::move(name), *std::move(head), std::move(body), out);
  }

  void ReadIfThen(const SourceSpan& start, ParsedRules& out) {
    sparql::AlgebraPtr body = parser_.GroupGraphPattern();
    if (!body) return Recover();
    if (!parser_.AcceptKeyword("THEN")) {
      parser_.Error("expected THEN after the body of the rule", "a rule is IF { body } THEN { head }");
      return Recover();
    }
    auto head = parser_.TriplesTemplateInBraces();
    if (!head) return Recover();
    Add(start, "", *std::move(head), std::move(body), out);
  }

  void ReadData(const SourceSpan& start, ParsedRules& out) {
    auto facts = parser_.TriplesTemplateInBraces();
    if (!facts) return Recover();
    if (facts->empty()) return;
    for (const sparql::TriplePattern& fact : *facts) {
      for (const PatternTerm* term : {&fact.subject, &fact.predicate, &fact.object}) {
        const bool blank = term->IsVariable() ? term->variable().IsHidden() : term->term().IsBlank();
        if (!term->IsVariable() && !blank) continue;
        // one of several: a list is many triples at one place
        parser_.Error(term->span,
                      blank ? "DATA of rules takes no blank nodes, nor lists, which are made of them"
                            : "a variable is not allowed in DATA",
                      blank ? "name the thing by an IRI, or tell it as a fact"
                            : "DATA holds facts; a rule has variables");
        return;
      }
    }
    Add(start, "", *std::move(facts), std::make_unique<Algebra>(Algebra::Kind::kBgp), out);
  }

  static void Add(const SourceSpan& start, std::string name, std::vector<sparql::TriplePattern> head,
                  sparql::AlgebraPtr body, ParsedRules& out) {
    Rule rule;
    rule.name = std::move(name);
    rule.head = std::move(head);
    rule.body.form = sparql::Query::Form::kAsk;
    rule.body.algebra = std::move(body);
    rule.span = start;
    out.rules.push_back(std::move(rule));
  }

  // To the next rule.
  void Recover() {
    while (!parser_.AtEnd() && !parser_.AtKeyword("RULE") && !parser_.AtKeyword("IF") &&
           !parser_.AtKeyword("DATA")) {
      const size_t before = parser_.Here().offset;
      parser_.SkipPastBrace();
      if (parser_.Here().offset == before) return;
    }
  }

  sparql::ProductionParser parser_;
};

size_t PatternsIn(const Algebra& node);

size_t PatternsIn(const sparql::Expression& expression) {
  size_t count = expression.pattern ? PatternsIn(*expression.pattern) : 0;
  for (const auto& argument : expression.arguments) count += PatternsIn(*argument);
  return count;
}

size_t PatternsIn(const Algebra& node) {
  size_t count = node.triples.size();
  if (node.expression) count += PatternsIn(*node.expression);
  for (const auto& child : node.children) count += PatternsIn(*child);
  return count;
}

// Patterns have a limit of their own (CheckSize), and what was accepted once stays accepted.
QueryLimits QueryLimitsOf(RuleTextOrigin origin) {
  constexpr size_t kAny = std::numeric_limits<size_t>::max();
  QueryLimits limits;
  limits.query_patterns = kAny;
  if (origin == RuleTextOrigin::kNew) return limits;
  limits.query_path_steps = limits.query_list_elements = limits.query_values = kAny;
  return limits;
}

void CheckSize(const Rule& rule, const std::string& file, Diagnostics& diagnostics) {
  const size_t patterns = PatternsIn(*rule.body.algebra);
  if (patterns <= kRuleLimits.rule_patterns) return;
  diagnostics.push_back(
      {file, rule.span,
       absl::StrCat("the body has ", patterns, " triple patterns; the limit rule_patterns is ",
                    kRuleLimits.rule_patterns),
       "derive parts of it by rules of their own, and match what these derive"});
}

}  // namespace

std::string ShortName(const Rule& rule) {
  const size_t cut = rule.name.find_last_of("#/:");
  return cut == std::string::npos ? rule.name : rule.name.substr(cut + 1);
}

std::string RuleLabel(std::string_view set, const Rule& rule, int number) {
  const std::string name = ShortName(rule);
  return absl::StrCat(std::string(set), " ", name.empty() ? absl::StrCat("rule ", number) : name, " (line ",
                      rule.span.line, ")");
}

ParsedRules ParseRules(std::string_view text, std::string_view file, const Limits& limits,
                       const sparql::FunctionRegistry* functions, RuleTextOrigin origin) {
  sparql::ParseOptions options = sparql::ParseOptionsWith(limits, functions);
  options.check_patterns = origin == RuleTextOrigin::kNew;
  options.file = std::string(file);
  options.rule_elements = true;
  options.limits.query_text_bytes = limits.document_bytes;
  options.query_limits = QueryLimitsOf(origin);
  ParsedRules result;
  if (text.size() > limits.document_bytes) {
    result.diagnostics.push_back({std::string(file),
                                  {},
                                  absl::StrCat("the text has ", text.size(),
                                               " bytes; the limit document_bytes is ", limits.document_bytes),
                                  "make several rule sets of it"});
    return result;
  }
  RulesReader(text, options).Read(result);
  for (Rule& rule : result.rules) NoteGrowth(rule);
  for (const Rule& rule : result.rules) {
    if (origin == RuleTextOrigin::kNew) CheckSize(rule, options.file, result.diagnostics);
    Checker(file, origin, result.diagnostics).Check(rule);
  }
  if (!result.ok()) result.rules.clear();
  return result;
}

}  // namespace docent::rules
