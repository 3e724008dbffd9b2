#include "workflow/xml/xml_document.h"

#include <cmath>
#include <cstdint>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/xml/scanner.h"
#include "workflow/xml/well_formed.h"

namespace docent::xml {

const Attribute* Element::Find(std::string_view attribute_name) const {
  for (const Attribute& a : attributes) {
    if (a.prefix.empty() && a.name == attribute_name) return &a;
  }
  return nullptr;
}

ParsedXml ParseXml(std::string_view text, const std::string& file, const Limits& limits) {
  ParsedXml out;
  if (text.size() > limits.document_bytes) {
    out.diagnostics.push_back(
        {file,
         {},
         absl::StrCat("the document has ", text.size(),
                      " bytes, over the limit document_bytes = ", limits.document_bytes),
         ""});
    return out;
  }
  out.diagnostics = CheckWellFormed(text, file, limits);
  if (!out.diagnostics.empty()) return out;
  out.root = ScanXml(text);
  if (out.root == nullptr) {
    out.diagnostics.push_back(
        {file, SpanAt(text, 0), "XML of a form that is not understood", "report this document"});
  }
  return out;
}

bool ParseDurationMs(std::string_view text, int64_t* out_ms) {
  text = FromAbsl(absl::StripAsciiWhitespace(ToAbsl(text)));
  size_t digits = 0;
  while (digits < text.size() && (absl::ascii_isdigit(text[digits]) || text[digits] == '.')) ++digits;
  double number = 0;
  if (digits == 0 || !absl::SimpleAtod(ToAbsl(text.substr(0, digits)), &number)) return false;
  std::string_view unit = FromAbsl(absl::StripLeadingAsciiWhitespace(ToAbsl(text.substr(digits))));
  double scale = unit == "ms" ? 1 : unit == "s" ? 1000 : unit == "min" ? 60e3 : unit == "h" ? 3600e3 : 0;
  double ms = std::round(number * scale);
  constexpr double kMaxMs = 30.0 * 24 * 3600e3;
  if (!(ms >= 1) || ms > kMaxMs) return false;
  *out_ms = static_cast<int64_t>(ms);
  return true;
}

}  // namespace docent::xml
