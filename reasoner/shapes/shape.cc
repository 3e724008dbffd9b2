#include "reasoner/shapes/shape.h"

#include <array>

namespace docent::shapes {
namespace {

// In the order of Component.
constexpr std::array<std::string_view, 31> kNames = {"Class",
                                                     "Datatype",
                                                     "NodeKind",
                                                     "MinCount",
                                                     "MaxCount",
                                                     "MinExclusive",
                                                     "MinInclusive",
                                                     "MaxExclusive",
                                                     "MaxInclusive",
                                                     "MinLength",
                                                     "MaxLength",
                                                     "Pattern",
                                                     "LanguageIn",
                                                     "UniqueLang",
                                                     "Equals",
                                                     "Disjoint",
                                                     "LessThan",
                                                     "LessThanOrEquals",
                                                     "Not",
                                                     "And",
                                                     "Or",
                                                     "Xone",
                                                     "Node",
                                                     "Property",
                                                     "QualifiedMinCount",
                                                     "QualifiedMaxCount",
                                                     "Closed",
                                                     "HasValue",
                                                     "In",
                                                     "SPARQL",
                                                     ""};

}  // namespace

std::string_view ComponentName(Component component) {
  return kNames[static_cast<size_t>(component)];
}

std::string ParameterName(Component component) {
  if (component == Component::kSparql) return "sparql";
  std::string name(ComponentName(component));
  if (!name.empty()) name[0] = static_cast<char>(name[0] | 0x20);
  return name;
}

}  // namespace docent::shapes
