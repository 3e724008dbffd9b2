// Reader of input texts of the commands: a file, standard input, an argument. Any thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_TEXT_INPUT_H_
#define DOCENT_GRAPH_RDF_FORMATS_TEXT_INPUT_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/base/document_limits.h"
#include "graph/base/limits.h"
#include "graph/rdf/formats/parser.h"

namespace docent {

// How much of a file is read, packed or unpacked.
struct TextLimit {
  size_t bytes = kDocumentLimits.unpacked_bytes;
  std::string_view name = "unpacked_bytes";
};
// Of a text that goes to a server in one piece, and of a query and an update.
inline constexpr TextLimit kDocumentText = {Limits().document_bytes, "document_bytes"};
inline constexpr TextLimit kQueryText = {Limits().query_text_bytes, "query_text_bytes"};
inline constexpr TextLimit kUpdateText = {Limits().update_text_bytes, "update_text_bytes"};

// The whole file, or standard input for "-", unpacked if it is gzip. NOT_FOUND and the like name the file; a
// directory is NOT_FOUND. RESOURCE_EXHAUSTED: larger than the limit; reading and unpacking stop there.
absl::StatusOr<std::string> ReadBytes(const std::string& path, const TextLimit& limit = {});

// The same for text in UTF-8, as every text that is sent to a server must be.
absl::StatusOr<std::string> ReadText(const std::string& path, const TextLimit& limit = {});

// An RDF document from a file or standard input.
struct RdfText {
  std::string
      text;  // UTF-8 if the encoding is supported; else the original bytes, which every parser refuses
  RdfFormat format = RdfFormat::kTurtle;
  std::string base_iri;  // base of relative IRIs; empty: none
  bool is_utf8 = true;

  // Options to parse it; `file` is for diagnostics.
  ParseRdfOptions Options(const std::string& file) const;
};
// `format`: an ending ("ttl"); empty: by the file name, Turtle if the name has no known ending. `base`:
// empty: the file's IRI, and none for standard input. INVALID_ARGUMENT: the ending stands for a format that
// is not read.
absl::StatusOr<RdfText> ReadRdf(const std::string& path, const std::string& base,
                                const std::string& format = "", const TextLimit& limit = {});
// The same for text in UTF-8, as every text that is sent to a server must be.
absl::StatusOr<RdfText> ReadRdfToSend(const std::string& path, const std::string& base,
                                      const std::string& format = "", const TextLimit& limit = {});

// INVALID_ARGUMENT with the place of the first byte that is not UTF-8. `file`: for the message; empty for an argument.
absl::Status CheckUtf8(const std::string& text, const std::string& file);

// The input named `what` ("query") of a command: the text of `file` if one is named, else the argument.
absl::StatusOr<std::string> GivenText(const std::string& what, const std::string& argument,
                                      const std::string& file, const TextLimit& limit = {});

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_TEXT_INPUT_H_
