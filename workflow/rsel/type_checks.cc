#include "workflow/rsel/type_checks.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/xml/element_reader.h"

namespace docent::rsel {
namespace {

// The types that robots tell of one operation's parts; of two robots that tell of the same part, the first counts.
class OperationTypes {
 public:
  explicit OperationTypes(const std::vector<OfferedOperation>& offered) {
    for (const OfferedOperation& o : offered) {
      ServiceTypes& types = by_name_[o.name];
      types.inputs.insert(o.input_types.begin(), o.input_types.end());
      types.outputs.insert(o.output_types.begin(), o.output_types.end());
    }
  }

  const ServiceTypes& Of(const std::string& operation) const {
    static const ServiceTypes* nothing = new ServiceTypes();
    const auto found = by_name_.find(operation);
    return found == by_name_.end() ? *nothing : found->second;
  }

 private:
  std::map<std::string, ServiceTypes> by_name_;
};

std::string TypeIn(const PartTypes& types, const std::string& part) {
  const auto found = types.find(part);
  return found == types.end() ? std::string() : found->second;
}

// The type of what a source gives: an input of the plan, or a result of one of its steps ("2.page").
std::string TypeOfSource(const Plan& plan, const PlanSource& source, const PartTypes& inputs,
                         const OperationTypes& operations) {
  if (source.constant) {
    if (!source.constant->IsLiteral()) return "";
    if (!source.constant->language.empty()) return std::string(kRdfLangString);
    return source.constant->datatype.empty() ? std::string(kXsdString) : source.constant->datatype;
  }
  const size_t dot = source.slot.find('.');
  if (dot == std::string::npos) return TypeIn(inputs, source.slot);
  const size_t step = std::stoul(source.slot.substr(0, dot));
  return TypeIn(operations.Of(plan.steps[step - 1].operation).outputs, source.slot.substr(dot + 1));
}

ServiceTypes TypesOf(const Plan& plan, const OperationTypes& operations) {
  ServiceTypes out{plan.input_types, plan.output_types};
  for (const PlanStep& step : plan.steps) {
    for (const auto& [part, source] : step.inputs) {
      if (source.constant || source.slot.find('.') != std::string::npos) continue;
      const std::string type = TypeIn(operations.Of(step.operation).inputs, part);
      if (!type.empty()) out.inputs.emplace(source.slot, type);
    }
  }
  for (const auto& [part, source] : plan.outputs) {
    const std::string type = TypeOfSource(plan, source, out.inputs, operations);
    if (!type.empty()) out.outputs.emplace(part, type);
  }
  return out;
}

class TypeChecker {
 public:
  TypeChecker(const Document& document, const ServiceRegistry& registry, const OperationTypes& operations)
      : document_(document), registry_(registry), operations_(operations) {}

  void Check(const Process& process) {
    PartTypes known, made;
    const Message* input = document_.FindMessage(process.input.value);
    if (input != nullptr) {
      for (const Part& part : input->parts) Keep(part.name.value, TypeOf(part), &known);
    }
    for (const Invoke& invoke : process.invokes) {
      if (!invoke.parallel) Move(&made, &known);
      const ServiceTypes types = TypesOfInvoked(process, invoke);
      CheckInputs(invoke, input, types.inputs, known);
      for (const Output& output : invoke.outputs)
        Keep(output.to.value, TypeIn(types.outputs, output.part.value), &made);
    }
    Move(&made, &known);
    const Message* output = document_.FindMessage(process.output.value);
    if (output == nullptr) return;
    for (const Part& part : output->parts) {
      const std::string given = TypeIn(known, part.name.value);
      if (MayBeOf(given, TypeOf(part))) continue;
      Warn(part.type.given() ? part.type.span : part.span,
           Concat("part ", part.name.value, " of message ", output->name.value, " is of ",
                  TypeName(TypeOf(part)), ", and what process ", process.name.value,
                  " keeps under this name is of ", TypeName(given)),
           "correct the type, or keep another result under this name");
    }
  }

  Diagnostics Take() { return std::move(diagnostics_); }

 private:
  static std::string TypeOf(const Part& part) {
    return part.type_term && part.type_term->IsIri() ? part.type_term->lexical : std::string();
  }
  // What is kept under a name replaces what was.
  static void Keep(const std::string& name, const std::string& type, PartTypes* types) {
    (*types)[name] = type;
  }
  static void Move(PartTypes* from, PartTypes* to) {
    for (auto& [name, type] : *from) (*to)[name] = std::move(type);
    from->clear();
  }

  ServiceTypes TypesOfInvoked(const Process& process, const Invoke& invoke) const {
    const PlanPtr nested =
        invoke.operation.value == process.name.value ? nullptr : registry_.Find(invoke.operation.value);
    return nested != nullptr ? TypesOf(*nested, operations_) : operations_.Of(invoke.operation.value);
  }

  void CheckInputs(const Invoke& invoke, const Message* message, const PartTypes& wanted,
                   const PartTypes& known) {
    for (const Input& input : invoke.inputs) {
      const std::string type = TypeIn(wanted, input.part.value);
      if (input.value) {
        const std::string fault = TypeFault(*input.value, type);
        if (fault.empty()) continue;
        Warn(input.value_text.span,
             Concat("the value for part ", input.part.value, " of ", invoke.operation.value, " ", fault),
             Concat(invoke.operation.value, " takes ", input.part.value, " (", TypeName(type), ")"));
      } else {
        CheckName(invoke, input.part.value, input.from.value, input.from.span, type, known);
      }
    }
    if (!invoke.inputs.empty()) return;
    for (const auto& [part, type] : wanted) {
      const bool of_message =
          message != nullptr && std::any_of(message->parts.begin(), message->parts.end(),
                                            [&part = part](const Part& p) { return p.name.value == part; });
      if (of_message) CheckName(invoke, part, part, invoke.operation.span, type, known);
    }
  }

  void CheckName(const Invoke& invoke, const std::string& part, const std::string& name,
                 const SourceSpan& span, const std::string& wanted, const PartTypes& known) {
    const std::string given = TypeIn(known, name);
    if (MayBeOf(given, wanted)) return;
    Warn(span,
         Concat(name, " is of ", TypeName(given), ", and ", invoke.operation.value, " takes ", part, " of ",
                TypeName(wanted)),
         "no value is of both; correct the type of one of the two, or give something else");
  }

  void Warn(const SourceSpan& span, std::string message, std::string hint) {
    diagnostics_.push_back(
        {document_.file, span, std::move(message), std::move(hint), Diagnostic::Severity::kWarning});
    diagnostics_.back().rule = "type-clash";
  }

  const Document& document_;
  const ServiceRegistry& registry_;
  const OperationTypes& operations_;
  Diagnostics diagnostics_;
};

}  // namespace

ServiceTypes TypesOf(const Plan& plan, const std::vector<OfferedOperation>& offered) {
  return TypesOf(plan, OperationTypes(offered));
}

Diagnostics CheckTypes(const Document& document, const ServiceRegistry& registry,
                       const std::vector<OfferedOperation>& offered) {
  const OperationTypes operations(offered);
  TypeChecker checker(document, registry, operations);
  for (const Process& process : document.processes) checker.Check(process);
  return checker.Take();
}

absl::Status CheckComplete(const Plan& plan, const PartTypes& input_types, const Arguments& arguments) {
  std::vector<std::string> missing;
  for (const std::string& input : plan.inputs) {
    if (!arguments.contains(input)) missing.push_back(input);
  }
  if (missing.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(Concat("service ", plan.process, " needs a value for ",
                                           xml::ListOf(missing), "; it takes ",
                                           PartsText(plan.inputs, input_types)));
}

absl::Status CheckArguments(const Plan& plan, const PartTypes& input_types, const Arguments& arguments) {
  const auto refuse = [&](const std::string& what) {
    return absl::InvalidArgumentError(
        Concat("service ", plan.process, " ", what, "; it takes ", PartsText(plan.inputs, input_types)));
  };
  for (const auto& [name, value] : arguments) {
    if (std::find(plan.inputs.begin(), plan.inputs.end(), name) == plan.inputs.end())
      return refuse(Concat("has no part ", name));
    if (const std::string fault = TypeFault(value, TypeIn(input_types, name)); !fault.empty())
      return refuse(Concat("cannot take ", ToDisplay(value), " as ", name, ", which ", fault));
  }
  return CheckComplete(plan, input_types, arguments);
}

}  // namespace docent::rsel
