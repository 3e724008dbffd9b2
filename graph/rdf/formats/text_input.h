// Text that people hand to docent: a file, standard input, an argument. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_TEXT_INPUT_H_
#define DOCENT_GRAPH_RDF_FORMATS_TEXT_INPUT_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/rdf/formats/parser.h"

namespace docent {

// The whole file, or standard input for "-", unpacked where it is gzip. NOT_FOUND and the like name the file; a directory
// is none. RESOURCE_EXHAUSTED: it is larger than unpacked_bytes.
absl::StatusOr<std::string> ReadBytes(const std::string& path);

// The same where it is UTF-8, as all is that goes to a server.
absl::StatusOr<std::string> ReadText(const std::string& path);

// An RDF document of a file, or of standard input.
struct RdfText {
  std::string
      text;  // in UTF-8 where the file's encoding is one that is read; else its bytes, which no parser takes
  RdfFormat format = RdfFormat::kTurtle;
  std::string base_iri;  // what relative IRIs are relative to; empty: nothing
  bool is_utf8 = true;

  // For parsing it; `file` is for diagnostics.
  ParseRdfOptions Options(const std::string& file) const;
};
// `format`: as an ending ("ttl"); empty: that of the name, and Turtle where it has none that says something. `base`: empty:
// the file's IRI, and none for standard input. INVALID_ARGUMENT: the name says a format that is not read.
absl::StatusOr<RdfText> ReadRdf(const std::string& path, const std::string& base,
                                const std::string& format = "");
// The same where it is UTF-8, as all is that goes to a server.
absl::StatusOr<RdfText> ReadRdfToSend(const std::string& path, const std::string& base,
                                      const std::string& format = "");

// INVALID_ARGUMENT with the place of the first byte that is not UTF-8. `file`: for the message; empty for an argument.
absl::Status CheckUtf8(const std::string& text, const std::string& file);

// What a command was given of `what` ("query"): the text of `file` if one is named, else its argument.
absl::StatusOr<std::string> GivenText(const std::string& what, const std::string& argument,
                                      const std::string& file);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_TEXT_INPUT_H_
