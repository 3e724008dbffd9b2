#include "graph/store/bulk_loader.h"

#include <utility>

#include "graph/rdf/formats/line_parser.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

BulkLoader::BulkLoader(Dictionary& dictionary)
    : dictionary_(dictionary), default_graph_(dictionary.InternIri(kDefaultGraph)) {}

Diagnostics BulkLoader::Add(std::string_view text, RdfFormat format, const ParseRdfOptions& options) {
  const size_t before = quads_.size();
  Diagnostics diagnostics;
  if (format == RdfFormat::kNTriples || format == RdfFormat::kNQuads) {
    const auto take = [this](const TermQuad& quad) {
      Take(quad);
      return true;
    };
    diagnostics = ParseLines(text, format, options, take).diagnostics;
  } else {
    ParsedRdf parsed = ParseRdf(text, format, options);
    for (const TermQuad& quad : parsed.quads) Take(quad);
    diagnostics = std::move(parsed.diagnostics);
  }
  if (HasErrors(diagnostics)) quads_.resize(before);
  return diagnostics;
}

void BulkLoader::Build(GraphWriter& writer) {
  writer.AddAll(std::exchange(quads_, {}));
}

void BulkLoader::Take(const TermQuad& quad) {
  const TermId graph = quad.graph.lexical.empty() ? default_graph_ : IdOf(quad.graph, 3);
  quads_.push_back({IdOf(quad.subject, 0), IdOf(quad.predicate, 1), IdOf(quad.object, 2), graph});
}

TermId BulkLoader::IdOf(const Term& term, int position) {
  if (!last_id_[position].IsNone() && last_[position] == term) return last_id_[position];
  last_[position] = term;
  return last_id_[position] = dictionary_.Intern(term);
}

}  // namespace docent
