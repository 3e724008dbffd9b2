// Any bytes as a document to lay out: refused with a sound diagnostic, or the same document, and laid out for good.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_check.h"
#include "tests/workflow/xml/same_document.h"
#include "workflow/xml/formatter.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace docent;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const xml::FormattedXml once = xml::FormatXml(text, "f");
  fuzz::RequireSound(once.diagnostics, text);
  if (!once.ok()) return 0;
  const xml::FormattedXml twice = xml::FormatXml(once.text, "f");
  fuzz::Require(twice.ok(), "what was laid out is not well-formed:\n" + once.text);
  fuzz::Require(xml::Content(once.text) == xml::Content(text), "another document:\n" + once.text);
  fuzz::Require(twice.text == once.text, "laid out otherwise the second time:\n" + once.text);
  return 0;
}
