// Whether two XML texts are the same document but for layout.
#ifndef DOCENT_TESTS_WORKFLOW_XML_SAME_DOCUMENT_H_
#define DOCENT_TESTS_WORKFLOW_XML_SAME_DOCUMENT_H_

#include <string>
#include <string_view>

#include "graph/base/text.h"
#include "workflow/xml/markup.h"
#include "workflow/xml/xml_document.h"

namespace docent::xml {

inline void Describe(const Element& element, std::string* out) {
  *out += Concat("<", element.prefix, ":", element.name, " in ", element.namespace_iri);
  for (const Attribute& a : element.attributes)
    *out += Concat(" ", a.prefix, ":", a.name, " in ", a.namespace_iri, "=", a.value.value, ";");
  *out += Concat("> text ", element.text.value, "\n");
  for (const auto& child : element.children) Describe(*child, out);
  *out += Concat("</", element.name, ">\n");
}

// Everything but layout: elements, attributes in order, texts, comments and processing instructions.
inline std::string Content(std::string_view text) {
  const ParsedXml parsed = ParseXml(text, "f");
  if (parsed.root == nullptr) return "not well-formed";
  std::string out;
  Describe(*parsed.root, &out);
  const auto markup = SplitMarkup(text);
  for (const Markup& piece : *markup) {
    if (piece.kind == Markup::Kind::kComment || piece.kind == Markup::Kind::kInstruction)
      out += Concat(piece.text, "\n");
  }
  return out;
}

}  // namespace docent::xml

#endif  // DOCENT_TESTS_WORKFLOW_XML_SAME_DOCUMENT_H_
