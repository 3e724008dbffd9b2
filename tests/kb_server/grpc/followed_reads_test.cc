// Reads that are followed, on random turns: where FollowedReads says that an answer cannot have changed, a fresh read gives
// the same one.
#include <google/protobuf/util/message_differencer.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>

#include "absl/strings/str_cat.h"
#include "graph/rdf/formats/parser.h"
#include "kb_server/door/followed_reads.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/random_world.h"

namespace docent::server {
namespace {

constexpr char kShapes[] = R"(
@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix docent: <https://w3id.org/docent#> . @prefix : <urn:w:> .
:Feels a sh:NodeShape ; sh:targetSubjectsOf docent:feels ; sh:property [ sh:path docent:feels ; sh:maxCount 1 ] .
)";

const std::vector<std::string>& Asks() {
  static const std::vector<std::string> kAsks = {
      "ASK { :P0 docent:feels docent:Glad }",
      "ASK { :P1 docent:isNear :R1 }",
      "ASK { ?p docent:isAt :Hall ; docent:says \"word 1\" }",
      "ASK { :P2 docent:unheardOf :Nothing }",
      "ASK { :P3 docent:calls ?r . ?r docent:status docent:Offline FILTER NOT EXISTS { ?r docent:isAt :Yard "
      "} }",
      "ASK { GRAPH ?g { :P4 docent:isAt :Hall } }",
      "ASK { GRAPH :Camera { ?p docent:isAt :Hall } }",
      "ASK { ?p docent:feels ?x FILTER(NOW() > \"2023-11-14T22:14:20Z\"^^xsd:dateTime) }",
      "ASK { { SELECT (COUNT(?p) AS ?n) { ?p docent:isAt :Yard } } FILTER(?n > 2) }",
      "ASK { :P5 ?word docent:Sad }"};
  return kAsks;
}

class FollowedReadsTest : public ::testing::TestWithParam<uint32_t> {
 protected:
  struct Followed {
    std::function<grpc::Status(grpc::ClientContext*, std::string*)> read;
    std::shared_ptr<ReadTrace> trace;
    uint64_t asked = 0;
    std::string answer;
  };

  FollowedReadsTest() {
    ports_.queries = &queries_;
    ports_.dictionary = &dictionary_;
    ports_.functions = &functions_;
    ports_.workers = &workers_;
    ports_.followed = &followed_;
    ports_.clock = &clock_;
    ports_.catalog = &catalog_;
    grpc::ServerBuilder builder;
    builder.RegisterService(&fleet_service_);
    builder.RegisterService(&context_service_);
    builder.RegisterService(&workflows_service_);
    server_ = builder.BuildAndStart();
    const std::shared_ptr<grpc::Channel> channel = server_->InProcessChannel({});
    fleet_ = v1::Fleet::NewStub(channel);
    context_ = v1::Context::NewStub(channel);
    workflows_ = v1::Workflows::NewStub(channel);
    followed_.Keep(true);
  }
  ~FollowedReadsTest() override { server_->Shutdown(); }

  // Without the revision that answers.
  template <typename Stub, typename Request, typename Reply>
  void Follow(const std::string& name, const std::unique_ptr<Stub>& stub,
              grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Reply*),
              const Request& request) {
    reads_[name].read = [&stub, method, request](grpc::ClientContext* context, std::string* answer) {
      Reply reply;
      const grpc::Status status = ((*stub).*method)(context, request, &reply);
      if constexpr (std::is_same_v<Reply, v1::ExplainReply>) reply.clear_revision();
      *answer = absl::StrCat(status.error_code(), status.error_message(), "\n", reply.DebugString());
      return status;
    };
  }
  void FollowAll() {
    for (const std::string& ask : Asks()) {
      v1::ExplainRequest request;
      request.set_why_not(absl::StrCat("PREFIX : <urn:w:> ", ask));
      Follow(ask, context_, &v1::Context::Stub::Explain, request);
    }
    v1::ListRunsRequest runs;
    Follow("runs", workflows_, &v1::Workflows::Stub::ListRuns, runs);
    runs.set_live_only(true);
    runs.set_workflow("Greeting");
    Follow("live runs", workflows_, &v1::Workflows::Stub::ListRuns, runs);
    Follow("robots", fleet_, &v1::Fleet::Stub::List, v1::ListRobotsRequest());
  }
  void FollowRun(const std::string& id) {
    v1::GetRunRequest get;
    get.set_run(id);
    Follow(absl::StrCat("run ", id), workflows_, &v1::Workflows::Stub::Get, get);
    v1::ExplainRunRequest waits;
    waits.set_run(id);
    Follow(absl::StrCat("waits ", id), workflows_, &v1::Workflows::Stub::Explain, waits);
  }

  // False: it is refused.
  bool Turn(WriteBatch batch) {
    clock_.Set(batch.time_us);
    auto result = RunTurn(&stages_, std::move(batch), head_ + 1);
    if (!result.ok()) return false;
    ++head_;
    const GraphVersionPtr version = stages_.writer.Freeze(Revision(head_));
    if (result->documents_changed) catalog_.Publish(stages_.documents.MakeCatalog(stages_.engine));
    followed_.Add(*version, {&result->delta}, result->documents_changed);
    queries_.Publish(version);
    for (const RunId& run : result->started) {
      if (++runs_ <= 6) FollowRun(run.value());
    }
    return true;
  }

  void LookAtAll() {
    for (auto& [name, one] : reads_) {
      FollowedReads::Begun begun = followed_.Begin();
      grpc::ClientContext context;
      context.AddMetadata(kTraceKey, begun.name);
      std::string fresh;
      one.read(&context, &fresh);
      const bool may_change = one.trace == nullptr || followed_.MayHaveChanged(*one.trace, one.asked, head_);
      if (!may_change) {
        ++spared_[name];
        EXPECT_EQ(fresh, one.answer) << name << ", read at " << one.asked << ", now " << head_;
      } else {
        one.trace = begun.trace;
        one.answer = fresh;
      }
      one.asked = head_;
    }
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  Stages stages_{&dictionary_, &functions_, Limits()};
  ManualClock clock_{0};
  QueryPort queries_;
  CatalogPort catalog_;
  FollowedReads followed_{&dictionary_};
  WorkerPool workers_{WorkerPoolLimits{/*running=*/2, /*open=*/4, /*queue=*/16}};
  ServicePorts ports_;
  FleetLeases leases_{&clock_};
  FleetService fleet_service_{ports_, &leases_};
  ContextService context_service_{ports_};
  WorkflowsService workflows_service_{ports_};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::Fleet::Stub> fleet_;
  std::unique_ptr<v1::Context::Stub> context_;
  std::unique_ptr<v1::Workflows::Stub> workflows_;
  std::map<std::string, Followed> reads_;
  std::map<std::string, int> spared_;
  uint64_t head_ = 0;
  int runs_ = 0;
};

TEST_P(FollowedReadsTest, WhereNothingIsSaidToChangeAFreshReadIsTheSame) {
  test::RandomWorld world(GetParam());
  FollowAll();
  std::vector<TermQuad> shapes = ParseRdf(kShapes, RdfFormat::kTurtle).quads;
  for (TermQuad& quad : shapes) quad.graph = Term::Iri(OntologyGraph("shapes"));
  for (int i = 0; i < 120; ++i) {
    WriteBatch batch = world.Next(stages_);
    const TimeMicros now_us = batch.time_us;
    if (Turn(std::move(batch))) LookAtAll();
    WriteBatch more;
    if (i == 30) more = test::Tell(shapes);
    if (i == 100) more = test::Tell({}, {shapes[0]});
    if (i % 2 == 0)  // nobody asks for it
      more = test::Tell({test::Fact("Sun", "docent:height", Term::Integer(i))},
                        {test::Fact("Sun", "docent:height", Term::Integer(i - 2))});
    more.time_us = now_us;
    if (more.OperationCount() > 0 && Turn(std::move(more))) LookAtAll();
    if (HasFailure()) return;
  }
  for (const auto& [name, one] : reads_) {
    if (name.find("NOW()") != std::string::npos) {
      EXPECT_EQ(spared_[name], 0) << name;
    } else if (name.find("COUNT") == std::string::npos) {  // which is not looked through to its end
      EXPECT_GT(spared_[name], 20) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, FollowedReadsTest, ::testing::Range(1u, 4u));

}  // namespace
}  // namespace docent::server
