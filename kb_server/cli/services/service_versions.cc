// docent services versions, diff and remove.
#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "docent/v1/robot_services.grpc.pb.h"
#include "graph/base/line_diff.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/services/version_texts.h"

namespace docent::server {
namespace {

grpc::Status Ask(const ClientOptions& options, const std::string& document, bool with_texts,
                 v1::ListVersionsReply* reply) {
  v1::ListServiceVersionsRequest request;
  request.set_document(document);
  request.set_with_texts(with_texts);
  grpc::ClientContext context;
  return v1::RobotServices::NewStub(Connect(options))->ListVersions(&context, request, reply);
}

std::string TimeText(int64_t time_us) {
  return absl::FormatTime("%Y-%m-%d %H:%M:%S", absl::FromUnixMicros(time_us), absl::LocalTimeZone());
}

}  // namespace

absl::StatusOr<v1::ListVersionsReply> ServiceVersions(const ClientOptions& options,
                                                      const std::string& document) {
  v1::ListVersionsReply reply;
  const grpc::Status status = Ask(options, document, true, &reply);
  if (status.ok()) return reply;
  return absl::Status(
      static_cast<absl::StatusCode>(status.error_code()),
      status.error_code() == grpc::StatusCode::UNAVAILABLE
          ? absl::StrCat("no server answers at ", options.server, " (", status.error_message(), ")")
          : status.error_message());
}

absl::StatusOr<v1::DeployedVersion> VersionOf(const v1::ListVersionsReply& versions, uint32_t number,
                                              const std::string& document) {
  for (const v1::DeployedVersion& version : versions.versions()) {
    if (version.number() == number) return version;
  }
  const v1::DeployedVersion& newest = *versions.versions().rbegin();
  if (number == 0) return newest;
  return absl::NotFoundError(absl::StrCat("document ", document, " has no version ", number,
                                          " that is kept; there are ", versions.versions(0).number(), " to ",
                                          newest.number()));
}

int ListServiceVersions(const ServiceArguments& arguments) {
  v1::ListVersionsReply reply;
  const grpc::Status status = Ask(arguments.client, arguments.name, false, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json) {
    for (const v1::DeployedVersion& version : reply.versions()) PrintJson(version);
    return kExitOk;
  }
  Table table({"number", "version", "revision", "registered", ""});
  table.KeepWhole({0, 2, 3, 4});
  for (const v1::DeployedVersion& version : reply.versions()) {
    table.Add({absl::StrCat(version.number()), version.version(), absl::StrCat(version.revision()),
               version.time_us() == 0 ? "" : TimeText(version.time_us()), version.live() ? "live" : ""});
  }
  std::cout << table.Render(Presenter(arguments.client).terminal());
  return kExitOk;
}

int DiffServiceVersions(const ServiceArguments& arguments) {
  const absl::StatusOr<v1::ListVersionsReply> versions = ServiceVersions(arguments.client, arguments.name);
  if (!versions.ok()) return Fail(versions.status());
  const std::vector<uint32_t>& numbers = arguments.versions;
  const uint32_t newest = versions->versions().rbegin()->number();
  uint32_t before = numbers.empty() ? newest - 1 : numbers[0];
  const uint32_t after = numbers.size() < 2 ? newest : numbers[1];
  if (numbers.empty() && versions->versions_size() == 1) {
    return Fail(absl::FailedPreconditionError(absl::StrCat(
        "document ", arguments.name, " has one version only; there is nothing to compare it with")));
  }
  const absl::StatusOr<v1::DeployedVersion> a = VersionOf(*versions, before, arguments.name);
  const absl::StatusOr<v1::DeployedVersion> b = VersionOf(*versions, after, arguments.name);
  for (const auto* version : {&a, &b}) {
    if (!version->ok()) return Fail(version->status());
  }
  const auto name = [&](const v1::DeployedVersion& version) {
    return absl::StrCat(arguments.name, " version ", version.number(), " (revision ", version.revision(),
                        ")");
  };
  const std::string diff = LineDiff(a->text(), b->text(), name(*a), name(*b));
  std::cout << diff;
  return diff.empty() ? kExitOk : kExitNegative;
}

int RemoveServices(const ServiceArguments& arguments) {
  v1::RemoveServicesRequest request;
  request.set_document(arguments.name);
  request.set_force(arguments.force);
  v1::RemoveServicesReply reply;
  grpc::ClientContext context;
  const grpc::Status status =
      v1::RobotServices::NewStub(Connect(arguments.client))->Remove(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json)
    PrintJson(reply);
  else
    std::cout << arguments.name << " removed, revision " << reply.revision() << "\n";
  return kExitOk;
}

}  // namespace docent::server
