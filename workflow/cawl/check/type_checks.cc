// Values of variables that are not of the type that is declared or needed: initial ones, those that conditions bind, those
// that operations take.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/check/schema.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

class TypeChecker {
 public:
  TypeChecker(const Document& document, const Environment* environment, xml::ElementReader* reader)
      : document_(document),
        environment_(environment),
        reader_(*reader),
        names_(IriNames::WellKnown()),
        cawl_(document) {
    if (environment != nullptr) schema_ = std::make_unique<Schema>(*environment);
    for (const auto& [prefix, iri] : document.prefixes) names_.Add(prefix, iri);
  }

  void Check(Cancellation* cancellation) {
    CheckInitialTypes(cawl_);
    if (document_.activator) {
      const Activator& activator = *document_.activator;
      const Scope scope(cawl_, activator);
      CheckInitialTypes(scope);
      const Flow* started = document_.FindFlow(activator.flow.value);
      const Scope of_flow = started == nullptr ? cawl_ : Scope(cawl_, *started);
      CheckBound(activator.condition, {&of_flow, &scope}, "run");
    }
    for (const Flow& flow : document_.flows) {
      const Scope scope(cawl_, flow);
      CheckInitialTypes(scope);
      for (const Node& node : flow.nodes) {
        if (IsOver(cancellation)) return;
        const Scope of_node(scope, node);
        if (node.condition) CheckBound(*node.condition, {&of_node}, "node");
        for (const Action& action : node.actions) CheckAssigned(of_node, action);
        for (const Invoke& invoke : node.invokes) CheckInputTypes(of_node, invoke);
      }
    }
  }

 private:
  void Warn(const SourceSpan& span, std::string message, const xml::Advice& advice) {
    reader_.Warning(span, std::move(message), advice).rule = kTypeClash;
  }

  // A class or datatype that a declaration names; empty: none.
  static std::string TypeOf(const std::optional<Term>& type) {
    return type && type->IsIri() ? type->lexical : std::string();
  }

  void CheckInitialTypes(const Scope& scope) {
    for (const Variable& variable : scope.variables()) {
      for (const Initialize& i : variable.initializers) {
        const std::string type = TypeOf(scope, variable, i.part.value);
        if (!type.empty() && i.value) CheckValue(*i.value, type, i.from_expression.span);
      }
    }
  }

  // The declared type of "name" or "name.part"; empty: none.
  static std::string TypeIn(const Scope& scope, const std::string& key) {
    const size_t dot = key.find('.');
    const Variable* variable = scope.FindVariable(key.substr(0, dot));
    if (variable == nullptr) return "";
    return TypeOf(scope, *variable, dot == std::string::npos ? "" : key.substr(dot + 1));
  }
  // `part`: empty, the variable as a whole.
  static std::string TypeOf(const Scope& scope, const Variable& variable, const std::string& part) {
    const Message* message = scope.PartsOf(variable);
    if (message == nullptr) return part.empty() ? TypeOf(variable.type_term) : "";
    const auto found = std::find_if(message->parts.begin(), message->parts.end(),
                                    [&](const Part& p) { return !part.empty() && p.name.value == part; });
    return found == message->parts.end() ? "" : TypeOf(found->type_term);
  }

  // An expression that is one constant, and what is taken where there is no value.
  void CheckAssigned(const Scope& scope, const Action& action) {
    for (const Text& output : action.computed.outputs) {
      const std::string type = TypeIn(scope, output.value);
      if (type.empty()) continue;
      if (action.computed.constant) CheckValue(*action.computed.constant, type, action.computed.text.span);
      if (action.otherwise) CheckValue(*action.otherwise, type, action.otherwise_text.span);
    }
  }

  // What a match of the condition gives to variables that declare a type. `scopes`: where they are looked for, one after the
  // other. `fails`: what does where a value is of another type.
  void CheckBound(const Condition& condition, const std::vector<const Scope*>& scopes,
                  std::string_view fails) {
    const auto type_of = [&](const Word& word) -> std::string {
      if (word.kind != Word::Kind::kFree && word.kind != Word::Kind::kVariable) return "";
      if (word.comparison != Word::Comparison::kNone) return "";
      for (const Scope* scope : scopes) {
        const Variable* variable = scope->FindVariable(word.name);
        if (variable != nullptr)
          return scope->PartsOf(*variable) == nullptr ? TypeOf(variable->type_term) : "";
      }
      return "";
    };
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        for (const Constraint& constraint : rule.constraints) {
          if (constraint.time != Constraint::Time::kNone) continue;
          for (const Word* word : {&constraint.subject, &constraint.object}) {
            const std::string type = type_of(*word);
            if (!type.empty()) CheckBound(constraint, *word, type, fails);
          }
        }
      }
    }
  }

  void CheckBound(const Constraint& constraint, const Word& word, const std::string& type,
                  std::string_view fails) {
    const auto warn = [&](const std::string& what) {
      Warn(word.span,
           Concat("variable ", word.name, " is of ", names_.Iri(type), ", and ", what, ": the ", fails,
                  " fails"),
           "correct the type of the variable, or the constraint");
    };
    // Of $x, what is a resource and what a literal is told with the condition.
    const bool told = word.kind == Word::Kind::kVariable && schema_ != nullptr;
    const bool datatype = IsDatatype(type);
    if (&word == &constraint.subject) {
      if (datatype && !told) warn("a subject is a resource");
      return;
    }
    std::set<std::string> others;
    if (word.type_term && word.type_term->IsIri()) others.insert(word.type_term->lexical);
    if (others.empty() && schema_ != nullptr && constraint.verb.kind == Word::Kind::kTerm)
      others = schema_->Ranges(constraint.verb.term.lexical);
    for (const std::string& other : others) {
      if (other == Concat(kRdfsNs, "Resource") || !Clash(type, other)) continue;
      if (told && (!datatype || !IsDatatype(other))) continue;
      return warn(Concat("a match gives it one of ", names_.Iri(other)));
    }
  }

  bool IsDatatype(const std::string& type) const {
    return schema_ != nullptr ? schema_->IsDatatype(type) : type.starts_with(kXsdNs);
  }

  void CheckValue(const Term& value, const std::string& type, const SourceSpan& span) {
    const bool datatype = IsDatatype(type);
    const std::string wanted = names_.Iri(type);
    if (datatype != value.IsLiteral()) {
      Warn(span,
           Concat("the value is a ", value.IsLiteral() ? "literal" : "resource", ", and the type ", wanted,
                  datatype ? " is a datatype" : " is a class"),
           datatype ? "write a literal" : "write prefix:local or <iri>");
      return;
    }
    if (datatype) {
      const ValueFamily given =
          FamilyOf(value.language.empty() ? value.datatype : std::string(kRdfLangString));
      const ValueFamily family = FamilyOf(type);
      if (type.starts_with(kXsdNs) && family != ValueFamily::kUnknown && given != ValueFamily::kUnknown &&
          given != family)
        Warn(span, Concat("the value is not of the type ", wanted), Concat("e.g. \"…\"^^", wanted));
      return;
    }
    if (schema_ == nullptr) return;
    for (const std::string& cls : schema_->TypesOf(value.lexical)) {
      if (!schema_->Disjoint(cls, type)) continue;
      Warn(span, Concat("the value is in ", names_.Iri(cls), ", which is disjoint with the type ", wanted),
           "correct the value or the type");
      return;
    }
  }

  using InputTypes = std::map<std::string, std::string>;

  // Those in which all operations agree that robots describe now and that `is_meant`.
  template <typename IsMeant>
  InputTypes AgreedTypes(IsMeant is_meant) const {
    std::optional<InputTypes> agreed;
    for (const DescribedOperation& operation : environment_->Described()) {
      if (!is_meant(operation)) continue;
      if (!agreed) {
        agreed = operation.input_types;
        continue;
      }
      std::erase_if(*agreed, [&operation](const auto& input) {
        const auto other = operation.input_types.find(input.first);
        return other == operation.input_types.end() || other->second != input.second;
      });
    }
    return agreed.value_or(InputTypes());
  }

  InputTypes InputTypesOf(const Invoke& invoke) const {
    const std::string& name = invoke.operation.value;
    if (invoke.capability.given()) {
      return AgreedTypes([&](const DescribedOperation& operation) {
        return std::any_of(
            operation.capabilities.begin(), operation.capabilities.end(),
            [&](const std::string& cls) { return Concat("<", cls, ">") == name || IsBelow(cls, name); });
      });
    }
    const std::optional<OperationSignature> operation = environment_->FindOperation(name);
    if (!operation) return {};
    if (!operation->of_robot) return operation->input_types;
    return AgreedTypes([&](const DescribedOperation& described) { return described.name == name; });
  }

  // `wanted` in brackets.
  bool IsBelow(const std::string& cls, const std::string& wanted) const {
    const auto& above = schema_->ClassesAbove(cls);
    return std::any_of(above.begin(), above.end(),
                       [&](const std::string& iri) { return Concat("<", iri, ">") == wanted; });
  }

  // What another expression gives is not known.
  void CheckConstant(const Input& input, const std::string& type) {
    if (input.computed.constant && !type.empty())
      CheckValue(*input.computed.constant, type, input.computed.text.span);
  }

  // The types of variables against those of what is invoked.
  void CheckInputTypes(const Scope& scope, const Invoke& invoke) {
    if (const Flow* flow = document_.FindFlow(invoke.subflow.value); !invoke.subflow.empty() && flow) {
      const Scope inner(cawl_, *flow);
      for (const Input& input : invoke.inputs) CheckConstant(input, TypeIn(inner, input.part.value));
    }
    if (environment_ == nullptr || invoke.operation.empty()) return;
    const std::string shown = invoke.capability.given()
                                  ? Concat("each operation of class ", names_.InText(invoke.operation.value))
                                  : Concat("operation ", invoke.operation.value);
    for (const auto& [input, wanted] : InputTypesOf(invoke)) {
      const Input* given = invoke.FindInput(input);
      if (given != nullptr && given->variable.empty()) {
        CheckConstant(*given, wanted);
        continue;
      }
      const std::string name = given == nullptr ? input : given->variable.value;
      const Variable* variable = scope.FindVariable(name);
      const std::string type = variable != nullptr ? TypeOf(variable->type_term) : std::string();
      if (type.empty() || !Clash(type, wanted)) continue;
      Warn(given == nullptr ? invoke.operation.span : given->variable.span,
           Concat(shown, " takes ", input, " of ", names_.Iri(wanted), ", and variable ", name, " is of ",
                  names_.Iri(type)),
           "no value is of both; correct the type of the variable, or invoke another operation");
    }
  }

  bool Clash(const std::string& a, const std::string& b) const {
    const bool of_values = IsDatatype(a);
    if (of_values != IsDatatype(b)) return true;
    if (!of_values) return schema_ != nullptr && schema_->Disjoint(a, b);
    const ValueFamily one = FamilyOf(a), other = FamilyOf(b);
    return a.starts_with(kXsdNs) && b.starts_with(kXsdNs) && one != ValueFamily::kUnknown &&
           other != ValueFamily::kUnknown && one != other;
  }

  const Document& document_;
  const Environment* environment_;
  xml::ElementReader& reader_;
  IriNames names_;
  const Scope cawl_;
  std::unique_ptr<Schema> schema_;
};

}  // namespace

void CheckTypes(const Document& document, const Environment* environment, xml::ElementReader* reader,
                Cancellation* cancellation) {
  TypeChecker(document, environment, reader).Check(cancellation);
}

}  // namespace docent::cawl
