// docent services list and show: the robot services that are registered.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "docent/v1/robot_services.grpc.pb.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/services/version_texts.h"

namespace docent::server {
namespace {

// "booth (docent:Booth), times (xsd:integer)"; "nothing".
std::string PartsText(const google::protobuf::RepeatedPtrField<v1::Part>& parts, const Presenter& presenter) {
  if (parts.empty()) return "nothing";
  return absl::StrJoin(parts, ", ", [&](std::string* out, const v1::Part& part) {
    absl::StrAppend(out, part.name());
    if (!part.type().empty()) absl::StrAppend(out, " (", presenter.Iri(part.type()), ")");
  });
}

void PrintService(const v1::RobotService& service, const Presenter& presenter) {
  std::cout << service.name() << "\n"
            << "  takes     " << PartsText(service.input_parts(), presenter) << "\n"
            << "  gives     " << PartsText(service.output_parts(), presenter) << "\n";
  const int steps = service.steps_size();
  for (int i = 0; i < steps; ++i) {
    const v1::ServiceStep& step = service.steps(i);
    std::cout << (i == 0 ? "  steps     " : "            ") << i + 1 << "/" << steps << " "
              << step.operation();
    if (!step.service().empty()) std::cout << " (" << step.service() << ")";
    std::cout << "\n";
  }
  std::cout << "  robots    "
            << (service.robots().empty() ? std::string("none offers all of it now")
                                         : absl::StrJoin(service.robots(), ", ",
                                                         [&](std::string* out, const std::string& iri) {
                                                           out->append(presenter.Iri(iri));
                                                         }))
            << "\n"
            << "  document  " << service.document();
  if (!service.version().empty()) std::cout << " " << service.version();
  std::cout << ", version " << service.registered_version() << ", registered with revision "
            << service.revision() << "\n";
}

// The text of the document that is `name`, or that defines the service `name`.
int ShowText(const ServiceArguments& arguments, const std::string& document) {
  absl::StatusOr<v1::ListVersionsReply> versions = ServiceVersions(arguments.client, document);
  if (!versions.ok()) return Fail(versions.status());
  const absl::StatusOr<v1::DeployedVersion> version =
      VersionOf(*versions, arguments.versions.empty() ? 0 : arguments.versions[0], document);
  if (!version.ok()) return Fail(version.status());
  if (arguments.client.json)
    PrintJson(*version);
  else
    PrintForPrograms(version->text());
  return kExitOk;
}

}  // namespace

int ListServices(const ServiceArguments& arguments) {
  const ClientOptions& options = arguments.client;
  v1::ListServicesReply reply;
  grpc::ClientContext context;
  grpc::Status status = v1::RobotServices::NewStub(Connect(options))->List(&context, {}, &reply);
  if (!status.ok()) return Fail(status, options);
  if (options.json) {
    for (const v1::RobotService& service : reply.services()) PrintJson(service);
    return kExitOk;
  }
  if (reply.services().empty()) {
    std::cerr << "no robot service is registered\n";
    return kExitOk;
  }
  const Presenter presenter(options);
  Table table({"service", "steps", "robots that offer all of it", "from"});
  table.KeepWhole({0});
  for (const v1::RobotService& service : reply.services()) {
    const auto operation = [](std::string* out, const auto& step) { out->append(step.operation()); };
    const auto named = [&](std::string* out, const std::string& iri) { out->append(presenter.Iri(iri)); };
    const bool offered = !service.robots().empty();
    table.Add({absl::StrCat(service.name(), "(", absl::StrJoin(service.inputs(), ", "), ")"),
               absl::StrJoin(service.steps(), " → ", operation),
               {offered ? absl::StrJoin(service.robots(), " ", named) : "none now",
                offered ? Style::kPlain : Style::kFaint},
               absl::StrCat(service.document(), " ", service.version())});
  }
  std::cout << table.Render(presenter.terminal());
  return kExitOk;
}

int ShowService(const ServiceArguments& arguments) {
  v1::DescribeServiceRequest request;
  request.set_name(arguments.name);
  v1::RobotService service;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::RobotServices::NewStub(Connect(arguments.client))->Describe(&context, request, &service);
  const bool text = arguments.text || !arguments.versions.empty();
  // A name of a document, too: all of it is its text.
  if (status.error_code() == grpc::StatusCode::NOT_FOUND &&
      (text || ServiceVersions(arguments.client, arguments.name).ok()))
    return ShowText(arguments, arguments.name);
  if (!status.ok()) return Fail(status, arguments.client);
  if (text) return ShowText(arguments, service.document());
  if (arguments.client.json)
    PrintJson(service);
  else
    PrintService(service, Presenter(arguments.client));
  return kExitOk;
}

}  // namespace docent::server
