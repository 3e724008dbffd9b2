// docent services import: services elsewhere as node templates. No server is needed.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "docent/v1/robot_services.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/grpc/template_proto.h"
#include "kb_server/imports/service_import.h"
#include "workflow/templates/wsdl_reader.h"

namespace docent::server {
namespace {

absl::StatusOr<templates::ImportedTemplates> Import(const std::vector<std::string>& from) {
  const bool network = from.size() == 2 && (from[0] == "grpc" || from[0] == "adapter");
  if (network) return from[0] == "grpc" ? ImportFromGrpc(from[1]) : ImportFromAdapter(from[1]);
  const bool word = from[0] == "grpc" || from[0] == "adapter";
  if (from.size() == 2 && from[0] != "wsdl")
    return absl::InvalidArgumentError(absl::StrCat(
        "\"", from[0], "\" is nothing to import from; write FILE.wsdl, grpc HOST:PORT or adapter HOST:PORT"));
  if (word)
    return absl::InvalidArgumentError(absl::StrCat("the address is missing: write ", from[0], " HOST:PORT"));
  const std::string& file = from.back();
  absl::StatusOr<std::string> text = ReadBytes(file, kDocumentText);
  if (!text.ok()) return text.status();
  templates::ImportedTemplates imported = templates::ReadWsdl(*text, file);
  if (HasErrors(imported.diagnostics)) return ToStatus(imported.diagnostics, *text);
  return imported;
}

}  // namespace

int ImportServices(const ServiceArguments& arguments) {
  const absl::StatusOr<templates::ImportedTemplates> imported = Import(arguments.names);
  if (!imported.ok()) return Fail(imported.status());
  v1::ImportTemplatesReply reply;
  ToProto(*imported, &reply);
  if (arguments.client.json) {
    for (const v1::NodeTemplate& one : reply.templates()) PrintJson(one);
  } else {
    for (const v1::NodeTemplate& one : reply.templates()) PrintForPrograms(one.cawl());
  }
  PrintDiagnostics(reply.diagnostics());
  return kExitOk;
}

}  // namespace docent::server
