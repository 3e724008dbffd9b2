// Symbol table: the names that a place in a CAWL document sees, messages and variables of the scopes cawl ⊃ activator and
// cawl ⊃ flow ⊃ node. Points into the document, which must outlive it. Immutable; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_SYMBOL_TABLE_H_
#define DOCENT_WORKFLOW_CAWL_SYMBOL_TABLE_H_

#include <string>
#include <string_view>
#include <vector>

#include "workflow/cawl/ast.h"

namespace docent::cawl {

class Scope {
 public:
  explicit Scope(const Document& document);  // cawl
  Scope(const Scope& cawl, const Activator& activator);
  Scope(const Scope& cawl, const Flow& flow);
  Scope(const Scope& flow, const Node& node);

  // The innermost declaration; nullptr: none is visible.
  const Variable* FindVariable(std::string_view name) const;
  const Message* FindMessage(std::string_view name) const;
  // Names that are visible, inner scopes first.
  std::vector<std::string> VariableNames() const;
  std::vector<std::string> MessageNames() const;

  // The message that types `variable`; nullptr: it has no parts.
  const Message* PartsOf(const Variable& variable) const;
  // Every key under which the variable keeps values: "name", or "name.part" for each part.
  std::vector<std::string> Keys(const Variable& variable) const;

  const std::vector<Message>& messages() const { return *messages_; }  // this scope's own
  const std::vector<Variable>& variables() const { return *variables_; }

 private:
  const Scope* parent_ = nullptr;
  const std::vector<Message>* messages_;
  const std::vector<Variable>* variables_;
};

// An initial value of a variable when its scope is entered: of a flow when a run starts, of a node when it opens.
struct InitialValue {
  std::string key;            // "name" or "name.part"
  std::optional<Term> value;  // this
  std::string copy_of;        // or the value of this key, if it has one
};
// Of the scope's own variables, in document order. A copy of a whole variable with parts copies each part.
std::vector<InitialValue> InitialValues(const Scope& scope);

// Whether a variable of a run can be called so: "user", or "request.booth", a part of one.
bool IsVariableKey(std::string_view name);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_SYMBOL_TABLE_H_
