// Everything that can be said about a CAWL document before it runs: `docent check`, Workflows.Check, Workflows.Deploy.
// Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_CHECK_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_CHECK_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "workflow/cawl/ask_compiler.h"
#include "workflow/cawl/check/environment.h"

namespace docent::cawl {

struct CheckReport {
  DocumentPtr document;                   // as ParsedCawl::document
  Diagnostics diagnostics;                // errors and warnings, in order of the text
  std::vector<ConditionText> conditions;  // empty when there are errors
  absl::Status stopped;                   // why the check ended early; OK: it is complete
  bool ok() const { return stopped.ok() && document != nullptr && !HasErrors(diagnostics); }
};

// Beyond ParseCawl, an error for each condition that can never be asked: one that is too long, or has too many
// alternatives. `environment` null: operations, services and ontology words are not checked. With one:
//  warning  an `invoke` that names neither an RSEL process nor an operation that a robot offers now
//  error    an `invoke` of a flow that is not there
//  error    an input part of an RSEL process for which no variable of that name can have a value; of a robot's own
//           operation a warning
//  warning  a class, property or resource that the ontology does not have, with the nearest that it has
// and, in a document without errors, the warnings of static_checks.h. docs/reference/findings.md has all kinds.
// `beside`: workflows that are deployed, too (shared_starts.h). `cancellation`: ends the check early; null: nothing does.
CheckReport CheckDocument(std::string_view text, const std::string& file, const Environment* environment,
                          const Limits& limits = {}, const std::vector<DocumentPtr>& beside = {},
                          Cancellation* cancellation = nullptr);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_CHECK_H_
