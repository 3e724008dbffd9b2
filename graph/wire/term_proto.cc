#include "graph/wire/term_proto.h"

#include "graph/rdf/vocabulary.h"

namespace docent {

void ToProto(const Term& term, v1::Term* out) {
  switch (term.kind) {
    case TermKind::kIri:
      out->set_iri(term.lexical);
      return;
    case TermKind::kBlank:
      out->set_blank(term.lexical);
      return;
    case TermKind::kLiteral:
      out->mutable_literal()->set_lexical(term.lexical);
      out->mutable_literal()->set_datatype(term.datatype);
      out->mutable_literal()->set_language(term.language);
      return;
  }
}

void ToProto(const TermQuad& quad, v1::Quad* out) {
  ToProto(quad.subject, out->mutable_subject());
  ToProto(quad.predicate, out->mutable_predicate());
  ToProto(quad.object, out->mutable_object());
  if (!quad.graph.lexical.empty()) ToProto(quad.graph, out->mutable_graph());
}

std::optional<Term> FromProto(const v1::Term& term) {
  switch (term.kind_case()) {
    case v1::Term::kIri:
      return Term::Iri(term.iri());
    case v1::Term::kBlank:
      return Term::Blank(term.blank());
    case v1::Term::kLiteral:
      if (!term.literal().language().empty()) {
        Term literal = Term::LangString(term.literal().lexical(), term.literal().language());
        if (term.literal().datatype() != kRdfLangString) literal.datatype = term.literal().datatype();
        return literal;
      }
      return Term::Literal(term.literal().lexical(), term.literal().datatype());
    case v1::Term::KIND_NOT_SET:
      break;
  }
  return std::nullopt;
}

}  // namespace docent
