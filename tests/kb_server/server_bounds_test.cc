// Each call that may set rules, shapes, proofs or runs to work ends at its limits: of time, of steps, with its client, and
// with the server.
#include <gmock/gmock.h>

#include <functional>
#include <future>
#include <map>

#include "absl/time/clock.h"
#include "docent/v1/replays.grpc.pb.h"
#include "tests/kb_server/http/read_metric.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

// Joins three patterns that share no variable, without a result: hours with 3000 facts, and only once a fact of :go is there.
constexpr char kCross[] =
    "PREFIX : <urn:w:> RULE :cross { ?x :r ?d } WHERE { ?x :go ?y . ?a :p ?b . ?c :p ?d . ?e :p ?f "
    "FILTER(?b + ?d + ?f = -1) }";
constexpr char kCrossAtOnce[] =
    "PREFIX : <urn:w:> RULE :at_once { ?a :r ?d } WHERE { ?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f "
    "= -1) }";
constexpr char kCrossShape[] =
    "@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix owl: <http://www.w3.org/2002/07/owl#> . <urn:m> a "
    "owl:Ontology . <urn:s> sh:targetNode <urn:w:k0> ; sh:sparql [ sh:select \"SELECT $this WHERE { ?a "
    "<urn:w:p> ?b . ?c <urn:w:p> ?d . ?e <urn:w:p> ?f FILTER(?b + ?d + ?f = -1) }\" ] .";
constexpr char kWaiting[] =
    "<CAWL name=\"Waits\" xmlns:w=\"urn:w:\"><flow name=\"Waits\"><source name=\"s\"/><node "
    "name=\"N\"><condition><context name=\"c\"><rule name=\"r\"><constraint name=\"k\"><subject>w:a</subject>"
    "<verb>w:is</verb><object>w:b</object></constraint></rule></context></condition></node><sink name=\"t\"/>"
    "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"t\"/></flow></CAWL>";

class ServerBoundsTest : public ServerTest {
 protected:
  using Entry = std::function<grpc::Status(grpc::ClientContext*)>;

  void Begin() {
    StartServer();
    replays_ = v1::Replays::NewStub(channel_);
    ASSERT_TRUE(Load(v1::LoadRequest::RULES, "cross.rules", kCross).ok());
    std::string facts;
    for (int i = 0; i < 3000; ++i) absl::StrAppend(&facts, ":k", i, " :p ", i, " . ");
    MustTell(facts);
  }
  static void Go(v1::Quad* quad) {
    quad->mutable_subject()->set_iri("urn:w:x");
    quad->mutable_predicate()->set_iri("urn:w:go");
    quad->mutable_object()->set_iri("urn:w:y");
  }

  // Calls that would go on for hours.
  std::map<std::string, Entry> Entries() {
    std::map<std::string, Entry> entries;
    entries["why"] = [this](grpc::ClientContext* context) {
      v1::ExplainRequest request;
      request.set_why_ask(
          "PREFIX : <urn:w:> ASK { ?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = -1) }");
      v1::ExplainReply reply;
      return context_->Explain(context, request, &reply);
    };
    entries["why not"] = [this](grpc::ClientContext* context) {
      v1::ExplainRequest request;
      request.set_why_not("PREFIX : <urn:w:> ASK { :x :go :y . ?z :never :y }");
      v1::ExplainReply reply;
      return context_->Explain(context, request, &reply);
    };
    entries["what if"] = [this](grpc::ClientContext* context) {
      v1::WhatIfRequest request;
      Go(request.add_add());
      v1::WhatIfReply reply;
      return context_->WhatIf(context, request, &reply);
    };
    entries["validate"] = [this](grpc::ClientContext* context) {
      v1::ValidateRequest request;
      request.add_shapes()->set_name("s.ttl");
      request.mutable_shapes(0)->set_text(kCrossShape);
      v1::ValidateReply reply;
      return ontologies_->Validate(context, request, &reply);
    };
    entries["check of a module"] = [this](grpc::ClientContext* context) {
      v1::LoadRequest request;
      request.set_name("m.ttl");
      request.set_text(kCrossShape);
      v1::CheckModuleReply reply;
      return ontologies_->Check(context, request, &reply);
    };
    entries["preview of rules"] = [this](grpc::ClientContext* context) {
      v1::PreviewRulesRequest request;
      request.set_name("at_once.rules");
      request.set_text(kCrossAtOnce);
      v1::PreviewRulesReply reply;
      return ontologies_->PreviewRules(context, request, &reply);
    };
    entries["simulation"] = [this](grpc::ClientContext* context) {
      v1::SimulateRequest request;
      request.set_name("waits.xml");
      request.set_cawl(kWaiting);
      v1::SimulatedTelling* telling = request.add_told();
      telling->set_after_s(1);
      Go(telling->add_add());
      v1::SimulateReply reply;
      return replays_->Simulate(context, request, &reply);
    };
    return entries;
  }
  // Rules that are put are decided in a turn, which no client ends.
  std::map<std::string, Entry> TurnEntries() {
    return {{"load of rules",
             [this](grpc::ClientContext* context) {
               v1::LoadRequest request;
               request.set_kind(v1::LoadRequest::RULES);
               request.set_name("at_once.rules");
               request.set_text(kCrossAtOnce);
               v1::LoadReply reply;
               return ontologies_->Load(context, request, &reply);
             }},
            {"facts", [this](grpc::ClientContext* context) {
               v1::AssertReply reply;
               return context_->Assert(context, Turtle(":x :go :y ."), &reply);
             }}};
  }
  grpc::Status Run(const Entry& entry) {
    grpc::ClientContext context;
    Limit(&context);
    return entry(&context);
  }

  std::unique_ptr<v1::Replays::Stub> replays_;
};

TEST_F(ServerBoundsTest, EachCallEndsAtItsTime) {
  settings_.limits.steps_per_turn = uint64_t{1} << 60;
  settings_.limits.query_timeout_ms = 2000;
  Begin();
  std::map<std::string, Entry> entries = Entries();
  entries.erase("simulation");  // its time cannot be set
  for (const auto& [name, entry] : entries) {
    const grpc::Status status = Run(entry);
    if (name == "why not" && status.ok()) continue;  // it had no time to try a set
    EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED)
        << name << ": " << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("timeout_ms = 2000")) << name;
  }
  MustTell(":a :p 1 .");
}

TEST_F(ServerBoundsTest, TheCheckOfADocumentEndsAtItsTime) {
  settings_.limits.query_timeout_ms = 1;
  StartServer();
  std::string text = "<CAWL name=\"W\"><flow name=\"F\"><source name=\"s\"/>", links;
  for (int i = 0; i < 3900; ++i) {
    absl::StrAppend(&text, "<node name=\"n", i, "\"/>");
    absl::StrAppend(&links, "<link from=\"s\" to=\"n", i, "\"/><link from=\"n", i, "\" to=\"t\"/>");
  }
  absl::StrAppend(&text, "<sink name=\"t\"/>", links, "</flow></CAWL>");
  grpc::ClientContext checked, deployed;
  v1::CheckRequest check;
  v1::CheckReply report;
  check.set_cawl(text);
  v1::DeployRequest deploy;
  v1::DeployReply reply;
  deploy.set_name("W");
  deploy.set_cawl(text);
  for (const grpc::Status& status :
       {workflows_->Check(&checked, check, &report), workflows_->Deploy(&deployed, deploy, &reply)}) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("query_timeout_ms = 1"));
  }
}

TEST_F(ServerBoundsTest, WhatAppliesRulesEndsAtTheStepsOfATurn) {
  settings_.limits.steps_per_turn = 1000000;
  Begin();
  std::map<std::string, Entry> entries = Entries();
  for (const char* other : {"why", "validate", "check of a module"})
    entries.erase(other);  // queries: time, memory
  for (auto& entry : TurnEntries()) entries.insert(entry);
  for (const auto& [name, entry] : entries) {
    const grpc::Status status = Run(entry);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED)
        << name << ": " << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("steps_per_turn")) << name;
  }
  MustTell(":a :p 1 .");
}

TEST_F(ServerBoundsTest, EachCallEndsWithItsClientAndWithTheServer) {
  settings_.limits.steps_per_turn = uint64_t{1} << 60;
  Begin();
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::future<grpc::Status>> calls;
  for (const auto& [name, entry] : Entries()) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    Limit(contexts.back().get());
    calls.push_back(
        std::async(std::launch::async, [entry, context = contexts.back().get()] { return entry(context); }));
  }
  // All are at work; the simulation, which has workers of its own, may wait or be at work.
  const double beside_simulation = static_cast<double>(calls.size() - 1);
  while (ReadMetric(http_port(), "docent_work_begun") < beside_simulation)
    absl::SleepFor(absl::Milliseconds(10));
  for (size_t i = 0; i < contexts.size(); i += 2) contexts[i]->TryCancel();
  StopServer();  // waits for all work
  for (std::future<grpc::Status>& call : calls) EXPECT_FALSE(call.get().ok());
}

// Each entry that takes a text counts what that says; and all of it is given back.
TEST_F(ServerBoundsTest, WhatATextSaysIsMemoryOfItsRequest) {
  settings_.limits.query_memory_bytes = 1 << 20;
  StartServer();
  std::string text = "@prefix : <urn:w:> . :a :b 0";
  for (int i = 1; i < 30000; ++i) absl::StrAppend(&text, ",", i);
  text += " .";
  const auto expect_refused = [](const grpc::Status& status, const char* entry) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << entry;
    EXPECT_THAT(status.error_message(), HasSubstr("query_memory_bytes = 1048576")) << entry;
  };
  v1::AssertRequest told;
  told.set_rdf(text);
  expect_refused(Assert(told), "rdf of Assert");
  v1::AssertRequest added;
  for (int i = 0; i < 20000; ++i) Go(added.add_add());
  expect_refused(Assert(added), "facts of Assert");
  expect_refused(Load(v1::LoadRequest::DATA, "", text), "data");
  expect_refused(Load(v1::LoadRequest::ONTOLOGY, "m.ttl", text), "module");
  v1::LoadRequest check;
  check.set_kind(v1::LoadRequest::ONTOLOGY);
  check.set_name("m.ttl");
  check.set_text(text);
  v1::CheckModuleReply checked;
  expect_refused(Call(ontologies_, &v1::Ontologies::Stub::Check, check, &checked), "check of a module");
  v1::ValidateRequest validate;
  validate.add_shapes()->set_text(text);
  v1::ValidateReply validated;
  expect_refused(Call(ontologies_, &v1::Ontologies::Stub::Validate, validate, &validated), "shapes");
  std::string question = "ASK { ?s ?p ?o VALUES ?o {";
  for (int i = 0; i < 30000; ++i) absl::StrAppend(&question, " ", i);
  question += " } }";
  expect_refused(Query(question).status, "query");
  for (const bool why : {true, false}) {
    v1::ExplainRequest explain;
    why ? explain.set_why_ask(question) : explain.set_why_not(question);
    v1::ExplainReply explained;
    expect_refused(Call(context_, &v1::Context::Stub::Explain, explain, &explained), "explain");
  }
  EXPECT_EQ(ReadMetric(http_port(), "docent_query_memory_bytes"), 0);
}

}  // namespace
}  // namespace docent::server::test
