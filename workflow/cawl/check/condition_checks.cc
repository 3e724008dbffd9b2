// Conditions that can never hold, or always hold, and facts that are told or withdrawn against the ontology. A condition is looked at in its disjunctive normal form: each alternative
// is a conjunction, and what its parts need of one thing must go together.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/check/class_needs.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

using Alternatives = std::vector<Conjunction>;

bool SameWord(const Word& a, const Word& b) {
  return a.kind == b.kind && a.comparison == b.comparison && a.name == b.name && a.term == b.term &&
         a.type_term == b.type_term;
}

bool SameTriple(const Constraint& a, const Constraint& b) {
  return SameWord(a.subject, b.subject) && SameWord(a.verb, b.verb) && SameWord(a.object, b.object);
}

// Whether the formula holds wherever the conjunction does.
bool Follows(const Formula& formula, const Conjunction& from) {
  const auto follows = [&](const Formula& child) { return Follows(child, from); };
  switch (formula.kind) {
    case Formula::Kind::kConstraint:
      return std::any_of(from.constraints.begin(), from.constraints.end(),
                         [&](const Constraint* c) { return SameTriple(*c, *formula.constraint); });
    case Formula::Kind::kEvent:
      return std::any_of(from.events.begin(), from.events.end(), [&](const Event* e) {
        return e->operation.value == formula.event->operation.value;
      });
    case Formula::Kind::kAnd:
      return std::all_of(formula.children.begin(), formula.children.end(), follows);
    case Formula::Kind::kOr:
      return std::any_of(formula.children.begin(), formula.children.end(), follows);
    case Formula::Kind::kNot:
      return false;
  }
  return false;
}

// The constraints of a formula that is nothing but constraints joined by `and`.
bool ConstraintsOf(const Formula& formula, std::set<const Constraint*>* out) {
  if (formula.kind == Formula::Kind::kConstraint) out->insert(formula.constraint);
  if (formula.kind == Formula::Kind::kConstraint) return true;
  return formula.kind == Formula::Kind::kAnd &&
         std::all_of(formula.children.begin(), formula.children.end(),
                     [out](const Formula& child) { return ConstraintsOf(child, out); });
}

bool IsEmpty(const Conjunction& c) {
  return c.constraints.empty() && c.events.empty() && c.absent.empty();
}

// One alternative is empty, or one is "X" and another "not X".
bool HoldsAlways(const Alternatives& alternatives) {
  if (std::any_of(alternatives.begin(), alternatives.end(), IsEmpty)) return true;
  for (const Conjunction& a : alternatives) {
    if (!a.constraints.empty() || !a.events.empty() || a.absent.size() != 1) continue;
    std::set<const Constraint*> absent;
    if (!ConstraintsOf(a.absent[0], &absent)) continue;
    for (const Conjunction& b : alternatives) {
      if (b.events.empty() && b.absent.empty() &&
          std::set<const Constraint*>(b.constraints.begin(), b.constraints.end()) == absent)
        return true;
    }
  }
  return false;
}

// The place of the first constraint or event in a formula.
std::optional<SourceSpan> PlaceIn(const Formula& formula) {
  if (formula.kind == Formula::Kind::kConstraint) {
    const Constraint& c = *formula.constraint;
    return c.name.given() ? c.name.span : c.subject.span;
  }
  if (formula.kind == Formula::Kind::kEvent) return formula.event->operation.span;
  for (const Formula& child : formula.children) {
    if (std::optional<SourceSpan> place = PlaceIn(child)) return place;
  }
  return std::nullopt;
}

class ConditionChecker {
 public:
  ConditionChecker(const Document& document, const Environment* environment, xml::ElementReader* reader)
      : document_(document), reader_(*reader), names_(IriNames::WellKnown()) {
    if (environment != nullptr) schema_ = std::make_unique<Schema>(*environment);
    for (const auto& [prefix, iri] : document.prefixes) names_.Add(prefix, iri);
  }

  void Check(Cancellation* cancellation) {
    const Scope cawl(document_);
    if (document_.activator) {
      const Activator& activator = *document_.activator;
      const Scope scope(cawl, activator);
      if (CanNeverHold(activator.condition, scope, /*no_values=*/true)) {
        const Text& place = activator.name.given() ? activator.name : activator.flow;
        Warn(place.span, "the activator can never start a run: no alternative of its condition can hold",
             "see what is said of its constraints", kActivatorNeverRises);
      }
      CheckAlwaysTrue(activator.condition,
                      "the activator starts one run when the document is deployed, and no other");
    }
    for (const Flow& flow : document_.flows) {
      const Scope flow_scope(cawl, flow);
      for (const Node& node : flow.nodes) {
        if (IsOver(cancellation)) return;
        const Scope scope(flow_scope, node);
        for (const Action& action : node.actions) CheckFacts(action, scope);
        if (node.hold) CanHold({{&*node.hold}, {}, {}}, scope, /*no_values=*/false);
        if (!node.condition) continue;
        if (CanNeverHold(*node.condition, scope, /*no_values=*/false)) {
          Warn(node.name.span,
               Concat("node ", node.name.value, " can never open: no alternative of its condition can hold"),
               "see what is said of its constraints", kUnsatisfiable);
        }
        CheckAlwaysTrue(*node.condition, "the node opens at once");
      }
      for (const Link& link : flow.links) {
        if (link.while_constraint) CanHold({{&*link.while_constraint}, {}, {}}, flow_scope, false);
      }
    }
  }

 private:
  void Warn(const SourceSpan& span, std::string message, const xml::Advice& advice, const char* rule,
            std::vector<TextEdit> fix = {}) {
    if (!told_.insert({span.offset, message}).second) return;
    Diagnostic& report = reader_.Warning(span, std::move(message), advice);
    report.rule = rule;
    if (!fix.empty()) report.fix = std::move(fix);
  }

  static std::vector<Formula> PartsOf(const Condition& condition) {
    if (condition.expression) return {FormulaOf(condition)};
    std::vector<Formula> parts;
    for (const Context& context : condition.contexts) parts.push_back(FormulaOf(context));
    for (const Case& c : condition.cases) parts.push_back(FormulaOf(c));
    return parts;
  }

  // Looks at every alternative, and tells what is wrong with it.
  bool CanNeverHold(const Condition& condition, const Scope& scope, bool no_values) {
    size_t alternatives = 0, impossible = 0;
    for (const Formula& part : PartsOf(condition)) {
      const absl::StatusOr<Alternatives> conjunctions = ToAlternatives(part);
      if (!conjunctions.ok()) return false;  // an error says so
      for (const Conjunction& conjunction : *conjunctions) {
        ++alternatives;
        if (!CanHold(conjunction, scope, no_values)) ++impossible;
      }
    }
    return alternatives > 0 && impossible == alternatives;
  }

  // `no_values`: no variable has a value, so that $x is like ?x.
  bool CanHold(const Conjunction& conjunction, const Scope& scope, bool no_values) {
    bool can = AbsenceCanHold(conjunction);
    can = ComparisonsCanHold(conjunction, no_values) && can;
    if (schema_ == nullptr) return can;
    ClassNeeds needs(*schema_, scope, names_);
    for (const Constraint* constraint : conjunction.constraints) {
      if (constraint->time != Constraint::Time::kNone) continue;
      can = ObjectCanHold(*constraint) && can;
      needs.Add(*constraint);
    }
    for (const Formula& absent : conjunction.absent) TellOfObjects(absent);
    for (const NeedClash& clash : needs.Clashes()) {
      can = false;
      Warn(clash.span, clash.message,
           "no such thing can exist, so this alternative of the condition never holds",
           clash.of_declaration ? kTypeClash : kUnsatisfiable);
    }
    return can;
  }

  // What is told or withdrawn, against what the ontology says of its properties.
  void CheckFacts(const Action& action, const Scope& scope) {
    const bool tells = action.kind == Action::Kind::kTell;
    if (schema_ == nullptr || (!tells && action.kind != Action::Kind::kWithdraw)) return;
    ClassNeeds needs(*schema_, scope, names_);
    for (const Constraint& fact : action.facts) {
      (void)ObjectCanHold(fact);
      if (tells) needs.Add(fact);
    }
    for (const NeedClash& clash : needs.Clashes())
      Warn(clash.span, clash.message, "no such thing can exist; correct what is told", kTypeClash);
  }

  // What can't hold is always absent, which is not what is meant: it is told, and the alternative can hold.
  void TellOfObjects(const Formula& absent) {
    if (absent.constraint != nullptr && absent.constraint->time == Constraint::Time::kNone)
      (void)ObjectCanHold(*absent.constraint);
    for (const Formula& child : absent.children) TellOfObjects(child);
  }

  bool AbsenceCanHold(const Conjunction& conjunction) {
    bool can = true;
    for (const Formula& absent : conjunction.absent) {
      if (!Follows(absent, conjunction)) continue;
      can = false;
      const std::optional<SourceSpan> place = PlaceIn(absent);
      Warn(place ? *place : document_.name.span,
           "the condition needs this to hold and not to hold at the same time",
           "an alternative that has both never holds; correct its expression", kUnsatisfiable);
    }
    return can;
  }

  // A comparison with a variable that has no value is never true.
  bool ComparisonsCanHold(const Conjunction& conjunction, bool no_values) {
    std::set<std::string> bound;
    for (const Constraint* constraint : conjunction.constraints) {
      for (const Word* word : {&constraint->subject, &constraint->verb, &constraint->object}) {
        if (word->comparison == Word::Comparison::kNone) bound.insert(word->name);
      }
    }
    bool can = true;
    for (const Constraint* constraint : conjunction.constraints) {
      const Word& word = constraint->object;
      const bool open = word.kind == Word::Kind::kFree || (no_values && word.kind == Word::Kind::kVariable);
      if (word.comparison == Word::Comparison::kNone || !open || bound.contains(word.name)) continue;
      can = false;
      const std::string shown = Concat(word.kind == Word::Kind::kFree ? "?" : "$", word.name);
      Warn(word.span, Concat("the comparison is never true: ", shown, " has no value here"),
           no_values && word.kind == Word::Kind::kVariable
               ? "in an activator no variable has a value; write the value itself, or bind it by a constraint"
               : Concat("bind ", shown, " by another constraint of the same context"),
           kUnsatisfiable);
    }
    return can;
  }

  // A literal, a comparison or a type against what the verb's objects are.
  bool ObjectCanHold(const Constraint& constraint) {
    const Word& object = constraint.object;
    if (constraint.verb.kind != Word::Kind::kTerm) return true;
    const std::string& verb = constraint.verb.term.lexical;
    const std::string shown = names_.Iri(verb);
    const bool compares = object.comparison != Word::Comparison::kNone;
    const bool orders = compares && object.comparison != Word::Comparison::kEqual &&
                        object.comparison != Word::Comparison::kNotEqual;
    if (schema_->IsObjectProperty(verb)) {
      const bool literal = object.kind == Word::Kind::kTerm && object.term.IsLiteral();
      if (!literal && !orders) return true;
      Warn(object.span,
           orders ? Concat("the objects of ", shown,
                           " are resources, which are neither more nor less than anything")
                  : Concat("the objects of ", shown, " are resources, and this is a literal"),
           "write prefix:local or <iri> for a resource", kTypeClash);
      return object.comparison == Word::Comparison::kNotEqual;
    }
    if (object.kind != Word::Kind::kTerm || !schema_->IsDatatypeProperty(verb)) return true;
    if (object.term.IsIri()) {
      Warn(object.span, Concat("the objects of ", shown, " are literals, and this is a resource"),
           Concat("write a literal: ", LiteralLike(verb)), kTypeClash);
      return object.comparison == Word::Comparison::kNotEqual;
    }
    return DatatypeSuits(verb, object);
  }

  std::string LiteralLike(const std::string& verb) const {
    for (const std::string& range : schema_->Ranges(verb)) {
      switch (FamilyOf(range)) {
        case ValueFamily::kNumber:
          return "7 or 0.5";
        case ValueFamily::kBoolean:
          return "true or false";
        case ValueFamily::kText:
          return "\"text\"";
        default:
          return Concat("\"…\"^^", names_.Iri(range));
      }
    }
    return "\"text\", 7 or true";
  }

  bool DatatypeSuits(const std::string& verb, const Word& object) {
    const ValueFamily given =
        FamilyOf(object.term.language.empty() ? object.term.datatype : std::string(kRdfLangString));
    if (given == ValueFamily::kUnknown) return true;
    for (const std::string& range : schema_->Ranges(verb)) {
      const ValueFamily wanted = FamilyOf(range);
      if (!range.starts_with(kXsdNs) || wanted == ValueFamily::kUnknown || wanted == given) continue;
      Warn(object.span,
           Concat("the objects of ", names_.Iri(verb), " are of ", names_.Iri(range), ", and this is of ",
                  names_.Iri(object.term.datatype.empty() ? kXsdString
                                                          : std::string_view(object.term.datatype))),
           Concat("write ", LiteralLike(verb)), kTypeClash, Retyped(object, wanted));
      return object.comparison == Word::Comparison::kNotEqual;
    }
    return true;
  }

  // The same text as a literal of another family, where it is one: "true" for a truth value, 7 for a text.
  std::vector<TextEdit> Retyped(const Word& object, ValueFamily wanted) const {
    const std::string& text = object.term.lexical;
    const std::string_view written = reader_.source().substr(object.span.offset, object.span.length);
    const bool quoted = written == Concat("\"", text, "\"") || written == Concat("'", text, "'");
    if (quoted && wanted == ValueFamily::kBoolean && (text == "true" || text == "false"))
      return {{object.span.offset, object.span.length, text}};
    xml::TermError error;
    if (quoted && wanted == ValueFamily::kNumber) {
      const std::optional<Term> number = xml::ParseTerm(text, {}, &error);
      if (number && FamilyOf(number->datatype) == ValueFamily::kNumber && number->IsLiteral())
        return {{object.span.offset, object.span.length, text}};
    }
    if (wanted == ValueFamily::kText && written == text)
      return {{object.span.offset, object.span.length, Concat("\"", text, "\"")}};
    return {};
  }

  void CheckAlwaysTrue(const Condition& condition, std::string_view effect) {
    if (condition.contexts.empty() && condition.cases.empty()) {
      Warn(condition.span, "a condition without a context or a case always holds",
           Concat(effect, "; leave the condition out, or say what must hold"), kAlwaysTrue,
           {reader_.Removal(condition.span)});
      return;
    }
    if (condition.expression) {
      const absl::StatusOr<Alternatives> alternatives = ToAlternatives(FormulaOf(condition));
      if (alternatives.ok() && HoldsAlways(*alternatives))
        Warn(condition.expression_text.span, "the condition always holds",
             Concat(effect, "; correct the expression"), kAlwaysTrue);
      return;
    }
    for (const Context& context : condition.contexts) CheckAlwaysTrue(context, condition, effect);
  }

  void CheckAlwaysTrue(const Context& context, const Condition& condition, std::string_view effect) {
    const auto waits = [](const Rule& rule) { return rule.after_ms.has_value(); };
    if (std::any_of(context.rules.begin(), context.rules.end(), waits)) return;
    const absl::StatusOr<Alternatives> alternatives = ToAlternatives(FormulaOf(context));
    if (!alternatives.ok()) return;
    const std::string others =
        condition.contexts.size() + condition.cases.size() > 1 ? ", whatever the other alternatives say" : "";
    if (HoldsAlways(*alternatives)) {
      const bool one_expression = context.rules.size() == 1 && context.rules[0].expression;
      Warn(one_expression         ? context.rules[0].expression_text.span
           : context.name.given() ? context.name.span
                                  : context.span,
           context.name.empty() ? "the context always holds"
                                : Concat("context ", context.name.value, " always holds"),
           Concat(effect, others, "; write a rule with constraints that may hold or not"), kAlwaysTrue);
      return;
    }
    for (const Rule& rule : context.rules) {
      if (!rule.expression) continue;
      const absl::StatusOr<Alternatives> of_rule = ToAlternatives(FormulaOf(rule));
      if (of_rule.ok() && HoldsAlways(*of_rule))
        Warn(rule.expression_text.span, "the rule always holds",
             "correct its expression, or leave the rule out", kAlwaysTrue);
    }
  }

  const Document& document_;
  xml::ElementReader& reader_;
  IriNames names_;
  std::unique_ptr<Schema> schema_;
  std::set<std::pair<size_t, std::string>> told_;
};

}  // namespace

void CheckConditions(const Document& document, const Environment* environment, xml::ElementReader* reader,
                     Cancellation* cancellation) {
  ConditionChecker(document, environment, reader).Check(cancellation);
}

}  // namespace docent::cawl
