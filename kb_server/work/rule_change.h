// What a change of the rules would do to the newest version (Ontologies.PreviewRules). Any thread.
#ifndef DOCENT_KB_SERVER_WORK_RULE_CHANGE_H_
#define DOCENT_KB_SERVER_WORK_RULE_CHANGE_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/ids.h"
#include "kb_server/door/ports.h"
#include "reasoner/rules/rule_preview.h"

namespace docent::server {

struct RuleChange {
  Revision revision;  // that it was asked of
  rules::RulePreview facts;
};

// The rule set `name` would get `text`, or be removed; at most `shown` facts of each kind are told. Errors of
// rules::PreviewRules. May take long, until `cancellation` ends it.
absl::StatusOr<RuleChange> PreviewRuleChange(const RunPorts& ports, const std::string& name,
                                             const std::optional<std::string>& text, size_t shown,
                                             Cancellation* cancellation);

// The entailment regimes that the graph follows by these rule sets, or those in use: shapes may name them (sh:entailment).
std::vector<std::string> RegimesOf(const std::vector<rules::RuleSetText>& sets);
std::vector<std::string> RegimesOf(const RunPorts& ports);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_RULE_CHANGE_H_
