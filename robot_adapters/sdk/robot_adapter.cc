#include "robot_adapters/sdk/robot_adapter.h"

#include <grpcpp/grpcpp.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/steady_clock.h"
#include "graph/rdf/vocabulary.h"
#include "robot_adapters/sdk/activity.h"
#include "robot_adapters/sdk/adapter_service.h"
#include "robot_adapters/sdk/command_journal.h"
#include "robot_adapters/sdk/command_table.h"
#include "robot_adapters/sdk/fleet_member.h"

namespace docent::robot {
namespace {

// The server may probe a quiet feedback stream this often (robot_adapters/proxy does every 20 s).
constexpr int kShortestPingMs = 5000;
// A server that does not answer keeps the adapter's end waiting this long: about as long as a lease, at whose end the server
// takes the robot for lost by itself.
constexpr absl::Duration kLeaveTimeout = absl::Seconds(3);

void Add(const std::vector<Part>& parts, google::protobuf::RepeatedPtrField<v1::Part>* out) {
  for (const Part& part : parts) {
    v1::Part* added = out->Add();
    added->set_name(part.name);
    added->set_type(part.type);
  }
}

// The names of typed parts count as inputs and outputs.
void TakeNames(const std::vector<Part>& parts, std::vector<std::string>* names) {
  if (parts.empty()) return;
  names->clear();
  for (const Part& part : parts) names->push_back(part.name);
}

v1::RobotDescription Describe(const AdapterOptions& options, const std::vector<Operation>& operations,
                              const std::string& incarnation) {
  v1::RobotDescription description;
  description.set_robot(options.robot);
  description.set_label(options.label);
  description.set_incarnation(incarnation);
  description.set_type(options.type);
  for (const Operation& operation : operations) {
    v1::OperationDescription* out = description.add_operations();
    out->set_name(operation.name);
    for (const std::string& part : operation.inputs) out->add_inputs(part);
    for (const std::string& part : operation.outputs) out->add_outputs(part);
    out->set_idempotent(operation.idempotent);
    for (const std::string& resource : operation.occupies) out->add_occupies(resource);
    out->set_description(operation.description);
    for (const std::string& capability : operation.capabilities) out->add_capabilities(capability);
    Add(operation.input_parts, out->mutable_input_parts());
    Add(operation.output_parts, out->mutable_output_parts());
  }
  return description;
}

}  // namespace

class RobotAdapter::Impl {
 public:
  explicit Impl(AdapterOptions options)
      : options(std::move(options)),
        clock(this->options.clock != nullptr ? this->options.clock : &steady_clock),
        link(this->options.server) {}

  ~Impl() { Shutdown(); }

  void Shutdown() {
    const bool there = member != nullptr && member->joined();
    if (there) Leave();
    if (commands != nullptr) commands->Stop();
    if (server != nullptr)
      server->Shutdown(std::chrono::system_clock::now() + std::chrono::milliseconds(500));
    server.reset();
    service.reset();
    commands.reset();  // waits for the operations, whose last facts are told meanwhile
    if (facts != nullptr) facts->Flush(there ? options.linger : absl::ZeroDuration());
    link.Shutdown();
    if (member != nullptr) member->Stop();
    if (facts != nullptr) facts->Stop(absl::ZeroDuration());
  }

  // Before commands end: a step that fails with the adapter is not sent to it once more. The robot's own states are told before it
  // and not afterwards, or the robot would seem to be there.
  void Leave() {
    const absl::Time end = absl::Now() + kLeaveTimeout;
    facts->EndStatesOf(options.robot);
    if (facts->Flush(kLeaveTimeout)) member->Leave(end - absl::Now());
  }

  absl::Status Start(std::vector<Operation> operations);
  absl::Status Listen();
  void OnJoined();

  const AdapterOptions options;
  const SteadyClock steady_clock;
  const Clock* const clock;
  ServerLink link;
  std::string address;
  std::unique_ptr<CommandJournal> journal;
  std::unique_ptr<FactSender> facts;
  std::unique_ptr<Activity> activity;
  std::unique_ptr<CommandTable> commands;
  std::unique_ptr<AdapterService> service;
  std::unique_ptr<grpc::Server> server;
  std::unique_ptr<FleetMember> member;
  bool leftovers_withdrawn = false;  // the member's thread only
};

absl::Status RobotAdapter::Impl::Start(std::vector<Operation> operations) {
  if (options.robot.find(':') == std::string::npos) {
    return absl::InvalidArgumentError(absl::StrCat("\"", options.robot, "\" is not the IRI of a robot"));
  }
  auto opened = CommandJournal::Open(options.journal_path, clock);
  if (!opened.ok()) return opened.status();
  journal = *std::move(opened);

  FactSenderOptions sender;
  sender.source = options.robot;
  sender.request_id_prefix = absl::StrCat(options.robot, "/", journal->incarnation());
  sender.queue_limit = options.facts_queued;
  facts = std::make_unique<FactSender>(sender, [this, timeout = sender.call_timeout](
                                                   const v1::AssertRequest& request, v1::AssertReply* reply) {
    return link.Assert(request, reply, timeout);
  });
  activity = std::make_unique<Activity>(options.robot, facts.get());
  for (Operation& operation : operations) {
    TakeNames(operation.input_parts, &operation.inputs);
    TakeNames(operation.output_parts, &operation.outputs);
  }
  auto table = CommandTable::Create(std::move(operations), journal.get(), clock, options.commands_running,
                                    activity.get());
  if (!table.ok()) return table.status();
  commands = *std::move(table);
  service = std::make_unique<AdapterService>(
      Describe(options, commands->operations(), journal->incarnation()), commands.get());
  if (absl::Status status = Listen(); !status.ok()) return status;

  v1::JoinRequest join;
  join.set_address(address);
  *join.mutable_description() = Describe(options, commands->operations(), journal->incarnation());
  member = std::make_unique<FleetMember>(&link, std::move(join), [this] { OnJoined(); });
  return absl::OkStatus();
}

// The server is there (again): it hears what holds, and loses what an earlier life of this adapter left
// behind.
void RobotAdapter::Impl::OnJoined() {
  facts->ResendStates();
  if (std::exchange(leftovers_withdrawn, true)) return;
  std::vector<std::string> predicates = options.transient_states;
  predicates.push_back(DocentIri("currentCommand"));
  predicates.push_back(DocentIri("progress"));
  std::string values;
  for (const std::string& predicate : predicates) absl::StrAppend(&values, " <", predicate, ">");
  auto left = link.Query(absl::StrCat("SELECT ?p ?o WHERE { VALUES ?p {", values, " } GRAPH <", options.robot,
                                      "> { <", options.robot, "> ?p ?o } }"),
                         absl::Seconds(5));
  if (!left.ok()) {
    spdlog::warn("cannot ask what an earlier life left behind: {}", std::string(left.status().message()));
    return;
  }
  for (const auto& row : left->rows) {
    if (row.size() == 2 && row[0] && row[1]) facts->WithdrawLeftover(options.robot, row[0]->lexical, *row[1]);
  }
}

absl::Status RobotAdapter::Impl::Listen() {
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(options.listen, grpc::InsecureServerCredentials(), &port);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kShortestPingMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.RegisterService(service.get());
  server = builder.BuildAndStart();
  if (server == nullptr || port == 0) {
    return absl::UnavailableError(
        absl::StrCat("cannot listen at ", options.listen, "; is the port in use? Port 0 takes any free one"));
  }
  address = absl::StrCat(options.listen.substr(0, options.listen.rfind(':')), ":", port);
  return absl::OkStatus();
}

RobotAdapter::RobotAdapter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RobotAdapter::~RobotAdapter() = default;

absl::StatusOr<std::unique_ptr<RobotAdapter>> RobotAdapter::Start(AdapterOptions options,
                                                                  std::vector<Operation> operations) {
  auto impl = std::make_unique<Impl>(std::move(options));
  if (absl::Status status = impl->Start(std::move(operations)); !status.ok()) return status;
  return std::unique_ptr<RobotAdapter>(new RobotAdapter(std::move(impl)));
}

void RobotAdapter::Shutdown() {
  impl_->Shutdown();
}
void RobotAdapter::SetState(const std::string& predicate, Term value) {
  impl_->facts->Set(impl_->options.robot, predicate, std::move(value));
}
void RobotAdapter::ClearState(const std::string& predicate) {
  impl_->facts->Clear(impl_->options.robot, predicate);
}
FactSender& RobotAdapter::facts() {
  return *impl_->facts;
}
ServerLink& RobotAdapter::server() {
  return impl_->link;
}
const std::string& RobotAdapter::address() const {
  return impl_->address;
}
const std::string& RobotAdapter::incarnation() const {
  return impl_->journal->incarnation();
}
bool RobotAdapter::joined() const {
  return impl_->member->joined();
}

}  // namespace docent::robot
