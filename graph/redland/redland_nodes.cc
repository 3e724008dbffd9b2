#include "graph/redland/redland_nodes.h"

namespace docent::redland {
namespace {

std::string Text(const unsigned char* bytes, size_t size) {
  return bytes == nullptr ? "" : std::string(reinterpret_cast<const char*>(bytes), size);
}

std::string Text(librdf_uri* uri) {
  size_t size = 0;
  const unsigned char* bytes = librdf_uri_as_counted_string(uri, &size);
  return Text(bytes, size);
}

}  // namespace

NodePtr ToNode(librdf_world* world, const Term& term) {
  const std::string& text = term.lexical;
  switch (term.kind) {
    case TermKind::kIri:
      return NodePtr(librdf_new_node_from_counted_uri_string(world, Bytes(text), text.size()));
    case TermKind::kBlank:
      return NodePtr(librdf_new_node_from_counted_blank_identifier(world, Bytes(text), text.size()));
    case TermKind::kLiteral:
      break;
  }
  UriPtr datatype;
  const bool tagged = !term.language.empty();
  if (!tagged && !term.datatype.empty()) {
    datatype.reset(librdf_new_uri2(world, Bytes(term.datatype), term.datatype.size()));
  }
  return NodePtr(librdf_new_node_from_typed_counted_literal(world, Bytes(text), text.size(),
                                                            tagged ? term.language.data() : nullptr,
                                                            term.language.size(), datatype.get()));
}

StatementPtr ToStatement(librdf_world* world, const TermQuad& quad) {
  return StatementPtr(librdf_new_statement_from_nodes(world, ToNode(world, quad.subject).release(),
                                                      ToNode(world, quad.predicate).release(),
                                                      ToNode(world, quad.object).release()));
}

std::optional<Term> FromNode(librdf_node* node) {
  if (node == nullptr) return std::nullopt;
  size_t size = 0;
  if (librdf_node_is_resource(node)) return Term::Iri(Text(librdf_node_get_uri(node)));
  if (librdf_node_is_blank(node)) {
    const unsigned char* label = librdf_node_get_counted_blank_identifier(node, &size);
    return Term::Blank(Text(label, size));
  }
  const unsigned char* value = librdf_node_get_literal_value_as_counted_string(node, &size);
  std::string text = Text(value, size);
  if (const char* language = librdf_node_get_literal_value_language(node)) {
    return Term::LangString(std::move(text), language);
  }
  librdf_uri* datatype = librdf_node_get_literal_value_datatype_uri(node);
  return Term::Literal(std::move(text), datatype == nullptr ? "" : Text(datatype));
}

TermQuad FromStatement(librdf_statement* statement, const Term& graph) {
  const auto part = [](librdf_node* node) { return FromNode(node).value_or(Term::Iri("")); };
  return {part(librdf_statement_get_subject(statement)), part(librdf_statement_get_predicate(statement)),
          part(librdf_statement_get_object(statement)), graph};
}

}  // namespace docent::redland
