#include "workflow/cawl/parser.h"

#include <utility>

#include "workflow/cawl/document_reader.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/time_reader.h"

namespace docent::cawl {

ParsedCawl ParseCawl(std::string_view text, const std::string& file, const Limits& limits) {
  ParsedCawl out;
  xml::ParsedXml parsed = xml::ParseXml(text, file, limits);
  if (parsed.root == nullptr) {
    out.diagnostics = std::move(parsed.diagnostics);
    return out;
  }
  auto document = std::make_shared<Document>();
  document->file = file;
  document->source = text;
  xml::ElementReader reader(document->source, file, kExtensionNs, parsed.root.get());
  if (ReadDocument(*parsed.root, limits, &reader, document.get())) {
    CheckNames(*document, &reader);
    CheckFreeNames(*document, &reader);
    CheckFlows(*document, &reader);
    CheckLastingRules(*document, &reader);
    CheckTimes(*document, &reader);
    out.document = std::move(document);
  }
  out.diagnostics = reader.TakeDiagnostics();
  return out;
}

}  // namespace docent::cawl
