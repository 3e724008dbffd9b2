// Text that people hand to docent: a file, standard input, an argument. Any thread.
#ifndef DOCENT_GRAPH_RDF_TEXT_INPUT_H_
#define DOCENT_GRAPH_RDF_TEXT_INPUT_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace docent {

// The whole file, or standard input for "-". NOT_FOUND and the like name the file; a directory is none.
absl::StatusOr<std::string> ReadBytes(const std::string& path);

// The same where it is UTF-8, as all is that goes to a server.
absl::StatusOr<std::string> ReadText(const std::string& path);

// INVALID_ARGUMENT with the place of the first byte that is not UTF-8. `file`: for the message; empty for an argument.
absl::Status CheckUtf8(const std::string& text, const std::string& file);

// What a command was given of `what` ("query"): the text of `file` if one is named, else its argument.
absl::StatusOr<std::string> GivenText(const std::string& what, const std::string& argument,
                                      const std::string& file);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TEXT_INPUT_H_
