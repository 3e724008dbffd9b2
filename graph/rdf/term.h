// An RDF 1.1 term as text (RDF 1.1 Concepts, section 3), for the network, the log and parsers; inside the
// store a term is a TermId (graph/rdf/term_id.h). Values; any thread.
#ifndef DOCENT_GRAPH_RDF_TERM_H_
#define DOCENT_GRAPH_RDF_TERM_H_

#include <string>
#include <string_view>
#include <utility>

namespace docent {

enum class TermKind : uint8_t { kIri, kBlank, kLiteral };

// A language tag with its ASCII letters in lower case, the form for comparison.
std::string LowerLanguage(std::string_view tag);
bool SameLanguage(std::string_view a, std::string_view b);

struct Term {
  TermKind kind = TermKind::kIri;
  std::string
      lexical;  // the IRI (absolute), the blank node label (without "_:"), or the lexical form (UTF-8)
  std::string
      datatype;  // literals only: the datatype IRI; empty means xsd:string, or rdf:langString with a language
  std::string language;  // literals only: the language tag as written, or empty

  static Term Iri(std::string iri) { return {TermKind::kIri, std::move(iri), {}, {}}; }
  static Term Blank(std::string label) { return {TermKind::kBlank, std::move(label), {}, {}}; }
  // A literal of datatype xsd:string is normalised to an empty `datatype`: equal terms are equal structs.
  static Term Literal(std::string lexical, std::string datatype = "");
  static Term LangString(std::string lexical, std::string language);
  static Term Integer(int64_t value);
  static Term Boolean(bool value);

  bool IsIri() const { return kind == TermKind::kIri; }
  bool IsBlank() const { return kind == TermKind::kBlank; }
  bool IsLiteral() const { return kind == TermKind::kLiteral; }

  // Language tags compare without case (RDF 1.1 Concepts section 3.3), here and below: "a"@en-GB and "a"@en-gb are one term.
  friend bool operator==(const Term& a, const Term& b) {
    return a.kind == b.kind && a.lexical == b.lexical && a.datatype == b.datatype &&
           SameLanguage(a.language, b.language);
  }
  // Blank nodes < IRIs < literals, then by text: a total order that does not depend on ids (the order of
  // kinds is that of SPARQL 1.1 section 15.1). "First in term order" in CAWL means this.
  friend bool operator<(const Term& a, const Term& b);
  template <typename H>
  friend H AbslHashValue(H h, const Term& t) {
    return H::combine(std::move(h), static_cast<int>(t.kind), t.lexical, t.datatype,
                      LowerLanguage(t.language));
  }
};

// A term with its quad, as text. An empty graph IRI (`graph.lexical.empty()`) means "no graph given":
// the door then uses the batch's source graph or docent:default.
struct TermQuad {
  Term subject;
  Term predicate;
  Term object;
  Term graph;

  friend bool operator==(const TermQuad&, const TermQuad&) = default;
};

// N-Triples form: <iri>, _:label, "text"@en, "1"^^<…integer>, with the escapes of N-Triples.
std::string ToNTriples(const Term& term);
// `iri` shortened by the well-known prefixes of vocabulary.h and `…` otherwise in <>; for people only.
std::string ToDisplay(const Term& term);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TERM_H_
