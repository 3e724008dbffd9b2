// Versions of documents → messages. Pure function; any thread.
#ifndef DOCENT_KB_SERVER_GRPC_VERSION_PROTO_H_
#define DOCENT_KB_SERVER_GRPC_VERSION_PROTO_H_

#include "docent/v1/workflows.pb.h"
#include "kb_server/door/document_versions.h"

namespace docent::server {

// Oldest first.
void ToProto(const DocumentVersions& versions, bool with_texts, v1::ListVersionsReply* out);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_VERSION_PROTO_H_
