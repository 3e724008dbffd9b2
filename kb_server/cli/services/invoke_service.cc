// docent services invoke: runs a robot service and follows it.
#include <iostream>

#include "docent/v1/robot_services.grpc.pb.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/services/service_commands.h"
#include "kb_server/cli/variable_argument.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

constexpr size_t kResultColumns = 200;  // of a result's value

}  // namespace

int InvokeService(const ServiceArguments& arguments) {
  v1::InvokeServiceRequest request;
  request.set_name(arguments.name);
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  request.set_robot(facts.Iri(arguments.robot));
  for (const std::string& text : arguments.arguments) {
    auto variable =
        ParseVariable(text, [&facts](std::string_view prefix) { return facts.Namespace(prefix); });
    if (!variable.ok()) return Fail(variable.status());
    v1::NamedTerm* named = request.add_arguments();
    named->set_name(variable->first);
    ToProto(variable->second, named->mutable_value());
  }
  grpc::ClientContext context;
  auto reader = v1::RobotServices::NewStub(Connect(arguments.client))->Invoke(&context, request);
  v1::InvokeServiceReply reply;
  const Presenter presenter(arguments.client);
  std::string state;
  while (reader->Read(&reply)) {
    if (reply.final()) state = reply.state();
    if (arguments.client.json) {
      PrintJson(reply);
      continue;
    }
    std::cout << reply.run() << "  " << reply.step() << "  " << reply.state();
    if (reply.message().empty() && !reply.final())
      std::cout << "  " << static_cast<int>(reply.progress() * 100) << " %";
    if (!reply.message().empty()) std::cout << "  " << presenter.Line(reply.message());
    std::cout << "\n";
    for (const v1::NamedTerm& result : reply.results()) {
      if (const std::optional<Term> value = FromProto(result.value()))
        std::cout << "  " << result.name() << " = " << presenter.Text(ToDisplay(*value), kResultColumns)
                  << "\n";
    }
  }
  grpc::Status status = reader->Finish();
  if (!status.ok()) return Fail(status, arguments.client);
  return state == "done" ? kExitOk : kExitNegative;
}

}  // namespace docent::server
