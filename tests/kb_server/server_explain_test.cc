// Explain and WhatIf over gRPC: with the log behind them, the stages beside the writer.
#include <fstream>

#include "gmock/gmock.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class ServerExplainTest : public ServerWorkflowTest {
 protected:
  static v1::Quad Quad(const std::string& s, const std::string& p, const std::string& o) {
    v1::Quad quad;
    quad.mutable_subject()->set_iri(Name(s));
    quad.mutable_predicate()->set_iri(Name(p));
    quad.mutable_object()->set_iri(Name(o));
    return quad;
  }
  v1::ExplainReply Explain(const v1::ExplainRequest& request, grpc::Status* status = nullptr) {
    v1::ExplainReply reply;
    const grpc::Status got = Call(context_, &v1::Context::Stub::Explain, request, &reply);
    if (status != nullptr) {
      *status = got;
    } else {
      EXPECT_TRUE(got.ok()) << got.error_message();
    }
    return reply;
  }
  v1::ExplainReply WhyNot(const std::string& ask, grpc::Status* status = nullptr) {
    v1::ExplainRequest request;
    request.set_why_not("PREFIX : <urn:w:> " + ask);
    return Explain(request, status);
  }
};

TEST_F(ServerExplainTest, AProofEndsAtWhoToldItWhenAndWhereInTheLog) {
  clock_.Set(1700000000000000);
  settings_.clock = &clock_;
  StartServer();
  SetUpGreeting();
  MustTell(
      ":R1 a docent:Robot ; docent:isAt :Hall . :DoorMapping docent:forSensor :Door ; docent:subject "
      "docent:readingValue ;"
      " docent:predicate docent:isAt ; docent:object :Hall .");
  v1::AssertRequest reading;
  reading.set_source("urn:w:tracking");
  reading.add_readings()->set_sensor("urn:w:Door");
  reading.mutable_readings(0)->mutable_value()->set_iri("urn:w:John");
  v1::AssertReply told;
  grpc::Status status = Assert(reading, &told);
  ASSERT_TRUE(status.ok()) << status.error_message();
  MustTell(":x :y :z .");

  v1::ExplainRequest request;
  *request.mutable_why_fact() = Quad("John", "docent:isNear", "R1");
  (*request.mutable_prefixes())["w"] = "urn:w:";
  const v1::ExplainReply reply = Explain(request);
  EXPECT_TRUE(reply.holds());
  ASSERT_EQ(reply.proof().roots_size(), 1);
  const v1::ProofStep& root = reply.proof().steps(static_cast<int>(reply.proof().roots(0)));
  EXPECT_EQ(root.depth(), 1u);
  EXPECT_EQ(root.rule(), "near.rules rule 1 (line 2)");
  ASSERT_EQ(root.premises_size(), 3);
  const v1::ProofStep& at = reply.proof().steps(static_cast<int>(root.premises(0)));
  ASSERT_EQ(at.told_size(), 1);
  EXPECT_EQ(at.told(0).graph(), "urn:w:tracking");
  EXPECT_EQ(at.told(0).offset(), told.offset());
  EXPECT_EQ(at.told(0).time_us(), 1700000000000000);
  EXPECT_EQ(at.told(0).by(), "reading of <urn:w:Door>");
  EXPECT_THAT(reply.text(), HasSubstr("w:John docent:isNear w:R1\n  by near.rules rule 1 (line 2)"));
  EXPECT_THAT(reply.text(), HasSubstr(absl::StrCat("2023-11-14 22:13:20 UTC, log offset ", told.offset())));
  EXPECT_THAT(reply.prov(), HasSubstr("prov:wasDerivedFrom"));
  EXPECT_THAT(reply.prov(), HasSubstr("2023-11-14T22:13:20Z"));
}

TEST_F(ServerExplainTest, WhyNotNamesWhatTellingMakesTrue) {
  StartServer();
  SetUpGreeting();
  MustTell(":R1 a docent:Robot ; docent:isAt :Hall . :John docent:isAt :Cafe .");
  const std::string ask = "ASK { :John docent:isNear :R1 }";
  v1::ExplainReply reply = WhyNot(ask);
  EXPECT_FALSE(reply.holds());
  EXPECT_TRUE(reply.whole());
  ASSERT_GT(reply.sets_size(), 0);
  ASSERT_EQ(reply.sets(0).add_size(), 1);
  EXPECT_THAT(reply.text(), HasSubstr("1 fact is missing"));
  EXPECT_FALSE(Ask(":John docent:isNear :R1"));  // nothing was written by asking
  v1::AssertRequest request;
  *request.mutable_add() = reply.sets(0).add();
  ASSERT_TRUE(Assert(request).ok());
  EXPECT_TRUE(Ask(":John docent:isNear :R1"));
  reply = WhyNot(ask);
  EXPECT_TRUE(reply.holds());
  EXPECT_EQ(reply.sets_size(), 0);
}

TEST_F(ServerExplainTest, WhyNotOffersNothingThatAShapeForbids) {
  StartServer();
  v1::LoadRequest shapes;
  shapes.set_name("delivery.ttl");
  shapes.set_text(
      "@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix : <urn:w:> .\n"
      ":DeliveryShape a sh:NodeShape ; sh:targetClass :Delivery ;\n"
      "  sh:property [ sh:path :forPatient ; sh:maxCount 1 ] .");
  shapes.set_mode(v1::LoadRequest::ADD);
  v1::LoadReply loaded;
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::Load, shapes, &loaded).ok());
  MustTell(":D1 a :Delivery ; :forPatient :Ann ; :at :Ward . :D2 a :Delivery ; :forPatient :Bob .");
  const v1::ExplainReply reply = WhyNot("ASK { ?d :forPatient :Bob ; :at :Ward }");
  ASSERT_EQ(reply.sets_size(), 1) << reply.text();
  EXPECT_EQ(reply.sets(0).add(0).subject().iri(), "urn:w:D2");
  EXPECT_THAT(WhyNot("ASK { :D1 :forPatient :Bob }").text(), HasSubstr("1 set is left out"));
}

TEST_F(ServerExplainTest, RefusesWhatItCannotExplain) {
  StartServer();
  grpc::Status status;
  Explain(v1::ExplainRequest(), &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  WhyNot("ASK { ", &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  WhyNot("ASK FROM :g { ?s ?p ?o }", &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNIMPLEMENTED);
  WhyNot("CONSTRUCT WHERE { ?s ?p ?o }", &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  v1::ExplainRequest request;
  *request.mutable_why_fact() = Quad("nobody", "docent:isNear", "nobody");
  const v1::ExplainReply reply = Explain(request);
  EXPECT_FALSE(reply.holds());
  EXPECT_THAT(reply.text(), HasSubstr("not there"));
}

TEST_F(ServerExplainTest, WhatIfTellsWhatWouldHappenAndNothingDoes) {
  StartServer();
  SetUpGreeting();
  MustTell(
      ":R1 a docent:Robot ; docent:isAt :Hall ; docent:status docent:Standby . :John docent:isAt :Cafe .");
  ASSERT_TRUE(Deploy("called.xml", kCalled).ok());
  v1::StartReply run;
  ASSERT_TRUE(StartRun("Greeting", &run).ok());
  const uint64_t before = Revision();

  v1::WhatIfRequest request;
  *request.add_add() = Quad("John", "docent:isAt", "Hall");
  *request.add_add() = Quad("Eve", "docent:calls", "R1");
  v1::WhatIfReply reply;
  grpc::Status status = Call(context_, &v1::Context::Stub::WhatIf, request, &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(reply.revision(), before);
  EXPECT_THAT(reply.text(), HasSubstr("+ <urn:w:John> docent:isNear <urn:w:R1>   (inferred)"));
  EXPECT_THAT(reply.text(), HasSubstr("- <urn:w:John> docent:isAt <urn:w:Cafe>"));  // a state has one value
  std::vector<std::string> places, moves;
  for (const v1::ConditionFlip& flip : reply.flips()) places.push_back(flip.place());
  for (const v1::WhatIfTransition& t : reply.transitions()) moves.push_back(t.subject() + " " + t.to());
  EXPECT_THAT(places, Contains("run " + run.run() + ", node Hello"));
  EXPECT_THAT(places, Contains("activator of Called"));
  EXPECT_THAT(moves, Contains("Come-2 running")) << reply.DebugString();
  EXPECT_THAT(moves, Contains(run.run() + "/Hello running"));  // the one robot goes to the older run
  EXPECT_THAT(moves, Not(Contains("Come-2/Hello/0 running")));
  EXPECT_GT(reply.commands_size(), 0);

  // none of it has happened
  EXPECT_EQ(Revision(), before);
  EXPECT_FALSE(Ask(":John docent:isAt :Hall"));
  EXPECT_EQ(FindNode(GetRun(run.run()), "Hello")->state(), "waiting");
  // asserting it has exactly that effect
  v1::AssertRequest tell;
  *tell.mutable_add() = request.add();
  ASSERT_TRUE(Assert(tell).ok());
  EXPECT_EQ(FindNode(GetRun(run.run()), "Hello")->state(), "running");
  EXPECT_EQ(GetRun("Come-2").state(), "running");
}

TEST_F(ServerExplainTest, WhatIfSaysThatAConditionHasToLast) {
  StartServer();
  SetUpGreeting();
  std::string lasting = kCalled;
  const size_t rule = lasting.find("<rule ");
  ASSERT_NE(rule, std::string::npos);
  lasting.insert(rule + 6, "ext:for=\"3s\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\" ");
  const grpc::Status deployed = Deploy("called.xml", lasting);
  ASSERT_TRUE(deployed.ok()) << deployed.error_message();
  MustTell(":R1 a docent:Robot .");
  v1::WhatIfRequest request;
  *request.add_add() = Quad("Eve", "docent:calls", "R1");
  v1::WhatIfReply reply;
  ASSERT_TRUE(Call(context_, &v1::Context::Stub::WhatIf, request, &reply).ok());
  EXPECT_THAT(reply.text(), HasSubstr("activator of Called would open once it has held for 3s"));
  ASSERT_EQ(reply.flips_size(), 1);
  EXPECT_EQ(reply.flips(0).lasting_us(), 3000000);
  EXPECT_EQ(reply.transitions_size(), 0);
}

TEST_F(ServerExplainTest, WhatIfRefusesWhatAnAssertWouldBeRefused) {
  settings_.explain_limits.what_if_operations = 2;
  StartServer();
  v1::WhatIfRequest request;
  v1::WhatIfReply reply;
  *request.add_add() = Quad("a", "b", "c");
  request.mutable_add(0)->mutable_graph()->set_iri("https://w3id.org/docent#inferred");
  EXPECT_EQ(Call(context_, &v1::Context::Stub::WhatIf, request, &reply).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  request.clear_add();
  for (const char* o : {"c", "d"}) *request.add_add() = Quad("a", "b", o);
  EXPECT_TRUE(Call(context_, &v1::Context::Stub::WhatIf, request, &reply).ok());  // at the limit
  *request.add_add() = Quad("a", "b", "e");
  const grpc::Status status = Call(context_, &v1::Context::Stub::WhatIf, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("what_if_operations is 2"));
}

TEST_F(ServerExplainTest, WhatIfRefusesWhatAnAnswerCannotHold) {
  settings_.limits.grpc_message_bytes = 3000;
  StartServer();
  v1::WhatIfRequest request;
  v1::WhatIfReply reply;
  *request.add_add() = Quad("a", "b", "c");
  EXPECT_TRUE(Call(context_, &v1::Context::Stub::WhatIf, request, &reply).ok());
  request.mutable_add(0)->mutable_object()->mutable_literal()->set_lexical(std::string(1500, 'x'));
  const grpc::Status status = Call(context_, &v1::Context::Stub::WhatIf, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("grpc_message_bytes = 3000"));
}

TEST_F(ServerExplainTest, TheWorkEndsWhenTheCallerGoesAway) {
  settings_.limits.queries_running = 1;
  settings_.limits.query_timeout_ms = 600000;
  StartServer();
  std::string facts;
  for (int i = 0; i < 500; ++i) absl::StrAppend(&facts, ":a", i, " :p ", i, " . ");
  MustTell(facts);
  v1::ExplainRequest request;
  request.set_why_ask(
      "PREFIX : <urn:w:> ASK { ?a :p ?x . ?b :p ?y . ?c :p ?z . ?d :p ?w FILTER(?x * ?y * ?z * ?w = 7.5) }");
  v1::ExplainReply reply;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(200));
  EXPECT_EQ(context_->Explain(&context, request, &reply).error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_TRUE(Ask(":a1 :p 1"));  // who works on it is free again
}

TEST_F(ServerExplainTest, AQuestionThatWouldInferMillionsEndsInTime) {
  settings_.limits.queries_running = 1;
  const std::string rules = folder_ / "pairs.rules";
  std::ofstream(rules)
      << "PREFIX : <urn:w:> RULE { ?a :with ?b } WHERE { :Party :is :On . ?a :in :Hall . ?b :in :Hall }";
  settings_.rules = {rules};
  StartServer();
  std::string facts;
  for (int i = 0; i < 2000; ++i) absl::StrAppend(&facts, ":a", i, " :in :Hall . ");
  MustTell(facts);
  v1::WhatIfRequest request;
  v1::WhatIfReply reply;
  *request.add_add() = Quad("Party", "is", "On");
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(200));
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_EQ(context_->WhatIf(&context, request, &reply).error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_TRUE(Ask(":a1 :in :Hall"));  // who works on it is free again
  const auto took = std::chrono::steady_clock::now() - begun;
  std::printf("free after %.2f s\n", std::chrono::duration<double>(took).count());
  EXPECT_LT(took, std::chrono::seconds(2));  // without an end it takes many seconds

  StopServer();
  settings_.limits.query_timeout_ms = 100;
  StartServer();
  const grpc::Status status = Call(context_, &v1::Context::Stub::WhatIf, request, &reply);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_THAT(status.error_message(), HasSubstr("query_timeout_ms = 100"));
}

}  // namespace
}  // namespace docent::server::test
