// Templates of the operations of a robot adapter.
#include "absl/strings/str_cat.h"
#include "docent/v1/robot_adapter.grpc.pb.h"
#include "kb_server/imports/import_channel.h"
#include "kb_server/imports/import_target.h"
#include "kb_server/imports/service_import.h"
#include "workflow/rsel/part_types.h"

namespace docent::server {
namespace {

void AddParts(const google::protobuf::RepeatedPtrField<std::string>& names,
              const google::protobuf::RepeatedPtrField<v1::Part>& parts,
              std::vector<templates::TemplatePart>* out) {
  for (const v1::Part& part : parts) AddPart(part.name(), rsel::FullType(part.type()), out);
  if (!parts.empty()) return;
  for (const std::string& name : names) AddPart(name, "", out);
}

}  // namespace

absl::StatusOr<templates::ImportedTemplates> ImportFromAdapter(const std::string& target,
                                                               const grpc::CallbackServerContext* parent) {
  if (absl::Status status = CheckTarget(target); !status.ok()) return status;
  const std::unique_ptr<grpc::ClientContext> context = ImportContext(parent);
  v1::RobotDescription description;
  const grpc::Status status = v1::RobotAdapter::NewStub(ImportChannel(target))
                                  ->Describe(context.get(), v1::DescribeRequest(), &description);
  if (!status.ok()) return ImportError(target, status, "is no robot adapter");
  templates::ImportedTemplates out;
  for (const v1::OperationDescription& operation : description.operations()) {
    if (!templates::IsOperationName(operation.name())) {
      out.diagnostics.push_back({target,
                                 {},
                                 "an operation has a name that cannot stand in a document; it is left out",
                                 "",
                                 Diagnostic::Severity::kWarning});
      continue;
    }
    if (out.templates.size() >= kWorkflowLimits.import_templates) {
      out.diagnostics.push_back({target,
                                 {},
                                 absl::StrCat("there are more operations; the limit import_templates is ",
                                              kWorkflowLimits.import_templates),
                                 "",
                                 Diagnostic::Severity::kWarning});
      break;
    }
    templates::NodeTemplate& one = out.templates.emplace_back();
    one.operation = operation.name();
    one.service = description.label().empty() ? description.robot() : description.label();
    one.endpoint = target;
    one.documentation = operation.description();
    AddParts(operation.inputs(), operation.input_parts(), &one.inputs);
    AddParts(operation.outputs(), operation.output_parts(), &one.outputs);
  }
  WriteCawl(&out.templates);
  return out;
}

}  // namespace docent::server
