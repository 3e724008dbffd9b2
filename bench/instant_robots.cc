#include "bench/instant_robots.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/vocabulary.h"

namespace docent::bench {
namespace {

constexpr size_t kQuadsOfALoad = 20000;

// The single feedback of a command that is done at once.
class DoneAtOnce final : public grpc::ServerWriteReactor<v1::Feedback> {
 public:
  explicit DoneAtOnce(const std::string& command) {
    feedback_.set_command_id(command);
    feedback_.set_state(v1::Feedback::SUCCEEDED);
    feedback_.set_progress(1);
    feedback_.set_incarnation("bench");
    StartWriteAndFinish(&feedback_, grpc::WriteOptions(), grpc::Status::OK);
  }
  void OnDone() override { delete this; }

 private:
  v1::Feedback feedback_;
};

}  // namespace

InstantAdapter::InstantAdapter(std::function<void(const v1::InvokeRequest&)> invoked)
    : invoked_(std::move(invoked)) {
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
  address_ = absl::StrCat("127.0.0.1:", port);
}

InstantAdapter::~InstantAdapter() {
  server_->Shutdown(std::chrono::system_clock::now());
}

grpc::ServerWriteReactor<v1::Feedback>* InstantAdapter::Invoke(grpc::CallbackServerContext*,
                                                               const v1::InvokeRequest* request) {
  invoked_(*request);
  return new DoneAtOnce(request->command_id());
}

std::vector<TermQuad> InstantRobots(int count, const std::string& adapter,
                                    const std::vector<std::pair<std::string, std::string>>& operations) {
  std::vector<TermQuad> quads;
  for (int r = 0; r < count; ++r) {
    const Term robot = Term::Iri(absl::StrCat("urn:mix:robot", r));
    const auto say = [&](std::string_view local, Term object) {
      quads.push_back({robot, Term::Iri(DocentIri(local)), std::move(object), Term()});
    };
    quads.push_back({robot, Term::Iri(std::string(kRdfType)), Term::Iri(DocentIri("Robot")), Term()});
    for (const auto& [name, input] : operations) {
      const Term operation = Term::Iri(absl::StrCat("urn:docent:operation:", name));
      say("offers", operation);
      quads.push_back({operation, Term::Iri(DocentIri("input")), Term::Literal(input), robot});
      quads.push_back({operation, Term::Iri(DocentIri("inputsKnown")), Term::Boolean(true), robot});
    }
    say("incarnation", Term::Literal("bench"));
    say("adapterAddress", Term::Literal(adapter));
  }
  return quads;
}

grpc::Status LoadQuads(const std::shared_ptr<grpc::Channel>& channel, const std::vector<TermQuad>& quads) {
  auto ontologies = v1::Ontologies::NewStub(channel);
  for (size_t from = 0; from < quads.size(); from += kQuadsOfALoad) {
    std::vector<TermQuad> part(quads.begin() + from,
                               quads.begin() + std::min(quads.size(), from + kQuadsOfALoad));
    v1::LoadRequest request;
    request.set_kind(v1::LoadRequest::DATA);
    request.set_media_type("application/n-quads");
    request.set_text(*SerializeRdf(part, RdfFormat::kNQuads));
    v1::LoadReply reply;
    grpc::ClientContext context;
    if (grpc::Status status = ontologies->Load(&context, request, &reply); !status.ok()) return status;
  }
  return grpc::Status::OK;
}

grpc::Status Deploy(const std::shared_ptr<grpc::Channel>& channel, const std::string& name,
                    const std::string& cawl) {
  v1::DeployRequest request;
  request.set_name(name);
  request.set_cawl(cawl);
  v1::DeployReply reply;
  grpc::ClientContext context;
  return v1::Workflows::NewStub(channel)->Deploy(&context, request, &reply);
}

}  // namespace docent::bench
