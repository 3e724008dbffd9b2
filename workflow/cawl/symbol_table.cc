#include "workflow/cawl/symbol_table.h"

#include <algorithm>

#include "workflow/xml/term_text.h"

namespace docent::cawl {
namespace {

template <typename T>
const T* FindNamed(const std::vector<T>& things, std::string_view name) {
  auto it = std::find_if(things.begin(), things.end(), [name](const T& t) { return t.name.value == name; });
  return it == things.end() ? nullptr : &*it;
}

}  // namespace

Scope::Scope(const Document& document) : messages_(&document.messages), variables_(&document.variables) {}
Scope::Scope(const Scope& cawl, const Activator& activator)
    : parent_(&cawl), messages_(&activator.messages), variables_(&activator.variables) {}
Scope::Scope(const Scope& cawl, const Flow& flow)
    : parent_(&cawl), messages_(&flow.messages), variables_(&flow.variables) {}
Scope::Scope(const Scope& flow, const Node& node)
    : parent_(&flow), messages_(&node.messages), variables_(&node.variables) {}

const Variable* Scope::FindVariable(std::string_view name) const {
  for (const Scope* s = this; s != nullptr; s = s->parent_) {
    if (const Variable* found = FindNamed(*s->variables_, name)) return found;
  }
  return nullptr;
}

const Message* Scope::FindMessage(std::string_view name) const {
  for (const Scope* s = this; s != nullptr; s = s->parent_) {
    if (const Message* found = FindNamed(*s->messages_, name)) return found;
  }
  return nullptr;
}

std::vector<std::string> Scope::VariableNames() const {
  std::vector<std::string> out;
  for (const Scope* s = this; s != nullptr; s = s->parent_) {
    for (const Variable& v : *s->variables_) out.push_back(v.name.value);
  }
  return out;
}

std::vector<std::string> Scope::MessageNames() const {
  std::vector<std::string> out;
  for (const Scope* s = this; s != nullptr; s = s->parent_) {
    for (const Message& m : *s->messages_) out.push_back(m.name.value);
  }
  return out;
}

const Message* Scope::PartsOf(const Variable& variable) const {
  return variable.type.empty() ? nullptr : FindMessage(variable.type.value);
}

std::vector<std::string> Scope::Keys(const Variable& variable) const {
  const Message* message = PartsOf(variable);
  if (message == nullptr) return {variable.name.value};
  std::vector<std::string> out;
  for (const Part& part : message->parts) out.push_back(variable.name.value + "." + part.name.value);
  return out;
}

std::vector<InitialValue> InitialValues(const Scope& scope) {
  std::vector<InitialValue> out;
  for (const Variable& variable : scope.variables()) {
    const Message* message = scope.PartsOf(variable);
    for (const Initialize& i : variable.initializers) {
      std::string key = variable.name.value;
      if (i.part.given()) key += "." + i.part.value;
      bool whole_copy = message != nullptr && !i.part.given() && !i.copy_of.empty();
      if (!whole_copy) {
        out.push_back({key, i.value, i.copy_of});
        continue;
      }
      for (const Part& part : message->parts) {
        out.push_back({key + "." + part.name.value, std::nullopt, i.copy_of + "." + part.name.value});
      }
    }
  }
  return out;
}

bool IsVariableKey(std::string_view name) {
  const size_t dot = name.find('.');
  return xml::IsVariableName(name.substr(0, dot)) &&
         (dot == std::string_view::npos || xml::IsVariableName(name.substr(dot + 1)));
}

}  // namespace docent::cawl
