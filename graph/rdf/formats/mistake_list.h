// List of the mistakes that a parser finds in one document, up to Limits::document_diagnostics. For readers of
// formats, as XmlReader. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_MISTAKE_LIST_H_
#define DOCENT_GRAPH_RDF_FORMATS_MISTAKE_LIST_H_

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "graph/base/diagnostic.h"
#include "graph/rdf/formats/parser.h"

namespace docent {

class MistakeList {
 public:
  // `text` and `options` must outlive it.
  MistakeList(std::string_view text, const ParseRdfOptions& options) : text_(text), options_(options) {}

  // Adds a mistake at byte `offset` of the text, up to the limit.
  void Error(size_t offset, std::string message, std::string hint = "") {
    Add(&errors_, Diagnostic::Severity::kError, offset, std::move(message), std::move(hint));
  }
  void Warning(size_t offset, std::string message, std::string hint = "") {
    Add(&warnings_, Diagnostic::Severity::kWarning, offset, std::move(message), std::move(hint));
  }

  bool has_errors() const { return !errors_.empty(); }
  // True if the list is full: the parser may stop.
  bool full() const { return errors_.size() >= options_.limits.document_diagnostics; }

  // In text order. Errors come before warnings if both do not fit.
  Diagnostics Take() {
    const size_t room = options_.limits.document_diagnostics - errors_.size();
    if (warnings_.size() > room) warnings_.resize(room);
    Diagnostics all = std::move(errors_);
    std::move(warnings_.begin(), warnings_.end(), std::back_inserter(all));
    std::stable_sort(all.begin(), all.end(),
                     [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
    errors_.clear();
    warnings_.clear();
    return all;
  }

 private:
  void Add(Diagnostics* to, Diagnostic::Severity severity, size_t offset, std::string message,
           std::string hint) {
    if (to->size() >= options_.limits.document_diagnostics) return;
    offset = std::min(offset, text_.size());
    to->push_back({options_.file, SpanAt(text_, offset, offset < text_.size() ? 1 : 0), std::move(message),
                   std::move(hint), severity});
  }

  std::string_view text_;
  const ParseRdfOptions& options_;
  Diagnostics errors_, warnings_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_MISTAKE_LIST_H_
