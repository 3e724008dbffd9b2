// CAWL text → syntax tree, with every mistake that can be seen without knowing the ontology or the robots:
// XML errors, unknown elements and attributes, missing and repeated names, unknown prefixes, malformed words and
// expressions, and the checks of structure_checks.h. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_PARSER_H_
#define DOCENT_WORKFLOW_CAWL_PARSER_H_

#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "workflow/cawl/ast.h"

namespace docent::cawl {

struct ParsedCawl {
  DocumentPtr
      document;  // null when the XML itself is broken or the root is not CAWL; else as far as it was understood
  Diagnostics diagnostics;  // in order of the text
  // True if the document may be deployed.
  bool ok() const { return document != nullptr && !HasErrors(diagnostics); }
};

// `file` is the name that diagnostics show.
ParsedCawl ParseCawl(std::string_view text, const std::string& file, const Limits& limits = {});

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_PARSER_H_
