// Names of datatypes that XML Schema does not have.
#include "workflow/cawl/check/static_checks.h"
#include "workflow/xml/datatype_names.h"

namespace docent::cawl {
namespace {

class DatatypeChecker {
 public:
  explicit DatatypeChecker(xml::ElementReader* reader) : reader_(*reader) {}

  void Check(const Document& document) {
    CheckScope(document);
    if (document.activator) {
      CheckScope(*document.activator);
      Check(document.activator->condition);
    }
    for (const Flow& flow : document.flows) {
      CheckScope(flow);
      for (const Node& node : flow.nodes) Check(node);
      for (const Link& link : flow.links) {
        if (link.while_constraint) Check(*link.while_constraint);
      }
    }
  }

 private:
  void CheckType(const std::optional<Term>& type, const SourceSpan& span) {
    if (type && type->IsIri()) xml::CheckDatatype(type->lexical, span, &reader_);
  }

  void CheckLiteral(const Term& term, const SourceSpan& span) {
    if (term.IsLiteral()) xml::CheckDatatype(term.datatype, span, &reader_);
  }

  template <typename ScopeElement>
  void CheckScope(const ScopeElement& element) {
    for (const Message& message : element.messages) {
      for (const Part& part : message.parts) CheckType(part.type_term, part.type.span);
    }
    for (const Variable& variable : element.variables) {
      CheckType(variable.type_term, variable.type.span);
      for (const Initialize& i : variable.initializers) {
        if (i.value) CheckLiteral(*i.value, i.from_expression.span);
      }
    }
  }

  void Check(const Node& node) {
    CheckScope(node);
    if (node.condition) Check(*node.condition);
    if (node.hold) Check(*node.hold);
    for (const Action& action : node.actions) {
      for (const Constraint& fact : action.facts) Check(fact);
      Check(action.computed);
      if (action.otherwise) CheckLiteral(*action.otherwise, action.otherwise_text.span);
    }
    for (const Invoke& invoke : node.invokes) {
      for (const Input& input : invoke.inputs) Check(input.computed);
    }
  }

  void Check(const Computation& computed) {
    if (computed.constant) CheckLiteral(*computed.constant, computed.text.span);
  }

  void Check(const Condition& condition) {
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        for (const Constraint& constraint : rule.constraints) Check(constraint);
      }
    }
  }

  void Check(const Constraint& constraint) {
    if (constraint.time != Constraint::Time::kNone) return;
    for (const Word* word : {&constraint.subject, &constraint.object}) {
      CheckType(word->type_term, word->type.span);
      if (word->kind == Word::Kind::kTerm)
        CheckLiteral(word->term, word->type.given() ? word->type.span : word->span);
    }
  }

  xml::ElementReader& reader_;
};

}  // namespace

void CheckDatatypes(const Document& document, xml::ElementReader* reader) {
  DatatypeChecker(reader).Check(document);
}

}  // namespace docent::cawl
