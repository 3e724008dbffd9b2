#include "kb_server/grpc/template_proto.h"

#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

void Add(const std::vector<templates::TemplatePart>& parts,
         google::protobuf::RepeatedPtrField<v1::Part>* out) {
  for (const templates::TemplatePart& part : parts) {
    v1::Part* added = out->Add();
    added->set_name(part.name);
    added->set_type(part.type);
  }
}

}  // namespace

void ToProto(const templates::ImportedTemplates& imported, v1::ImportTemplatesReply* out) {
  for (const templates::NodeTemplate& one : imported.templates) {
    v1::NodeTemplate* to = out->add_templates();
    to->set_operation(one.operation);
    to->set_service(one.service);
    to->set_endpoint(one.endpoint);
    to->set_documentation(one.documentation);
    to->set_cawl(one.cawl);
    Add(one.inputs, to->mutable_inputs());
    Add(one.outputs, to->mutable_outputs());
  }
  for (const Diagnostic& diagnostic : imported.diagnostics) ToProto(diagnostic, out->add_diagnostics());
}

}  // namespace docent::server
