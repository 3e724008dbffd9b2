#include "kb_server/http/http_formats.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/formats/rdf_xml.h"
#include "graph/rdf/formats/serializer.h"

namespace docent::server {
namespace {

using sparql::ResultFormat;

constexpr std::array<RowType, 7> kRowTypes = {{
    {"application/sparql-results+json", "application/sparql-results+json", ResultFormat::kJson},
    {"application/json", "application/json", ResultFormat::kJson},
    {"application/sparql-results+xml", "application/sparql-results+xml", ResultFormat::kXml},
    {"text/csv", "text/csv; charset=utf-8", ResultFormat::kCsv},
    {"text/tab-separated-values", "text/tab-separated-values; charset=utf-8", ResultFormat::kTsv},
    {"application/xml", "application/xml", ResultFormat::kXml},
    {"text/xml", "text/xml; charset=utf-8", ResultFormat::kXml},
}};

constexpr std::array<GraphType, 7> kGraphTypes = {{
    {"text/turtle", "text/turtle; charset=utf-8", RdfFormat::kTurtle},
    {"application/n-triples", "application/n-triples", RdfFormat::kNTriples},
    {"application/rdf+xml", "application/rdf+xml", RdfFormat::kRdfXml},
    {"application/trig", "application/trig", RdfFormat::kTriG},
    {"application/n-quads", "application/n-quads", RdfFormat::kNQuads},
    {"text/plain", "text/plain; charset=utf-8", RdfFormat::kNTriples},
    {"application/xml", "application/xml", RdfFormat::kRdfXml},
}};

template <typename Type>
const Type* Choose(const std::vector<const Type*>& types, std::string_view accept) {
  std::vector<std::string_view> offered;
  for (const Type* type : types) offered.push_back(type->asked);
  const std::optional<size_t> chosen = ChooseMediaType(accept, offered);
  return chosen ? types[*chosen] : nullptr;
}

std::vector<const GraphType*> GraphTypes(bool with_rdf_xml) {
  std::vector<const GraphType*> types;
  for (const GraphType& type : kGraphTypes) {
    if (with_rdf_xml || type.format != RdfFormat::kRdfXml) types.push_back(&type);
  }
  return types;
}

template <typename Types>
HttpResponse NotAcceptable(const Types& types) {
  std::string offered;
  for (const auto& type : types) offered.append(offered.empty() ? "" : ", ").append(type.asked);
  return TextResponse(406, "this answer can be had as " + offered);
}

}  // namespace

const RowType* ChooseRowType(std::string_view accept) {
  std::vector<const RowType*> types;
  for (const RowType& type : kRowTypes) types.push_back(&type);
  return Choose(types, accept);
}
const GraphType* ChooseGraphType(std::string_view accept) {
  return Choose(GraphTypes(true), accept);
}

GraphText WriteGraph(std::vector<TermQuad> triples, std::string_view accept,
                     const std::vector<std::pair<std::string, std::string>>& prefixes) {
  const GraphType* type = ChooseGraphType(accept);
  if (type->format == RdfFormat::kRdfXml) {
    absl::StatusOr<std::string> text = WriteRdfXml(triples, prefixes);
    if (text.ok()) return {std::nullopt, type->told, *std::move(text)};
    type = Choose(GraphTypes(false), accept);
    if (type == nullptr) return {TextResponse(406, std::string(text.status().message())), {}, {}};
  }
  absl::StatusOr<std::string> text = SerializeRdf(std::move(triples), type->format, prefixes);
  if (!text.ok()) return {ErrorResponse(text.status()), {}, {}};
  return {std::nullopt, type->told, *std::move(text)};
}

HttpResponse NoRowType() {
  return NotAcceptable(kRowTypes);
}
HttpResponse NoGraphType() {
  return NotAcceptable(kGraphTypes);
}

}  // namespace docent::server
