#include "workflow/engine/run_values.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/number_literal.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/symbol_table.h"
#include "workflow/rsel/part_types.h"

namespace docent::engine {
namespace {

// What a place sees. Points into the document.
class Declarations {
 public:
  explicit Declarations(const VariablePlace& place)
      : cawl_(place.document), flow_(cawl_, place.flow), innermost_(&flow_) {
    if (place.node != nullptr) innermost_ = &node_.emplace(flow_, *place.node);
    const auto& activator = place.document.activator;
    if (activator && activator->flow.value == place.flow.name.value) activator_.emplace(cawl_, *activator);
  }
  Declarations(const Declarations&) = delete;
  Declarations& operator=(const Declarations&) = delete;

  const cawl::Scope& scope() const { return *innermost_; }
  const cawl::Variable* Find(const std::string& name) const {
    const cawl::Variable* variable = innermost_->FindVariable(name);
    return variable == nullptr && activator_ ? activator_->FindVariable(name) : variable;
  }
  const cawl::Message* PartsOf(const cawl::Variable& variable) const {
    return Owner(variable).PartsOf(variable);
  }
  std::vector<std::string> Keys(const cawl::Variable& variable) const {
    return Owner(variable).Keys(variable);
  }
  // Of a variable, or of a part of one.
  std::optional<Term> TypeOf(const std::string& name) const {
    const std::string whole = name.substr(0, name.find('.'));
    const cawl::Variable* variable = Find(whole);
    if (variable == nullptr) return std::nullopt;
    const cawl::Message* parts = PartsOf(*variable);
    if (parts == nullptr) return whole == name ? variable->type_term : std::nullopt;
    for (const cawl::Part& part : parts->parts) {
      if (Concat(whole, ".", part.name.value) == name) return part.type_term;
    }
    return std::nullopt;
  }

 private:
  // What sees the message that types the variable.
  const cawl::Scope& Owner(const cawl::Variable& variable) const {
    return innermost_->FindVariable(variable.name.value) == &variable ? *innermost_ : *activator_;
  }

  const cawl::Scope cawl_, flow_;
  std::optional<cawl::Scope> node_, activator_;
  const cawl::Scope* innermost_;
};

// What `value` is, where it is not of the type: "a literal", "of type xsd:string". Empty: it is.
std::string WhatElse(const Term& value, const std::string& type, const IriNames& names) {
  if (!rsel::IsDatatype(type)) return value.IsLiteral() && value.datatype != type ? "a literal" : "";
  const bool untold_language = type == kRdfLangString && value.IsLiteral() && value.language.empty();
  if (!untold_language && rsel::TypeFault(value, type).empty()) return "";
  if (!value.IsLiteral()) return "no literal";
  const std::string given = !value.language.empty()  ? std::string(kRdfLangString)
                            : value.datatype.empty() ? std::string(kXsdString)
                                                     : value.datatype;
  if (!rsel::TypeFault(value, given).empty()) return Concat("not of the form of ", names.Iri(given));
  const bool whole = value.lexical.find_first_not_of("+-0123456789") == std::string::npos;
  if (IsNumberLiteral(value) && whole && rsel::MayBeOf(given, type))
    return Concat("not among the values of ", names.Iri(type));
  return Concat("of type ", names.Iri(given));
}

std::string FaultOf(const Declarations& declarations, const cawl::Document& document, const std::string& name,
                    const Term& value) {
  const std::optional<Term> type = declarations.TypeOf(name);
  if (!type || !type->IsIri()) return "";
  IriNames names = IriNames::WellKnown();
  for (const auto& [prefix, iri] : document.prefixes) names.Add(prefix, iri);
  const std::string what = WhatElse(value, type->lexical, names);
  if (what.empty()) return "";
  return Concat("$", name, " is of type ", names.Iri(type->lexical), ", and ", names.Show(value), " is ",
                what);
}

// The run, the activator or the flow has no such variable.
absl::Status Unknown(const Run& run, const std::string& name, std::vector<std::string> names) {
  for (const auto& [known, of_run] : run.variables) names.push_back(known);
  const std::string near = Nearest(name, names);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::erase_if(names, [](const std::string& known) { return known.starts_with("_"); });
  return absl::InvalidArgumentError(
      absl::StrCat("run ", run.id.value(), " has no variable ", name,
                   !near.empty()   ? absl::StrCat("; did you mean ", near, "?")
                   : names.empty() ? "; it has none"
                                   : absl::StrCat("; it has ", absl::StrJoin(names, ", "))));
}

}  // namespace

std::string TypeFault(const VariablePlace& place, const std::string& name, const Term& value) {
  return FaultOf(Declarations(place), place.document, name, value);
}

std::string TypeFault(const VariablePlace& place, const TermBinding& values) {
  if (values.empty()) return "";
  const Declarations declarations(place);
  for (const auto& [name, value] : values) {
    if (std::string fault = FaultOf(declarations, place.document, name, value); !fault.empty()) return fault;
  }
  return "";
}

absl::Status CheckValue(const Run& run, const std::string& name, const Term& value) {
  const Declarations declarations({*run.document, run.Flow()});
  const std::string whole = name.substr(0, name.find('.'));
  const cawl::Variable* variable = declarations.Find(whole);
  if (variable == nullptr) {
    if (run.variables.contains(name)) return absl::OkStatus();
    return Unknown(run, name, declarations.scope().VariableNames());
  }
  const cawl::Message* parts = declarations.PartsOf(*variable);
  if (parts == nullptr && whole != name)
    return absl::InvalidArgumentError(absl::StrCat("$", whole, " has no parts; set ", whole));
  if (parts != nullptr) {
    const std::vector<std::string> keys = declarations.Keys(*variable);
    if (std::find(keys.begin(), keys.end(), name) == keys.end())
      return absl::InvalidArgumentError(
          absl::StrCat("$", whole, " has parts: set one of ", absl::StrJoin(keys, ", ")));
  }
  const std::string fault = FaultOf(declarations, *run.document, name, value);
  return fault.empty() ? absl::OkStatus() : absl::InvalidArgumentError(fault);
}

}  // namespace docent::engine
