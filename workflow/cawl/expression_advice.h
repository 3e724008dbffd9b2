// Advice on mistakes in expressions and SELECTs of a CAWL document, where the SPARQL parser cannot know what was meant. Pure
// function; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_EXPRESSION_ADVICE_H_
#define DOCENT_WORKFLOW_CAWL_EXPRESSION_ADVICE_H_

#include <string>

#include "graph/base/diagnostic.h"

namespace docent::cawl {

struct ExpressionAdvice {
  std::string message;
  std::string hint;
  SourceSpan span;  // in the text
};

// `text` is what was parsed, `mistake` what the parser says of it. `of_input`: of an <ext:input>.
ExpressionAdvice AdviceOn(const std::string& text, const Diagnostic& mistake, bool is_expression,
                          bool of_input);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_EXPRESSION_ADVICE_H_
