// RSEL text → syntax tree, with every mistake that can be seen in the document alone, each with its place. Any thread.
#ifndef DOCENT_WORKFLOW_RSEL_PARSER_H_
#define DOCENT_WORKFLOW_RSEL_PARSER_H_

#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "workflow/rsel/ast.h"

namespace docent::rsel {

struct ParsedRsel {
  DocumentPtr document;     // null when the XML itself is broken or the root is not rsel
  Diagnostics diagnostics;  // in order of the text
  // True if the document may be registered.
  bool ok() const { return document != nullptr && !HasErrors(diagnostics); }
};

ParsedRsel ParseRsel(std::string_view text, const std::string& file, const Limits& limits = {});

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_PARSER_H_
