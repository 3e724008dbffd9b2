#include "workflow/cawl/check/check.h"

#include <algorithm>
#include <utility>

#include "workflow/cawl/check/environment_checks.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/parser.h"

namespace docent::cawl {

CheckReport CheckDocument(std::string_view text, const std::string& file, const Environment* environment,
                          const Limits& limits) {
  ParsedCawl parsed = ParseCawl(text, file, limits);
  CheckReport out;
  out.document = std::move(parsed.document);
  out.diagnostics = std::move(parsed.diagnostics);
  if (out.document == nullptr) return out;
  xml::ElementReader reader(out.document->source, file, kExtensionNs);
  if (environment != nullptr) CheckAgainst(*out.document, *environment, &reader);
  // What is wrong in the text alone may leave words out of conditions.
  if (!HasErrors(out.diagnostics)) {
    out.conditions = ConditionTexts(*out.document, limits, &reader);
    CheckConditions(*out.document, environment, &reader);
    CheckRuns(*out.document, &reader);
    CheckValues(*out.document, environment, &reader);
    CheckTimeouts(*out.document, environment, limits, &reader);
  }
  for (Diagnostic& d : reader.TakeDiagnostics()) out.diagnostics.push_back(std::move(d));
  std::stable_sort(out.diagnostics.begin(), out.diagnostics.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
  if (!out.ok()) out.conditions.clear();
  return out;
}

}  // namespace docent::cawl
