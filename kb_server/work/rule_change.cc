#include "kb_server/work/rule_change.h"

#include <utility>
#include <vector>

#include "reasoner/rules/rule_sets.h"

namespace docent::server {

absl::StatusOr<RuleChange> PreviewRuleChange(const RunPorts& ports, const std::string& name,
                                             const std::optional<std::string>& text, size_t shown,
                                             Cancellation* cancellation) {
  // The version first: the catalog that goes with it may be a turn newer, never older than its rules.
  const GraphVersionPtr version = ports.queries->Newest();
  std::vector<rules::RuleSetText> current;
  const auto catalog = ports.catalog->Get();
  for (const ModuleEntry& module : catalog->modules) {
    if (module.kind == Document::Kind::kRules && module.text != nullptr)
      current.push_back({module.name, *module.text});
  }
  absl::StatusOr<rules::RulePreview> facts = rules::PreviewRules(
      *ports.dictionary, version, current, name, text, shown, ports.limits, ports.functions, cancellation);
  if (!facts.ok()) return facts.status();
  return RuleChange{version->revision(), *std::move(facts)};
}

std::vector<std::string> RegimesOf(const std::vector<rules::RuleSetText>& sets) {
  std::vector<std::string> regimes;
  for (const rules::RuleSetText& set : sets) {
    if (set.text != rules::BuiltInRuleSet(set.name)) continue;
    for (std::string& regime : rules::EntailmentRegimes(set.name)) regimes.push_back(std::move(regime));
  }
  return regimes;
}

std::vector<std::string> RegimesOf(const RunPorts& ports) {
  std::vector<rules::RuleSetText> sets;
  for (const auto& set : ports.catalog->Get()->rules) sets.push_back({set.name, *set.text});
  return RegimesOf(sets);
}

}  // namespace docent::server
