// Preview of a change of the rules: the facts that it would add and remove. The change is applied in a
// separate engine, on a private copy of a graph version. Any thread; the caller owns the result.
#ifndef DOCENT_REASONER_RULES_RULE_PREVIEW_H_
#define DOCENT_REASONER_RULES_RULE_PREVIEW_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"

namespace docent::rules {

struct RuleSetText {
  std::string name;
  std::string text;
};

struct RulePreview {
  size_t added = 0;  // number of facts that would be inferred in addition
  size_t removed = 0;
  std::vector<std::string> added_triples;  // the first of them, N-Triples, sorted
  std::vector<std::string> removed_triples;
};

// `current`: the rule sets of `version`. `text`: the new text of the set `name`; nullopt: its removal. Lists
// at most `shown` triples of each kind. INVALID_ARGUMENT with the rendered diagnostics; NOT_FOUND for the
// removal of an unknown set; RESOURCE_EXHAUSTED like a turn with this change. `cancellation` ends it early,
// as an error; null: none, and no limit of steps.
absl::StatusOr<RulePreview> PreviewRules(const Dictionary& dictionary, const GraphVersionPtr& version,
                                         const std::vector<RuleSetText>& current, const std::string& name,
                                         const std::optional<std::string>& text, size_t shown,
                                         const Limits& limits, const sparql::FunctionRegistry* functions,
                                         Cancellation* cancellation = nullptr);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_PREVIEW_H_
