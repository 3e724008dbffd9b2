#include "reasoner/explain/hypothesis.h"

#include "graph/base/diagnostic.h"

namespace docent::explain {

absl::StatusOr<std::unique_ptr<Hypothesis>> Hypothesis::Make(GraphVersionPtr version, Dictionary& dictionary,
                                                             const std::vector<RuleText>& rules,
                                                             const sparql::FunctionRegistry* functions,
                                                             const Limits& limits,
                                                             Cancellation* cancellation) {
  std::unique_ptr<Hypothesis> made(
      new Hypothesis(std::move(version), dictionary, functions, limits, cancellation));
  for (const RuleText& set : rules) {
    const Diagnostics diagnostics =
        made->rules_.PutRules(set.name, *set.text, rules::RuleTextOrigin::kAccepted);
    if (HasErrors(diagnostics)) return ToStatus(diagnostics, *set.text);
  }
  made->rules_.Adopt();
  return made;
}

absl::Status Hypothesis::With(const std::vector<Quad>& add, const std::vector<Quad>& remove,
                              absl::FunctionRef<absl::Status(const GraphVersion&, const Delta&)> look) {
  const Delta told = writer_.Apply(add, remove);
  absl::StatusOr<Delta> all = rules_.Update(writer_, told, cancellation_);
  const absl::Status status = all.ok() ? look(writer_.current(), *all) : all.status();
  writer_.Rollback();
  rules_.Rollback();
  return status;
}

}  // namespace docent::explain
