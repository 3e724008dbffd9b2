#include "kb_server/work/condition_cost.h"

#include <algorithm>
#include <chrono>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/cancellation.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"

namespace docent::server {
namespace {

using SteadyClock = std::chrono::steady_clock;

// Altogether, of one document.
constexpr std::chrono::milliseconds kMostTime{100};

bool IsWild(const sparql::TriplePattern& pattern) {
  return pattern.subject.IsVariable() && pattern.predicate.IsVariable() && pattern.object.IsVariable();
}

std::string Cost(const sparql::Query& query, const ReadPorts& ports, SteadyClock::time_point until) {
  const GraphVersionPtr version = ports.queries->Newest();
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - SteadyClock::now());
  if (left.count() <= 0) return "not measured: the others took the time";
  sparql::PrepareOptions options;
  options.functions = ports.functions;
  options.default_graph = sparql::DefaultGraph::kUnion;
  auto prepared = sparql::PreparedQuery::Prepare(query, *ports.dictionary, options);
  if (!prepared.ok()) return "not measured";
  Cancellation cancellation(left);
  const SteadyClock::time_point start = SteadyClock::now();
  size_t solutions = 0;
  const absl::Status status = (*prepared)->Select(
      {.version = version.get(), .cancellation = &cancellation, .now_us = ports.clock->Now()}, {},
      [&solutions](absl::Span<const TermId>) { return ++solutions != 0; });
  const double ms = std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count();
  const std::string size = absl::StrCat(" on ", version->size(), " facts");
  if (!status.ok()) return absl::StrCat("more than ", left.count(), " ms", size);
  return absl::StrFormat("%.2g ms and %d solutions%s", ms, solutions, size);
}

}  // namespace

std::string WhyWhole(const matching::TriggerAnalysis& analysis) {
  if (analysis.is_volatile)
    return "it depends on more than the graph, so that it is evaluated whole at every change";
  for (const matching::TriggerSource& trigger : analysis.triggers) {
    if (IsWild(trigger.pattern)) return "a pattern of three variables is matched by every change";
    if (trigger.required || !trigger.seeds.empty()) continue;
    const bool constant = !trigger.pattern.subject.IsVariable() && !trigger.pattern.object.IsVariable();
    if (!constant && trigger.polarity == matching::Polarity::kPositive)
      return "what a change matches in it binds nothing outside, so that it is evaluated whole";
  }
  return "";
}

Diagnostics CostWarnings(const cawl::CheckReport& report, const std::string& file, const ReadPorts& ports,
                         Cancellation* cancellation) {
  Diagnostics warnings;
  const SteadyClock::time_point until = SteadyClock::now() + kMostTime;
  for (const cawl::ConditionText& condition : report.conditions) {
    if (!cancellation->CheckNow().ok()) break;
    const sparql::ParsedQuery parsed = sparql::ParseQuery(condition.ask);
    if (!parsed.ok()) continue;
    const std::string why =
        WhyWhole(matching::AnalyseTriggers(matching::WithoutModifiers(*parsed.query.algebra)));
    if (why.empty()) continue;
    warnings.push_back(
        {file, condition.span, absl::StrCat("the condition of ", condition.place, " is expensive: ", why),
         absl::StrCat("one evaluation takes ", Cost(parsed.query, ports, until),
                      "; see docent_condition_whole_seconds_total in /metrics; name a predicate, "
                      "a subject or an object"),
         Diagnostic::Severity::kWarning});
  }
  return warnings;
}

}  // namespace docent::server
