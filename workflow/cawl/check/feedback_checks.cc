// Activators that the facts of their own runs start again.
#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

// Words of ontology/run.ttl that stand in facts of runs alone.
constexpr std::array<std::string_view, 17> kOfRuns = {
    "runState", "nodeState", "invocationState", "ofRun",        "ofNode",       "workflow",
    "nodeName", "waitsFor",  "firedBecause",    "firedAt",      "usesRobot",    "hasVariable",
    "forValue", "childRun",  "parentRun",       "variableName", "variableValue"};
constexpr std::array<std::string_view, 3> kTypes = {"Run", "NodeInstance", "Invocation"};

std::string_view DocentName(const Term& term) {
  std::string_view iri = term.lexical;
  if (!term.IsIri() || !iri.starts_with(kDocentNs)) return "";
  return iri.substr(kDocentNs.size());
}

template <typename Names>
bool IsOneOf(const Term& term, const Names& names) {
  return std::find(names.begin(), names.end(), DocentName(term)) != names.end();
}

// In an activator no variable has a value.
bool IsOpen(const Word& word) {
  return word.kind != Word::Kind::kTerm || word.comparison != Word::Comparison::kNone;
}

bool NamesAWorkflow(const Constraint& constraint) {
  return constraint.verb.kind == Word::Kind::kTerm && DocentName(constraint.verb.term) == "workflow" &&
         constraint.object.kind == Word::Kind::kTerm;
}

// Whether it is a fact of runs of other workflows only.
bool LeavesOut(const Constraint& constraint, const std::string& own) {
  if (!NamesAWorkflow(constraint)) return false;
  const bool is_own = constraint.object.term.lexical == own;
  switch (constraint.object.comparison) {
    case Word::Comparison::kNone:
    case Word::Comparison::kEqual:
      return !is_own;
    default:
      return is_own;
  }
}

bool Mentions(const Formula& formula, const std::string& own) {
  if (formula.kind == Formula::Kind::kConstraint) {
    return NamesAWorkflow(*formula.constraint) && formula.constraint->object.term.lexical == own;
  }
  return std::any_of(formula.children.begin(), formula.children.end(),
                     [&own](const Formula& child) { return Mentions(child, own); });
}

// The constraint says more of the subject than that some fact is about it.
bool Narrows(const Constraint& constraint, const Word& subject) {
  return constraint.verb.kind == Word::Kind::kTerm && constraint.subject.kind == subject.kind &&
         constraint.subject.name == subject.name;
}

// Why facts of runs match the constraint; empty: they do not, or not as far as can be told.
std::string WhyFed(const Constraint& constraint, const Conjunction& conjunction) {
  const bool typed = constraint.subject.type_term && IsOneOf(*constraint.subject.type_term, kTypes);
  if (typed) return "is about runs, their nodes or invocations";
  if (constraint.verb.kind == Word::Kind::kTerm) {
    const bool is_type = constraint.verb.term.lexical == kRdfType && !IsOpen(constraint.object) &&
                         IsOneOf(constraint.object.term, kTypes);
    if (!is_type && !IsOneOf(constraint.verb.term, kOfRuns)) return "";
    return "is about runs, their nodes or invocations";
  }
  if (!IsOpen(constraint.subject) || !IsOpen(constraint.object) || constraint.subject.type_term) return "";
  const bool narrowed =
      std::any_of(conjunction.constraints.begin(), conjunction.constraints.end(),
                  [&constraint](const Constraint* other) { return Narrows(*other, constraint.subject); });
  return narrowed ? "" : "matches any fact";
}

// `told`: constraints that another alternative has, too.
void CheckAlternative(const Document& document, const Conjunction& conjunction,
                      std::set<const Constraint*>* told, xml::ElementReader* reader) {
  const std::string& own = document.name.value;
  const bool left_out =
      std::any_of(conjunction.constraints.begin(), conjunction.constraints.end(),
                  [&own](const Constraint* constraint) { return LeavesOut(*constraint, own); }) ||
      std::any_of(conjunction.absent.begin(), conjunction.absent.end(),
                  [&own](const Formula& absent) { return Mentions(absent, own); });
  // an event is told by somebody each time
  if (left_out || !conjunction.events.empty()) return;
  for (const Constraint* constraint : conjunction.constraints) {
    const std::string why = WhyFed(*constraint, conjunction);
    if (why.empty()) continue;
    if (!told->insert(constraint).second) return;
    const SourceSpan& place = constraint->name.given() ? constraint->name.span : constraint->subject.span;
    Diagnostic& report = reader->Warning(
        place, Concat("the runs that this activator starts may start it again: the constraint ", why),
        why == "matches any fact"
            ? "what a run is doing is told as facts, too; name a predicate, a class or a thing"
            : Concat("leave its own runs out: a constraint with docent:workflow and the object != \"", own,
                     "\", or the name of another workflow"));
    report.rule = kActivatorFeedsItself;
    return;
  }
}

}  // namespace

void CheckFeedback(const Document& document, xml::ElementReader* reader) {
  if (!document.activator) return;
  std::set<const Constraint*> told;
  for (const Formula& part : PartsOf(document.activator->condition)) {
    const absl::StatusOr<std::vector<Conjunction>> alternatives = ToAlternatives(part);
    if (!alternatives.ok()) return;  // an error says so
    for (const Conjunction& conjunction : *alternatives)
      CheckAlternative(document, conjunction, &told, reader);
  }
}

}  // namespace docent::cawl
