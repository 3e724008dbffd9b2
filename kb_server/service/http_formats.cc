#include "kb_server/service/http_formats.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace docent {
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

template <typename Types>
const typename Types::value_type* Choose(const Types& types, std::string_view accept) {
  std::vector<std::string_view> offered;
  for (const auto& type : types) offered.push_back(type.asked);
  const std::optional<size_t> chosen = ChooseMediaType(accept, offered);
  return chosen ? &types[*chosen] : nullptr;
}

template <typename Types>
HttpResponse NotAcceptable(const Types& types) {
  std::string offered;
  for (const auto& type : types) offered.append(offered.empty() ? "" : ", ").append(type.asked);
  return TextResponse(406, "this answer can be had as " + offered);
}

}  // namespace

const RowType* ChooseRowType(std::string_view accept) {
  return Choose(kRowTypes, accept);
}
const GraphType* ChooseGraphType(std::string_view accept) {
  return Choose(kGraphTypes, accept);
}
HttpResponse NoRowType() {
  return NotAcceptable(kRowTypes);
}
HttpResponse NoGraphType() {
  return NotAcceptable(kGraphTypes);
}

}  // namespace docent
