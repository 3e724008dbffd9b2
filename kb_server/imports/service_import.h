// Import of services over the network: node templates of what a gRPC server or a robot adapter describes. Blocking; any thread.
#ifndef DOCENT_KB_SERVER_IMPORTS_SERVICE_IMPORT_H_
#define DOCENT_KB_SERVER_IMPORTS_SERVICE_IMPORT_H_

#include <string>

#include "absl/status/statusor.h"
#include "workflow/templates/node_template.h"

namespace grpc {
class CallbackServerContext;
}  // namespace grpc

namespace docent::server {

// `parent`: the call that it is made for, with which it ends; null: none.

// The unary methods of the services of a gRPC server that has server reflection (v1alpha or v1), a template each. The fields of
// their messages become parts with datatypes of XML Schema; a field of another message has no type. Warnings: methods that
// stream, fields that repeat.
// INVALID_ARGUMENT: not HOST:PORT. Otherwise one line that says why: nothing answers, it has no reflection, it takes longer than
// import_timeout_ms, its descriptions do not fit together or are over the limits import_files and import_bytes.
absl::StatusOr<templates::ImportedTemplates> ImportFromGrpc(
    const std::string& target, const grpc::CallbackServerContext* parent = nullptr);

// The operations that a robot adapter describes.
absl::StatusOr<templates::ImportedTemplates> ImportFromAdapter(
    const std::string& target, const grpc::CallbackServerContext* parent = nullptr);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_IMPORTS_SERVICE_IMPORT_H_
