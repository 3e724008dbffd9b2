// Origin of an inconsistency report (reasoner/rules/inconsistency.h): its check and the check's solution.
//
// A report does not name the rule set of its check and, for a body with more than triple patterns, not all
// matches. But check and solution determine the report: so the checks of its name are solved, and the
// solutions with exactly this report are returned. A body of triple patterns is matched only with the
// evidence, however many other reports exist.
//
// One thread, beside the writer: reads an immutable version, interns in a dictionary of the caller's own.
#ifndef DOCENT_REASONER_EXPLAIN_REPORT_ORIGINS_H_
#define DOCENT_REASONER_EXPLAIN_REPORT_ORIGINS_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/rule_base.h"

namespace docent::rules {
class RuleProgram;
}  // namespace docent::rules

namespace docent::explain {

class ReportOrigins {
 public:
  struct Origin {
    uint32_t rule = 0;                                   // in RuleBase::rules
    std::vector<std::pair<std::string, TermId>> values;  // of the check's variables, by name
  };

  // All arguments must outlive it.
  ReportOrigins(const GraphVersion& version, Dictionary& dictionary, const RuleBase& rules,
                const sparql::FunctionRegistry* functions, const sparql::RunOptions& run);
  ~ReportOrigins();

  // Empty for a fact that does not belong to a report. CANCELLED, DEADLINE_EXCEEDED.
  absl::StatusOr<std::vector<Origin>> Of(const Quad& fact);

 private:
  std::optional<TermId> ReportOf(TermId subject) const;

  const GraphVersion& version_;
  Dictionary& dictionary_;
  const RuleBase& rules_;
  const sparql::FunctionRegistry* functions_;
  const sparql::RunOptions run_;
  std::shared_ptr<rules::RuleProgram> program_;  // null: not built yet
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_REPORT_ORIGINS_H_
