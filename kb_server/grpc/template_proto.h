// Node templates → messages. Pure function; any thread.
#ifndef DOCENT_KB_SERVER_GRPC_TEMPLATE_PROTO_H_
#define DOCENT_KB_SERVER_GRPC_TEMPLATE_PROTO_H_

#include "docent/v1/robot_services.pb.h"
#include "workflow/templates/node_template.h"

namespace docent::server {

void ToProto(const templates::ImportedTemplates& imported, v1::ImportTemplatesReply* out);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_TEMPLATE_PROTO_H_
