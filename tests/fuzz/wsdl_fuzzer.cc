// Any bytes as a WSDL document: sound diagnostics, or templates that CAWL can take.
#include <cstddef>
#include <cstdint>

#include "graph/base/workflow_limits.h"
#include "tests/fuzz/fuzz_check.h"
#include "workflow/templates/wsdl_reader.h"
#include "workflow/xml/term_text.h"
#include "workflow/xml/xml_document.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace docent;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const templates::ImportedTemplates imported = templates::ReadWsdl(text, "f");
  fuzz::RequireSound(imported.diagnostics, text);
  fuzz::Require(!imported.templates.empty() || !imported.diagnostics.empty(), "nothing, without a word");
  fuzz::Require(imported.templates.empty() || !HasErrors(imported.diagnostics),
                "templates of a refused document");
  fuzz::Require(imported.templates.size() <= kWorkflowLimits.import_templates, "too many templates");
  for (const templates::NodeTemplate& one : imported.templates) {
    for (const auto* parts : {&one.inputs, &one.outputs}) {
      fuzz::Require(parts->size() <= kWorkflowLimits.import_parts, "too many parts");
      for (const templates::TemplatePart& part : *parts)
        fuzz::Require(xml::IsVariableName(part.name), "a part's name that no document may have");
    }
    fuzz::Require(xml::ParseXml(one.cawl, "node").root != nullptr, "a node that is not well-formed");
  }
  return 0;
}
