// Large RDF files into a running server: read and checked whole here, sent in parts, each of which is a batch of its own,
// so that no message, turn or log record grows with the file. One thread.
// A load that stops half-way (a full disk) leaves the parts before it; loading again adds the rest.
#ifndef DOCENT_KB_SERVER_CLI_PART_LOADER_H_
#define DOCENT_KB_SERVER_CLI_PART_LOADER_H_

#include <grpcpp/grpcpp.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "docent/v1/ontologies.pb.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/formats/parser.h"

namespace docent::server {

// Above this size a data file goes in parts of about this size.
inline constexpr size_t kPartBytes = 4u << 20;

// A document as N-Triples or N-Quads, cut at line ends.
struct DocumentParts {
  std::string name;  // of its content, by which the server knows that the parts belong together
  std::string media_type;
  std::vector<std::string_view> parts;  // into the text that was cut, or into `owned`
  std::string owned;                    // the document in another syntax, written as N-Quads
  size_t bytes = 0;                     // of all parts
  size_t statements = 0;                // repeats included
  Diagnostics diagnostics;              // mistakes: then there are no parts
};
// `file` names the document in diagnostics. `text` is UTF-8. The result must not be copied or outlive `text`.
std::unique_ptr<DocumentParts> CutDocument(std::string_view text, RdfFormat format, const std::string& file,
                                           size_t part_bytes = kPartBytes, const std::string& base_iri = "");

// Sums of the replies to parts. Where a part failed, the ones before it, and perhaps some after it, are in the graph.
struct PartsOutcome {
  grpc::Status status;
  uint64_t added = 0, removed = 0, inferred = 0;
  uint64_t revision = 0;                                        // of the newest part
  size_t parts = 0;                                             // that the server has acknowledged
  google::protobuf::RepeatedPtrField<v1::Diagnostic> warnings;  // of the server, each once
};
// Sends the parts to Ontologies.Load, a few at a time: the server reads one while it applies another. `request` says name
// and graph. `progress(bytes done)` is called after each part.
PartsOutcome LoadParts(const std::shared_ptr<grpc::Channel>& channel, const DocumentParts& document,
                       const v1::LoadRequest& request, const std::function<void(size_t)>& progress);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_PART_LOADER_H_
