// The media types of answers: which one a client gets that says what it accepts. Pure functions.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_FORMATS_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_FORMATS_H_

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/term.h"
#include "graph/sparql/results/results.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

struct RowType {
  std::string_view asked;  // in Accept
  std::string_view told;   // as Content-Type
  sparql::ResultFormat format;
};
struct GraphType {
  std::string_view asked;
  std::string_view told;
  RdfFormat format;
};

// For rows and booleans; for graphs. Null: none that we have. Without Accept: JSON, Turtle.
const RowType* ChooseRowType(std::string_view accept);
const GraphType* ChooseGraphType(std::string_view accept);
// A graph as text of the type that a client likes best among those that can say all of it.
struct GraphText {
  std::optional<HttpResponse> refusal;  // 406: it accepts none such. The others are unset then
  std::string_view told;                // as Content-Type
  std::string text;
};
// RDF/XML has no way to write some predicates and characters: then it is what the client likes next. `triples` lie in no
// graph; ChooseGraphType has found a type.
GraphText WriteGraph(std::vector<TermQuad> triples, std::string_view accept,
                     const std::vector<std::pair<std::string, std::string>>& prefixes);
// 406, with what can be had.
HttpResponse NoRowType();
HttpResponse NoGraphType();

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_FORMATS_H_
