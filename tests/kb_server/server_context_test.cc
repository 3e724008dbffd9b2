// Asserting and querying over gRPC, the limits, and the effect of one client's bad input on others.
#include <arpa/inet.h>
#include <grpcpp/impl/client_unary_call.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <fstream>
#include <thread>

#include "absl/strings/numbers.h"
#include "gmock/gmock.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class ServerContextTest : public ServerTest {};

v1::AssertRequest Words(int count, const std::string& subject = "urn:w:s") {
  v1::AssertRequest request;
  for (int i = 0; i < count; ++i) {
    v1::Quad* quad = request.add_add();
    quad->mutable_subject()->set_iri(subject);
    quad->mutable_predicate()->set_iri("urn:w:p");
    quad->mutable_object()->set_iri(absl::StrCat("urn:w:o", i));
  }
  return request;
}

TEST_F(ServerContextTest, WhatIsToldIsSeenAtOnce) {
  StartServer();
  v1::AssertReply reply;
  ASSERT_TRUE(Assert(Turtle(":John :at :Hall ."), &reply).ok());
  EXPECT_EQ(reply.offset(), 1u);
  EXPECT_EQ(reply.added(), 1u);
  EXPECT_TRUE(Ask(":John :at :Hall"));
  v1::AssertRequest request = Turtle(":John :at :Garden .");
  v1::Quad* quad = request.add_remove();
  quad->mutable_subject()->set_iri("urn:w:John");
  quad->mutable_predicate()->set_iri("urn:w:at");
  quad->mutable_object()->set_iri("urn:w:Hall");
  ASSERT_TRUE(Assert(request, &reply).ok());
  EXPECT_EQ(reply.removed(), 1u);
  EXPECT_FALSE(Ask(":John :at :Hall"));
  EXPECT_TRUE(Ask(":John :at :Garden"));
}

TEST_F(ServerContextTest, ABadBatchSaysWhereAndChangesNothing) {
  StartServer();
  v1::AssertRequest request = Words(2);
  request.mutable_add(1)->mutable_object()->clear_kind();
  grpc::Status status = Assert(request);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("add[1].object"));
  status = Assert(Turtle(":a :b :c .\n:a :b .\n"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("rdf:3:7")) << "line and column";
  request = Words(1);
  request.set_request_id(std::string(257, 'x'));
  EXPECT_EQ(Assert(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  // options without effect are refused, not ignored
  request = Turtle(":a :b :c .");
  request.set_mode(v1::AssertRequest::LOAD);
  request.set_lifetime_ms(100);
  EXPECT_EQ(Assert(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  request.set_lifetime_ms(0);
  request.set_mode(static_cast<v1::AssertRequest::Mode>(9));
  EXPECT_EQ(Assert(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  request = Words(1);
  v1::Literal* literal = request.mutable_add(0)->mutable_object()->mutable_literal();
  literal->set_language("en");
  literal->set_datatype("http://www.w3.org/2001/XMLSchema#string");
  EXPECT_EQ(Assert(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  literal->set_language("");
  literal->set_datatype("http://www.w3.org/1999/02/22-rdf-syntax-ns#langString");
  EXPECT_EQ(Assert(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Revision(), 0u);
}

// RDF 1.1 section 3.4: blank node labels mean nothing outside of their document.
TEST_F(ServerContextTest, BlankNodesOfDifferentTextsAreDifferent) {
  StartServer();
  for (const char* text :
       {":John :saw [ :what 1 ] . _:n :what 2 .", ":Mary :saw [ :what 3 ] . _:n :what 4 ."}) {
    ASSERT_TRUE(Assert(Turtle(text)).ok());
    ASSERT_TRUE(Load(v1::LoadRequest::DATA, "data.ttl", absl::StrCat("@prefix : <urn:w:> . ", text)).ok());
  }
  EXPECT_FALSE(Ask("?n :what ?a . ?n :what ?b FILTER(?a != ?b)"));
  // a part of a document knows the blank nodes of the other parts, and a repeated text is the same
  v1::LoadRequest part;
  part.set_kind(v1::LoadRequest::DATA);
  part.set_document("both");
  v1::LoadReply reply;
  for (const auto& [text, added] :
       {std::pair("_:m <urn:w:a> 1 .", 1u), {"_:m <urn:w:b> 1 .", 1u}, {"_:m <urn:w:b> 1 .", 0u}}) {
    part.set_text(text);
    ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::Load, part, &reply).ok());
    EXPECT_EQ(reply.added(), added);
  }
  EXPECT_TRUE(Ask("?m :a 1 ; :b 1"));
}

TEST_F(ServerContextTest, ARepeatedRequestIdIsAnsweredAndNotApplied) {
  StartServer();
  v1::AssertReply first, second;
  ASSERT_TRUE(Assert(Turtle(":a :b :c .", "one"), &first).ok());
  ASSERT_TRUE(Assert(Turtle(":a :b :c .", "one"), &second).ok());
  EXPECT_FALSE(first.repeated());
  EXPECT_TRUE(second.repeated());
  EXPECT_EQ(second.offset(), first.offset());
  EXPECT_EQ(Revision(), 1u);
}

TEST_F(ServerContextTest, AStreamAnswersInOrderAndABadBatchDoesNotEndIt) {
  StartServer();
  grpc::ClientContext context;
  Limit(&context);
  auto stream = context_->AssertStream(&context);
  constexpr int kBatches = 600;  // more than the server lets be in flight
  std::thread sender([&] {
    for (int i = 0; i < kBatches; ++i) {
      v1::AssertRequest request = Words(1, absl::StrCat("urn:w:s", i));
      if (i % 100 == 50) request.mutable_add(0)->mutable_subject()->set_iri("relative");
      request.set_request_id(absl::StrCat(i));
      ASSERT_TRUE(stream->Write(request));
    }
    stream->WritesDone();
  });
  v1::AssertStreamReply reply;
  uint64_t offset = 0;
  int count = 0;
  for (; stream->Read(&reply); ++count) {
    EXPECT_EQ(reply.request_id(), absl::StrCat(count));
    if (count % 100 == 50) {
      EXPECT_EQ(reply.error().code(), static_cast<int>(grpc::StatusCode::INVALID_ARGUMENT));
      EXPECT_THAT(reply.error().message(), HasSubstr("add[0].subject"));
    } else {
      EXPECT_EQ(reply.reply().offset(), ++offset);
    }
  }
  sender.join();
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(count, kBatches);
  EXPECT_EQ(Revision(), static_cast<uint64_t>(kBatches - kBatches / 100));
}

TEST_F(ServerContextTest, AClientThatGoesAwayInTheMiddleOfAStreamHarmsNobody) {
  StartServer();
  for (int i = 0; i < 20; ++i) {
    grpc::ClientContext context;
    Limit(&context);
    auto stream = context_->AssertStream(&context);
    for (int j = 0; j < 20; ++j) stream->Write(Words(1, absl::StrCat("urn:w:s", i, "_", j)));
    context.TryCancel();
    v1::AssertStreamReply reply;
    while (stream->Read(&reply)) continue;
    stream->Finish();
  }
  EXPECT_TRUE(Assert(Turtle(":a :b :c .")).ok());
}

TEST_F(ServerContextTest, WhatCannotBeMeasuredIsNotTold) {
  StartServer();
  const uint64_t revision = Revision();
  const auto refused = [this](const std::string& facts, const std::string& why) {
    const grpc::Status status =
        Assert(Turtle("@prefix xsd: <http://www.w3.org/2001/XMLSchema#> . " + facts + " ."));
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << facts;
    EXPECT_THAT(status.error_message(), HasSubstr(why)) << facts;
  };
  for (const char* number : {"\"NaN\"^^xsd:double", "\"INF\"^^xsd:double", "\"-INF\"^^xsd:float",
                             "\"1e400\"^^xsd:double", "\"nan\"^^xsd:decimal"}) {
    refused(absl::StrCat(":R1 :battery ", number), "is not a finite number; leave out what was not measured");
  }
  refused(":R1 docent:x \"NaN\"^^xsd:double ; docent:y 1.0", "docent:x is");
  refused(":R1 docent:x \"three\"", "it must be a number from -1000000 to 1000000 (metres)");
  refused(":R1 docent:y 1e9", "docent:y is");
  refused(":R1 docent:heading 70000.0", "from -1000 to 1000 (radians)");
  refused(":R1 docent:progress 1.5", "from 0 to 1");
  v1::AssertRequest reading;
  reading.add_readings()->set_sensor("urn:w:Door");
  v1::Literal* value = reading.mutable_readings(0)->mutable_value()->mutable_literal();
  value->set_lexical("INF");
  value->set_datatype("http://www.w3.org/2001/XMLSchema#double");
  EXPECT_THAT(Assert(reading).error_message(), HasSubstr("readings[0].value is"));
  value->set_lexical("1.5");
  reading.mutable_readings(0)->set_time_us(-1);
  EXPECT_THAT(Assert(reading).error_message(), HasSubstr("readings[0].time_us is -1"));
  EXPECT_EQ(Revision(), revision);

  MustTell(":R1 a docent:Robot ; docent:x 1.5 ; docent:y -0.5 ; docent:heading 3 ; :battery 8.5e1 .");
  EXPECT_TRUE(Robots()[0].has_pose());
  // Data may contain everything that RDF allows; that does not make it a pose.
  ASSERT_TRUE(Load(v1::LoadRequest::DATA, "d.ttl",
                   "@prefix docent: <https://w3id.org/docent#> . <urn:w:R2> a docent:Robot ; "
                   "docent:x \"NaN\"^^<http://www.w3.org/2001/XMLSchema#double> ; docent:y 1e300 .")
                  .ok());
  ASSERT_EQ(Robots().size(), 2u);
  EXPECT_FALSE(Robots()[1].has_pose());
}

TEST_F(ServerContextTest, BeyondALimitNothingIsAppliedAndTheLimitIsNamed) {
  settings_.limits.batch_operations = 10;
  settings_.limits.term_bytes = 1000;
  settings_.limits.document_bytes = 20000;
  settings_.limits.query_text_bytes = 2000;
  settings_.limits.grpc_message_bytes = 64 << 10;
  StartServer();
  auto expect = [](const grpc::Status& status, const std::string& limit) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr(limit));
  };
  expect(Assert(Words(11)), "batch_operations is 10");
  v1::AssertRequest request = Words(1);
  request.mutable_add(0)->mutable_object()->mutable_literal()->set_lexical(std::string(1001, 'x'));
  expect(Assert(request), "term_bytes is 1000");
  request.mutable_add(0)->mutable_object()->mutable_literal()->set_lexical(std::string(100 << 10, 'x'));
  expect(Assert(request), "term_bytes is 1000");  // larger than grpc_message_bytes, and still by its own name
  expect(Load(v1::LoadRequest::DATA, "big.ttl", std::string(20001, '#')), "document_bytes is 20000");
  expect(Deploy("big.xml", std::string(20001, ' ')),
         "big.xml has 20001 bytes; the limit document_bytes is 20000");
  v1::CheckRequest check;
  v1::CheckReply checked;
  check.set_cawl(std::string(20001, ' '));
  expect(Call(workflows_, &v1::Workflows::Stub::Check, check, &checked), "document_bytes is 20000");
  v1::RegisterRequest registration;
  v1::RegisterReply registered;
  registration.set_rsel(std::string(20001, ' '));
  expect(Call(services_, &v1::RobotServices::Stub::Register, registration, &registered),
         "document_bytes is 20000");
  v1::StartRequest start;
  v1::StartReply started;
  v1::NamedTerm* variable = start.add_variables();
  variable->set_name("x");
  variable->mutable_value()->mutable_literal()->set_lexical(std::string(1001, 'x'));
  expect(Call(workflows_, &v1::Workflows::Stub::Start, start, &started), "term_bytes is 1000");
  expect(Query("ASK {} #" + std::string(2000, 'x')).status, "query_text_bytes is 2000");
  EXPECT_EQ(Revision(), 0u);
  EXPECT_TRUE(Assert(Words(10)).ok()) << "at the limit";
  EXPECT_EQ(Revision(), 1u);
}

TEST_F(ServerContextTest, QueriesOfAllForms) {
  StartServer();
  MustTell(":a :p 1 . :b :p 2 ; :q \"two\"@en .");
  Rows rows = Query("PREFIX : <urn:w:> SELECT ?s ?v ?q { ?s :p ?v OPTIONAL { ?s :q ?q } } ORDER BY ?v");
  ASSERT_TRUE(rows.status.ok());
  EXPECT_THAT(rows.header.variables(), ElementsAre("s", "v", "q"));
  EXPECT_EQ(rows.header.revision(), 1u);
  EXPECT_THAT(rows.rows, ElementsAre("<urn:w:a> \"1\" -", "<urn:w:b> \"2\" \"two\""));

  rows = Query("PREFIX : <urn:w:> ASK { :a :p 1 }");
  EXPECT_TRUE(rows.header.is_boolean());
  EXPECT_TRUE(rows.header.boolean());

  rows = Query("PREFIX : <urn:w:> CONSTRUCT { ?s :has ?v } { ?s :p ?v }");
  ASSERT_TRUE(rows.status.ok());
  EXPECT_THAT(rows.rows, UnorderedElementsAre("<urn:w:a> <urn:w:has> \"1\"", "<urn:w:b> <urn:w:has> \"2\""));
}

TEST_F(ServerContextTest, AQueryWaitsForTheRevisionThatItsClientWants) {
  StartServer();
  std::thread later([&] { MustTell(":a :p 1 ."); });
  EXPECT_TRUE(Ask(":a :p 1", 1));
  later.join();
  Rows rows = Query("ASK {}", 1000, 50);
  EXPECT_EQ(rows.status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_THAT(rows.status.error_message(), HasSubstr("revision 1000"));
}

TEST_F(ServerContextTest, AMistakeInAQueryIsShownWithItsPlace) {
  StartServer();
  Rows rows = Query("SELECT ?x\nWHERE { ?x ?y }");
  EXPECT_EQ(rows.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(rows.status.error_message(), HasSubstr("2:15"));
  EXPECT_THAT(rows.status.error_message(), HasSubstr("WHERE { ?x ?y }\n"));
}

constexpr char kBomb[] =
    "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l . ?m ?o ?p . ?q ?r ?s }";

TEST_F(ServerContextTest, AValueOfAnEnumerationThatIsNotKnownIsRefused) {
  StartServer();
  v1::QueryRequest request;
  request.set_query("ASK {}");
  request.set_default_graph(static_cast<v1::QueryRequest::DefaultGraph>(7));
  grpc::ClientContext context;
  Limit(&context);
  auto reader = context_->Query(&context, request);
  v1::QueryReply reply;
  EXPECT_FALSE(reader->Read(&reply));
  const grpc::Status status = reader->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("default_graph 7 is not known"));
}

TEST_F(ServerContextTest, ACallOfNoFunctionIsShownWithItsPlaceAndWhatItTakes) {
  StartServer();
  EXPECT_THAT(Query("SELECT * { BIND(docent:distanse(1, 2, 3, 4) AS ?d) }").status.error_message(),
              AllOf(HasSubstr("1:17: error: no function"), HasSubstr("^"),
                    HasSubstr("did you mean <https://w3id.org/docent#distance>?")));
  EXPECT_THAT(Query("SELECT * { BIND(docent:distance(1, 2, 3) AS ?d) }").status.error_message(),
              AllOf(HasSubstr("does not take 3 arguments"), HasSubstr("it takes 4")));
  EXPECT_TRUE(
      Query("SELECT * { SERVICE SILENT <http://127.0.0.1:1/> { BIND(<urn:theirs>(1) AS ?d) } }").status.ok())
      << "theirs, not ours";
}

TEST_F(ServerContextTest, AQueryBombIsStoppedAndOthersGoOn) {
  StartServer();
  ASSERT_TRUE(Assert(Words(500)).ok());
  std::vector<Rows> bombs(3);
  std::vector<std::thread> throwers;
  for (Rows& bomb : bombs) throwers.emplace_back([&] { bomb = Query(kBomb, 0, 300); });
  EXPECT_TRUE(Ask(":s :p :o7"));
  EXPECT_TRUE(Assert(Turtle(":a :b :c .")).ok());
  for (std::thread& thrower : throwers) thrower.join();
  for (Rows& bomb : bombs) {
    EXPECT_EQ(bomb.status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    EXPECT_THAT(bomb.status.error_message(), HasSubstr("query_timeout_ms = 300"));
  }
}

TEST_F(ServerContextTest, AQueryIsExplainedWithEstimatedAndRealRows) {
  StartServer();
  ASSERT_TRUE(Assert(Words(20)).ok());
  v1::QueryRequest request;
  request.set_query("SELECT * { ?s <urn:w:p> ?o FILTER NOT EXISTS { ?o <urn:w:p> ?x } }");
  request.set_explain(true);
  grpc::ClientContext context;
  Limit(&context);
  auto reader = context_->Query(&context, request);
  v1::QueryReply reply;
  ASSERT_TRUE(reader->Read(&reply));
  EXPECT_THAT(reply.header().plan(), HasSubstr("| 20 rows"));
  EXPECT_THAT(reply.header().plan(), HasSubstr("not exists"));
  EXPECT_FALSE(reader->Read(&reply));
  EXPECT_TRUE(reader->Finish().ok());
}

TEST_F(ServerContextTest, AClientThatGoesAwayEndsItsQuery) {
  StartServer();
  ASSERT_TRUE(Assert(Words(500)).ok());
  std::vector<std::string> texts(6, kBomb);  // more than the server has workers
  texts.push_back("ASK {}");                 // waits for a revision that does not come
  for (const std::string& text : texts) {
    v1::QueryRequest request;
    request.set_query(text);
    request.set_min_revision(text == "ASK {}" ? 1000 : 0);
    grpc::ClientContext context;
    Limit(&context);
    auto reader = context_->Query(&context, request);
    v1::QueryReply reply;
    if (text == kBomb) reader->Read(&reply);  // the header: a worker is at it
    context.TryCancel();
    while (reader->Read(&reply)) continue;
    EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  EXPECT_TRUE(Ask(":s :p :o7")) << "all workers are free again, long before the limit of 30 s";
}

TEST_F(ServerContextTest, OntologiesAreLoadedReplacedListedAndRemoved) {
  StartServer();
  v1::LoadReply reply;
  ASSERT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "place.ttl",
                   "@prefix : <urn:w:> . :Hall a :Place . :Room a :Place .", &reply)
                  .ok());
  EXPECT_EQ(reply.added(), 2u);
  EXPECT_TRUE(Ask("GRAPH <https://w3id.org/docent/ontology/place.ttl> { :Room a :Place }"));
  ASSERT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "place.ttl",
                   "@prefix : <urn:w:> . :Hall a :Place . :Yard a :Place .", &reply)
                  .ok());
  EXPECT_EQ(reply.added(), 1u);
  EXPECT_EQ(reply.removed(), 1u);
  EXPECT_FALSE(Ask(":Room a :Place"));
  ASSERT_TRUE(Load(v1::LoadRequest::RULES, "place.rules",
                   "RULE { ?x a <urn:w:Thing> } WHERE { ?x a <urn:w:Place> }", &reply)
                  .ok());
  EXPECT_EQ(reply.inferred(), 2u);
  ASSERT_TRUE(Load(v1::LoadRequest::DATA, "", "@prefix : <urn:w:> . :John :at :Yard .", &reply).ok());

  v1::ListOntologiesReply list;
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::List, v1::ListOntologiesRequest(), &list).ok());
  ASSERT_EQ(list.modules_size(), 2);
  EXPECT_EQ(list.modules(0).name(), "place.ttl");
  EXPECT_EQ(list.modules(0).size(), 2u);
  EXPECT_EQ(list.modules(0).revision(), 2u);
  EXPECT_EQ(list.modules(1).kind(), v1::LoadRequest::RULES);
  EXPECT_EQ(list.modules(1).size(), 1u) << "rules";

  v1::RemoveOntologyRequest remove;
  remove.set_name("place.ttl");
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::Remove, remove, &reply).ok());
  EXPECT_FALSE(Ask(":Yard a :Place"));
  EXPECT_FALSE(Ask(":Yard a :Thing"));
  EXPECT_TRUE(Ask(":John :at :Yard"));
  EXPECT_EQ(Call(ontologies_, &v1::Ontologies::Stub::Remove, remove, &reply).error_code(),
            grpc::StatusCode::NOT_FOUND);
  remove.set_name("place.rules");
  EXPECT_EQ(Call(ontologies_, &v1::Ontologies::Stub::Remove, remove, &reply).error_code(),
            grpc::StatusCode::NOT_FOUND);
  remove.set_kind(v1::LoadRequest::RULES);
  EXPECT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::Remove, remove, &reply).ok());
}

TEST_F(ServerContextTest, AModuleThatDoesNotParseIsRefusedWithItsPlace) {
  StartServer();
  grpc::Status status =
      Load(v1::LoadRequest::ONTOLOGY, "bad.ttl", "@prefix : <urn:w:> .\n:a :b :c .\n:a b :c .\n");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("bad.ttl:3:4: error:"));
  status = Load(v1::LoadRequest::RULES, "bad.rules", "RULE { ?x a <urn:w:T> } WHERE {\n ?y a <urn:w:T> }");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("bad.rules:1:"));
  EXPECT_EQ(Load(v1::LoadRequest::ONTOLOGY, "", "").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Revision(), 0u);
}

// Connects, sends, and waits until the server has closed the connection or read everything.
void SendRaw(const std::string& address, const std::string& bytes) {
  int port = 0;
  ASSERT_TRUE(absl::SimpleAtoi(address.substr(address.rfind(':') + 1), &port));
  int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(connect(fd, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
  (void)!send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  shutdown(fd, SHUT_WR);
  char buffer[4096];
  while (recv(fd, buffer, sizeof buffer, 0) > 0) continue;
  close(fd);
}

grpc::Status CallRaw(grpc::ChannelInterface* channel, const grpc::internal::RpcMethod& method,
                     grpc::ClientContext* context, const grpc::ByteBuffer& request,
                     grpc::ByteBuffer* answer) {
  return grpc::internal::BlockingUnaryCallImpl<grpc::ByteBuffer, grpc::ByteBuffer>(channel, method, context,
                                                                                   request, answer)
      .status();
}

TEST_F(ServerContextTest, GarbageOnThePortDoesNotTouchOtherClients) {
  StartServer();
  grpc::ClientContext context;
  Limit(&context);
  auto stream = context_->AssertStream(&context);
  std::string garbage;
  uint32_t state = 1;
  for (int i = 0; i < 100000; ++i)
    garbage.push_back(static_cast<char>((state = state * 1664525 + 1013904223) >> 24));
  v1::AssertStreamReply reply;
  for (const std::string& bytes : {garbage, std::string("GET / HTTP/1.1\r\nHost: x\r\n\r\n"),
                                   "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + garbage}) {
    SendRaw(server_->grpc_address(), bytes);
    ASSERT_TRUE(stream->Write(Words(1)));
    ASSERT_TRUE(stream->Read(&reply));
    EXPECT_TRUE(reply.has_reply());
  }
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());

  // a message that is no AssertRequest
  grpc::internal::RpcMethod method("/docent.v1.Context/Assert", grpc::internal::RpcMethod::NORMAL_RPC);
  grpc::ClientContext bad_context;
  Limit(&bad_context);
  grpc::Slice slice(garbage.substr(0, 1000));
  grpc::ByteBuffer request(&slice, 1), answer;
  grpc::Status status = CallRaw(channel_.get(), method, &bad_context, request, &answer);
  EXPECT_FALSE(status.ok());
  EXPECT_TRUE(Assert(Words(1)).ok());
}

TEST_F(ServerContextTest, HealthAndReflectionAnswer) {
  StartServer();
  grpc::internal::RpcMethod check("/grpc.health.v1.Health/Check", grpc::internal::RpcMethod::NORMAL_RPC);
  grpc::ByteBuffer answer;
  grpc::Slice bytes;
  for (const char* request : {"",
                              "\x0a\x11"
                              "docent.v1.Context",
                              "\x0a\x0f"
                              "docent.v1.Fleet"}) {  // HealthCheckRequest.service
    grpc::ClientContext context;
    Limit(&context);
    grpc::Slice slice{std::string(request)};
    grpc::Status status = CallRaw(channel_.get(), check, &context, grpc::ByteBuffer(&slice, 1), &answer);
    ASSERT_TRUE(status.ok()) << request << status.error_message();
    ASSERT_TRUE(answer.DumpToSingleSlice(&bytes).ok());
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.begin()), bytes.size()), "\x08\x01")
        << "SERVING";
  }

  grpc::internal::RpcMethod info("/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
                                 grpc::internal::RpcMethod::BIDI_STREAMING);
  grpc::ClientContext reflection_context;
  Limit(&reflection_context);
  std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> stream(
      grpc::internal::ClientReaderWriterFactory<grpc::ByteBuffer, grpc::ByteBuffer>::Create(
          channel_.get(), info, &reflection_context));
  grpc::Slice list_services(std::string("\x3a\x01*"));  // ServerReflectionRequest.list_services = "*"
  ASSERT_TRUE(stream->Write(grpc::ByteBuffer(&list_services, 1)));
  ASSERT_TRUE(stream->Read(&answer));
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());
  ASSERT_TRUE(answer.DumpToSingleSlice(&bytes).ok());
  std::string names(reinterpret_cast<const char*>(bytes.begin()), bytes.size());
  for (const char* name : {"docent.v1.Context", "docent.v1.Fleet", "docent.v1.Ontologies",
                           "docent.v1.RobotServices", "docent.v1.Workflows", "grpc.health.v1.Health"}) {
    EXPECT_THAT(names, HasSubstr(name));
  }
}

}  // namespace
}  // namespace docent::server::test
