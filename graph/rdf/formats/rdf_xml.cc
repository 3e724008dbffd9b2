#include "graph/rdf/formats/rdf_xml.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/rdf_xml_reader.h"

namespace docent {
namespace {

// The end of the start tag at `at`: the offset of its '>', outside of quotes.
size_t EndOfTag(std::string_view text, size_t at) {
  for (char quote = 0; at < text.size(); ++at) {
    if (quote != 0) {
      if (text[at] == quote) quote = 0;
    } else if (text[at] == '"' || text[at] == '\'') {
      quote = text[at];
    } else if (text[at] == '>') {
      return at;
    }
  }
  return std::string_view::npos;
}

// Detects other syntaxes with the same file endings (.owl, .xml).
std::optional<Diagnostic> FindOtherSyntax(std::string_view text, const std::string& file) {
  const auto found = [&](size_t at, std::string message, std::string hint) {
    return Diagnostic{file, SpanAt(text, at, 1), std::move(message), std::move(hint)};
  };
  constexpr char kSaveAs[] = "save it as RDF/XML or Turtle; Protégé does so by File, Save as";
  size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  at = std::min(text.find_first_not_of(" \t\r\n", at), text.size());
  const std::string_view rest = text.substr(at);
  for (const std::string_view start : {"Prefix(", "Ontology("}) {
    if (rest.starts_with(start))
      return found(at, "this is OWL functional syntax, which is not read", kSaveAs);
  }
  for (const std::string_view start : {"Prefix:", "Ontology:"}) {
    if (rest.starts_with(start))
      return found(at, "this is OWL Manchester syntax, which is not read", kSaveAs);
  }
  const bool iri = rest.starts_with("<") &&
                   rest.substr(0, rest.find_first_of(" \t\r\n>")).find("://") != std::string_view::npos;
  if (iri || (!rest.empty() && !rest.starts_with("<"))) {
    return found(at, "this is not XML", "if it is Turtle, give the file a name that ends with .ttl");
  }
  size_t root = at;
  while (root != std::string_view::npos && (text.substr(root, 2) == "<?" || text.substr(root, 2) == "<!")) {
    if (text.substr(root, 4) == "<!--") root = text.find("-->", root);
    if (root != std::string_view::npos) root = text.find('<', root + 1);
  }
  if (root == std::string_view::npos) return std::nullopt;
  const std::string_view tag = text.substr(root, EndOfTag(text, root) - root);
  if (tag.starts_with("<Ontology") && tag.find("ontologyIRI") != std::string_view::npos) {
    return found(root, "this is OWL/XML, which is not RDF/XML and is not read", kSaveAs);
  }
  return std::nullopt;
}

}  // namespace

ParsedRdf ParseRdfXml(std::string_view text, const ParseRdfOptions& options, PlaceRecorder* places) {
  ParsedRdf refused;
  if (size_t at = text.find('\0'); at != std::string_view::npos) {
    refused.diagnostics.push_back({options.file, SpanAt(text, at, 1),
                                   "the character U+0000 is not allowed in XML", "is this a text file?"});
    return refused;
  }
  if (std::optional<Diagnostic> other = FindOtherSyntax(text, options.file)) {
    refused.diagnostics.push_back(*std::move(other));
    return refused;
  }
  return RdfXmlReader(text, options, places).Run();
}

}  // namespace docent
