#include "workflow/engine/run_values.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::engine {
namespace {

bool IsDatatype(const std::string& type) {
  return type.starts_with(kXsdNs) || type == Concat(kRdfNs, "langString") ||
         type == Concat(kRdfsNs, "Literal");
}

// The types that a value may have where one of the first kind is wanted, beside that itself.
bool IsWidened(const std::string& type, const std::string& actual) {
  const auto local = [](const std::string& iri) {
    return iri.starts_with(kXsdNs) ? iri.substr(kXsdNs.size()) : std::string();
  };
  const std::string wanted = local(type), given = local(actual);
  const std::vector<std::string> integers = {
      "integer", "int", "long", "short", "byte", "nonNegativeInteger", "positiveInteger"};
  const auto is_integer = [&](const std::string& name) {
    return std::find(integers.begin(), integers.end(), name) != integers.end();
  };
  if (is_integer(wanted)) return is_integer(given);
  if (wanted == "decimal") return is_integer(given);
  if (wanted == "double" || wanted == "float")
    return is_integer(given) || given == "decimal" || given == "double" || given == "float";
  return false;
}

absl::Status CheckType(const std::string& name, const std::optional<Term>& type, const Term& value) {
  if (!type) return absl::OkStatus();
  const auto clash = [&](std::string_view what) {
    return absl::InvalidArgumentError(absl::StrCat("$", name, " is of type ", ToDisplay(*type), ", and ",
                                                   ToDisplay(value), " is ", ToAbsl(what)));
  };
  if (!IsDatatype(type->lexical)) return value.IsLiteral() ? clash("a literal") : absl::OkStatus();
  if (!value.IsLiteral()) return clash("no literal");
  const std::string actual = !value.datatype.empty()   ? value.datatype
                             : !value.language.empty() ? Concat(kRdfNs, "langString")
                                                       : Concat(kXsdNs, "string");
  if (type->lexical == Concat(kRdfsNs, "Literal") || actual == type->lexical ||
      IsWidened(type->lexical, actual))
    return absl::OkStatus();
  if (type->lexical == Concat(kXsdNs, "string") && !value.language.empty()) return absl::OkStatus();
  return clash(Concat("of type ", ToDisplay(Term::Iri(actual))));
}

}  // namespace

absl::Status CheckValue(const Run& run, const std::string& name, const Term& value) {
  const cawl::Document& document = *run.document;
  const cawl::Scope cawl(document), of_flow(cawl, run.Flow());
  const std::string whole = name.substr(0, name.find('.'));
  const cawl::Variable* variable = of_flow.FindVariable(whole);
  std::optional<cawl::Scope> of_activator;
  if (document.activator && document.activator->flow.value == run.Flow().name.value) {
    of_activator.emplace(cawl, *document.activator);
    if (variable == nullptr) variable = of_activator->FindVariable(whole);
  }
  if (variable == nullptr) {
    if (run.variables.contains(name)) return absl::OkStatus();
    std::vector<std::string> names = of_flow.VariableNames();
    for (const auto& [known, of_run] : run.variables) names.push_back(known);
    const std::string near = Nearest(name, names);
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return absl::InvalidArgumentError(
        absl::StrCat("run ", run.id.value(), " has no variable ", name,
                     !near.empty()   ? absl::StrCat("; did you mean ", near, "?")
                     : names.empty() ? "; it has none"
                                     : absl::StrCat("; it has ", absl::StrJoin(names, ", "))));
  }
  const cawl::Message* parts = of_flow.PartsOf(*variable);
  if (parts == nullptr && whole != name)
    return absl::InvalidArgumentError(absl::StrCat("$", whole, " has no parts; set ", whole));
  if (parts == nullptr) return CheckType(name, variable->type_term, value);
  for (const cawl::Part& part : parts->parts) {
    if (absl::StrCat(whole, ".", part.name.value) == name) return CheckType(name, part.type_term, value);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("$", whole, " has parts: set one of ", absl::StrJoin(of_flow.Keys(*variable), ", ")));
}

}  // namespace docent::engine
