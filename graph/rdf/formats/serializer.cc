#include "graph/rdf/formats/serializer.h"

#include <algorithm>
#include <map>

#include "absl/strings/ascii.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/rdf_xml.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/turtle_scanner.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using Prefixes = std::vector<std::pair<std::string, std::string>>;

// True for a local name that needs neither escapes nor a check of dots.
bool IsPlainLocal(std::string_view local) {
  return std::all_of(local.begin(), local.end(),
                     [](unsigned char c) { return absl::ascii_isalnum(c) || c == '_' || c == '-'; }) &&
         !local.starts_with('-');
}

// RDF/XML has names and IRIs that Turtle cannot write.
bool IsPrefix(std::string_view name, std::string_view iri) {
  if (FindInvalidUtf8(name)) return false;
  const std::string declared = Concat(name, ":");
  TurtleScanner scanner(declared, /*line_based=*/false, declared.size());
  std::string_view read;
  return scanner.ReadPrefix(&read) && read == name && IsAbsoluteIri(iri) &&
         std::none_of(iri.begin(), iri.end(), [](unsigned char c) { return IsForbiddenInIri(c); });
}

// True if the literal matches Turtle's INTEGER or DECIMAL production and may be written without quotes.
bool IsBareNumber(const Term& term) {
  std::string_view text = term.lexical;
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  size_t point = text.find('.');
  bool digits = !text.empty() && text.back() != '.' &&
                std::all_of(text.begin(), text.end(),
                            [](unsigned char c) { return absl::ascii_isdigit(c) || c == '.'; });
  if (!digits) return false;
  if (term.datatype == kXsdInteger) return point == std::string_view::npos;
  return term.datatype == kXsdDecimal && point != std::string_view::npos &&
         text.find('.', point + 1) == std::string_view::npos;
}

bool ByText(const TermQuad& a, const TermQuad& b) {
  auto less = [](const Term& x, const Term& y) { return x < y; };
  if (a.graph != b.graph)
    return a.graph.lexical.empty() != b.graph.lexical.empty() ? a.graph.lexical.empty()
                                                              : less(a.graph, b.graph);
  if (a.subject != b.subject) return less(a.subject, b.subject);
  if (a.predicate != b.predicate) {
    bool a_type = a.predicate.lexical == kRdfType, b_type = b.predicate.lexical == kRdfType;
    return a_type != b_type ? a_type : less(a.predicate, b.predicate);
  }
  return less(a.object, b.object);
}

// Turtle and TriG writer: predicates and objects grouped by subject, in term order. Every blank node keeps
// its label, so cycles of blank nodes are written like any other.
class TurtleWriter {
 public:
  TurtleWriter(std::vector<TermQuad> quads, const Prefixes& prefixes) : quads_(std::move(quads)) {
    // The first declaration of a name counts.
    for (const auto& prefix : prefixes) {
      const bool taken = std::any_of(prefixes_.begin(), prefixes_.end(),
                                     [&](const auto& other) { return other.first == prefix.first; });
      if (!taken && IsPrefix(prefix.first, prefix.second)) prefixes_.push_back(prefix);
    }
    std::sort(quads_.begin(), quads_.end(), ByText);
    quads_.erase(std::unique(quads_.begin(), quads_.end()), quads_.end());
  }

  std::string Declarations() const {
    std::string out;
    for (const auto& [name, iri] : prefixes_)
      out += Concat("@prefix ", name, ": ", ToNTriples(Term::Iri(iri)), " .\n");
    return out;
  }

  // Behind the declarations, if they are to be there.
  std::string Write(bool declare) {
    if (declare) out_ = Declarations();
    for (size_t i = 0; i < quads_.size();) {
      if (!out_.empty()) out_ += '\n';
      if (quads_[i].graph.lexical.empty())
        i = WriteSubject(i, "");
      else
        i = WriteGraph(i);
    }
    return std::move(out_);
  }

 private:
  size_t WriteGraph(size_t i) {
    const Term graph = quads_[i].graph;
    out_ += Name(graph) + " {\n";
    while (i < quads_.size() && quads_[i].graph == graph) i = WriteSubject(i, "  ");
    out_ += "}\n";
    return i;
  }

  // Writes all quads about the subject of quad i; returns the index after them.
  size_t WriteSubject(size_t i, std::string_view indent) {
    const TermQuad& first = quads_[i];
    out_ += Concat(indent, Name(first.subject));
    for (size_t start = i;; ++i) {
      const TermQuad& quad = quads_[i];
      if (i == start || quad.predicate != quads_[i - 1].predicate) {
        if (i != start) out_ += Concat(" ;\n", indent, "   ");
        out_ += Concat(" ", quad.predicate.lexical == kRdfType ? "a" : Name(quad.predicate), " ",
                       Name(quad.object));
      } else {
        out_ += ", " + Name(quad.object);
      }
      bool more = i + 1 < quads_.size() && quads_[i + 1].subject == first.subject &&
                  quads_[i + 1].graph == first.graph;
      if (!more) break;
    }
    out_ += " .\n";
    return i + 1;
  }

  std::string Name(const Term& term) const {
    if (term.IsIri()) return IriName(term.lexical);
    if (term.IsBlank()) return ToNTriples(term);
    if (IsBareNumber(term)) return term.lexical;
    if (term.datatype == kXsdBoolean && (term.lexical == "true" || term.lexical == "false"))
      return term.lexical;
    if (term.datatype.empty()) return ToNTriples(term);
    return Concat(ToNTriples(Term::Literal(term.lexical)), "^^", IriName(term.datatype));
  }

  std::string IriName(std::string_view iri) const {
    for (const auto& [name, ns] : prefixes_) {
      if (!ns.empty() && iri.starts_with(ns) && IsPlainLocal(iri.substr(ns.size()))) {
        return Concat(name, ":", iri.substr(ns.size()));
      }
    }
    return ToNTriples(Term::Iri(std::string(iri)));
  }

  std::vector<TermQuad> quads_;
  Prefixes prefixes_;
  std::string out_;
};

std::string WriteLines(const std::vector<TermQuad>& quads) {
  std::string out;
  for (const TermQuad& quad : quads) {
    out += Concat(ToNTriples(quad.subject), " ", ToNTriples(quad.predicate), " ", ToNTriples(quad.object));
    if (!quad.graph.lexical.empty()) out += " " + ToNTriples(quad.graph);
    out += " .\n";
  }
  return out;
}

}  // namespace

absl::StatusOr<std::string> SerializeRdf(std::vector<TermQuad> quads, RdfFormat format,
                                         const std::vector<std::pair<std::string, std::string>>& prefixes) {
  bool has_graphs = format == RdfFormat::kTriG || format == RdfFormat::kNQuads;
  for (const TermQuad& quad : quads) {
    if (!has_graphs && !quad.graph.lexical.empty()) {
      return absl::InvalidArgumentError(Concat("this format has no named graphs, but a triple lies in ",
                                               ToNTriples(quad.graph), ": use TriG or N-Quads"));
    }
  }
  switch (format) {
    case RdfFormat::kNTriples:
    case RdfFormat::kNQuads:
      return WriteLines(quads);
    case RdfFormat::kRdfXml:
      return WriteRdfXml(quads, prefixes);
    case RdfFormat::kTurtle:
    case RdfFormat::kTriG:
      break;
  }
  return TurtleWriter(std::move(quads), prefixes).Write(/*declare=*/true);
}

std::string DeclarePrefixesInTurtle(const std::vector<std::pair<std::string, std::string>>& prefixes) {
  return TurtleWriter({}, prefixes).Declarations();
}

std::string SerializeTurtlePiece(std::vector<TermQuad> quads,
                                 const std::vector<std::pair<std::string, std::string>>& prefixes) {
  return TurtleWriter(std::move(quads), prefixes).Write(/*declare=*/false);
}

}  // namespace docent
