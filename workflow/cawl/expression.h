// Boolean expressions over the names of child elements: condition, rule and case @expression, wait @joinCondition.
//
//   expression ::= conjunction ("or" conjunction)*
//   conjunction ::= negation ("and" negation)*
//   negation ::= "not" negation | "(" expression ")" | NAME | "'" TEXT "'"
//
// `not` binds tighter than `and`, `and` tighter than `or`; the three words are reserved (any case). A NAME is
// anything without blanks and parentheses that does not begin with a quote. Any other name stands in quotes, in which \' and
// \\ stand for ' and \. Values; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_EXPRESSION_H_
#define DOCENT_WORKFLOW_CAWL_EXPRESSION_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "graph/base/diagnostic.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

struct Expression {
  enum class Kind { kName, kNot, kAnd, kOr };
  Kind kind = Kind::kName;
  std::string name;                  // kName
  std::vector<Expression> children;  // kNot: one; kAnd, kOr: two or more
  SourceSpan span;                   // kName: the name in the source
};

// `text` is an attribute's value. On an error reports it with the place inside of the expression and returns
// nullopt. Parentheses and `not` inside each other are limited by `max_nesting`.
std::optional<Expression> ParseExpression(const xml::Text& text, int max_nesting, xml::ElementReader* reader);

// The value of the expression when `value_of` gives the value of a name.
bool Evaluate(const Expression& expression, const std::function<bool(const std::string&)>& value_of);

// Every kName of the expression, in order of writing.
std::vector<const Expression*> NamesIn(const Expression& expression);

// The advice for a name in an expression that is none of `known`: the nearest one, the operator that it is written with
// (a&&b, !a), or `otherwise`. Its fix has no words that would have to be quoted there.
xml::Advice AdviceOnName(const Expression& name, const std::vector<std::string>& known,
                         const std::string& otherwise, const xml::ElementReader& reader);

// With the fewest parentheses and quotes that keep its meaning.
std::string ToText(const Expression& expression);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_EXPRESSION_H_
