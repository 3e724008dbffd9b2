// Texts of the versions of a document, as the server keeps them. One thread.
#ifndef DOCENT_KB_SERVER_CLI_SERVICES_VERSION_TEXTS_H_
#define DOCENT_KB_SERVER_CLI_SERVICES_VERSION_TEXTS_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "docent/v1/workflows.pb.h"
#include "kb_server/cli/client.h"

namespace docent::server {

// With their texts, oldest first; at least one. The error is the server's, in one line.
absl::StatusOr<v1::ListVersionsReply> ServiceVersions(const ClientOptions& options,
                                                      const std::string& document);

// The one of that number; 0: the newest. NOT_FOUND, with the numbers that are kept.
absl::StatusOr<v1::DeployedVersion> VersionOf(const v1::ListVersionsReply& versions, uint32_t number,
                                              const std::string& document);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_SERVICES_VERSION_TEXTS_H_
