#include "workflow/cawl/check/check.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/workflow_limits.h"
#include "workflow/cawl/check/environment_checks.h"
#include "workflow/cawl/check/shared_starts.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/parser.h"

namespace docent::cawl {
namespace {

// Of new texts only: what a log or a snapshot holds was accepted, and stays so. True if a flow is too large.
bool CheckSizes(const Document& document, xml::ElementReader* reader) {
  bool too_large = false;
  for (const Flow& flow : document.flows) {
    const size_t most = kWorkflowLimits.flow_nodes;
    if (flow.nodes.size() <= most) continue;
    too_large = true;
    reader->Error(flow.name.span,
                  absl::StrCat("flow ", flow.name.value, " has ", flow.nodes.size(),
                               " nodes; the limit flow_nodes is ", most),
                  "divide it into flows that nodes invoke (subflow)");
  }
  return too_large;
}

// All that is said of a document whose text is read.
void CheckAll(const Document& document, const Environment* environment, const Limits& limits,
              const std::vector<DocumentPtr>& beside, Cancellation* cancellation, xml::ElementReader* reader,
              CheckReport* out) {
  const bool too_large = CheckSizes(document, reader);
  if (environment != nullptr && !too_large) CheckAgainst(document, *environment, reader, cancellation);
  // What is wrong in the text alone may leave words out of conditions.
  if (HasErrors(out->diagnostics) || too_large || IsOver(cancellation)) return;
  out->conditions = ConditionTexts(document, limits, reader, cancellation);
  CheckConditions(document, environment, reader, cancellation);
  CheckFeedback(document, reader);
  CheckSharedStarts(document, beside, reader, cancellation);
  CheckRaces(document, reader, cancellation);
  CheckRuns(document, reader, cancellation);
  CheckExchange(document, environment, reader, cancellation);
  CheckValues(document, environment, reader, cancellation);
  CheckTypes(document, environment, reader, cancellation);
  if (IsOver(cancellation)) return;
  CheckDatatypes(document, reader);
  CheckTimeouts(document, environment, reader);
}

}  // namespace

CheckReport CheckDocument(std::string_view text, const std::string& file, const Environment* environment,
                          const Limits& limits, const std::vector<DocumentPtr>& beside,
                          Cancellation* cancellation) {
  ParsedCawl parsed = ParseCawl(text, file, limits);
  CheckReport out;
  out.document = std::move(parsed.document);
  out.diagnostics = std::move(parsed.diagnostics);
  if (out.document == nullptr) return out;
  xml::ElementReader reader(out.document->source, file, kExtensionNs);
  CheckAll(*out.document, environment, limits, beside, cancellation, &reader, &out);
  if (cancellation != nullptr) out.stopped = cancellation->CheckNow();
  for (Diagnostic& d : reader.TakeDiagnostics()) out.diagnostics.push_back(std::move(d));
  std::stable_sort(out.diagnostics.begin(), out.diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
  if (!out.ok()) out.conditions.clear();
  return out;
}

}  // namespace docent::cawl
