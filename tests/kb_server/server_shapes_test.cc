// Shapes on a running server: validation on demand, loads with violations, modules that are added, changed
// and removed.
#include "gmock/gmock.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

constexpr char kShapes[] =
    "@prefix sh: <http://www.w3.org/ns/shacl#> . @prefix : <urn:w:> .\n"
    ":RoomShape a sh:NodeShape ; sh:targetClass :Room ;\n"
    "  sh:property [ sh:path :door ; sh:minCount 1 ; sh:message \"a room needs a door\" ] ,\n"
    "    [ sh:path :colour ; sh:in ( :White ) ; sh:severity sh:Warning ] .";
constexpr char kPrefix[] = "@prefix : <urn:w:> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n";

class ServerShapesTest : public ServerTest {
 protected:
  grpc::Status Validate(v1::ValidateReply* reply, const std::string& shapes = "", bool rdf = false) {
    v1::ValidateRequest request;
    request.set_rdf(rdf);
    if (!shapes.empty()) {
      request.add_shapes()->set_name("given.ttl");
      request.mutable_shapes(0)->set_text(shapes);
    }
    return Call(ontologies_, &v1::Ontologies::Stub::Validate, request, reply);
  }
  grpc::Status LoadData(const std::string& turtle, v1::LoadReply* reply = nullptr) {
    return Load(v1::LoadRequest::DATA, "data.ttl", kPrefix + turtle, reply);
  }
  grpc::Status LoadModule(const std::string& name, const std::string& turtle, v1::LoadRequest::Mode mode) {
    v1::LoadRequest request;
    request.set_name(name);
    request.set_text(kPrefix + turtle);
    request.set_mode(mode);
    v1::LoadReply reply;
    return Call(ontologies_, &v1::Ontologies::Stub::Load, request, &reply);
  }
};

TEST_F(ServerShapesTest, WhatTheServerHoldsIsValidatedOnDemand) {
  StartServer();
  ASSERT_TRUE(LoadData(":A a :Room . :B a :Room ; :door :D .").ok());
  v1::ValidateReply reply;
  EXPECT_THAT(Validate(&reply).error_message(), HasSubstr("no shape is loaded that has a target"));
  ASSERT_TRUE(Validate(&reply, kShapes).ok());
  EXPECT_FALSE(reply.conforms());
  EXPECT_EQ(reply.revision(), Revision());
  EXPECT_EQ(reply.focus_nodes(), 2u);
  ASSERT_EQ(reply.results_size(), 1);
  EXPECT_EQ(reply.results(0).focus().iri(), "urn:w:A");
  EXPECT_EQ(reply.results(0).message(), "a room needs a door");
  EXPECT_EQ(reply.results(0).constraint(), "sh:minCount");

  ASSERT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "shapes.ttl", kShapes).ok());
  v1::ValidateReply own, rdf;
  ASSERT_TRUE(Validate(&own).ok());
  EXPECT_EQ(own.total(), 1u);
  ASSERT_TRUE(Validate(&rdf, "", true).ok());
  EXPECT_EQ(rdf.results_size(), 0);
  EXPECT_GT(rdf.report_size(), 6);
  ASSERT_TRUE(LoadData(":A :door :E .").ok());
  v1::ValidateReply good;
  ASSERT_TRUE(Validate(&good).ok());
  EXPECT_TRUE(good.conforms());
}

TEST_F(ServerShapesTest, IllFormedShapesAreRefusedWithTheirPlace) {
  StartServer();
  v1::ValidateReply reply;
  grpc::Status status = Validate(
      &reply, "@prefix sh: <http://www.w3.org/ns/shacl#> .\n<urn:s> sh:targetNode 1 ;\n sh:nodeKind 2 .");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("given.ttl:3:14: error: shape <urn:s>: sh:nodeKind is 2"));
  status = Validate(&reply, "<urn:s> <urn:p> ");
  EXPECT_THAT(status.error_message(), HasSubstr("given.ttl:1:"));
}

TEST_F(ServerShapesTest, ALoadThatViolatesIsRefusedAndChangesNothing) {
  settings_.on_violation = OnViolation::kRefuse;
  StartServer();
  ASSERT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "shapes.ttl", kShapes).ok());
  const uint64_t before = Revision();
  grpc::Status status = LoadData(":A a :Room ; :colour :White .");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("violation: :A :door: a room needs a door"));
  EXPECT_EQ(Revision(), before);
  EXPECT_FALSE(Ask(":A ?p ?o"));

  v1::LoadReply reply;
  status = LoadData(":A a :Room ; :door :D ; :colour :Red .", &reply);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(reply.diagnostics_size(), 1) << "a warning does not refuse";
  EXPECT_TRUE(reply.diagnostics(0).warning());

  EXPECT_TRUE(LoadData(":C a :Room ; :door :D .").ok());
  EXPECT_FALSE(LoadData(":E a :Room .").ok());
}

TEST_F(ServerShapesTest, ShapesThatTheGraphViolatesAreRefusedToo) {
  settings_.on_violation = OnViolation::kRefuse;
  StartServer();
  ASSERT_TRUE(LoadData(":A a :Room .").ok());
  v1::LoadRequest request;
  request.set_name("shapes.ttl");
  request.set_text(kShapes);
  v1::CheckModuleReply check;
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::Check, request, &check).ok());
  EXPECT_FALSE(check.conforms());
  EXPECT_EQ(check.results_size(), 1);
  EXPECT_EQ(Load(v1::LoadRequest::ONTOLOGY, "shapes.ttl", kShapes).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
  ASSERT_TRUE(LoadData(":A :door :D .").ok());
  EXPECT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "shapes.ttl", kShapes).ok());
}

TEST_F(ServerShapesTest, ResultsNameTheLinesOfTheTextsThatTheRequestBrings) {
  settings_.on_violation = OnViolation::kRefuse;
  StartServer();
  ASSERT_TRUE(LoadData(":A a :Room .").ok());
  v1::ValidateReply reply;
  ASSERT_TRUE(Validate(&reply, kShapes).ok());
  ASSERT_EQ(reply.results_size(), 1);
  EXPECT_EQ(reply.results(0).shape_place().file(), "given.ttl");
  EXPECT_EQ(reply.results(0).shape_place().line(), 3);
  EXPECT_EQ(reply.results(0).shape_place().column(), 15);
  EXPECT_FALSE(reply.results(0).has_place()) << "the server has no text of what it holds";

  v1::LoadRequest request;
  request.set_name("shapes.ttl");
  request.set_text(kShapes);
  v1::CheckModuleReply check;
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::Check, request, &check).ok());
  ASSERT_EQ(check.results_size(), 1);
  EXPECT_EQ(check.results(0).shape_place().file(), "shapes.ttl");
  EXPECT_EQ(check.results(0).shape_place().line(), 3);
  EXPECT_FALSE(check.results(0).has_place());

  ASSERT_TRUE(LoadData(":A :door :D .").ok());
  ASSERT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "shapes.ttl", kShapes).ok());
  EXPECT_THAT(LoadData(":C a :Room ; :door :D .\n:B a :Room .").error_message(),
              HasSubstr("data.ttl:3:1: violation: :B :door: a room needs a door"));
  EXPECT_THAT(LoadData("\n[] a :Room .").error_message(), HasSubstr("data.ttl:3:1: violation: _:"));
  v1::LoadReply loaded;
  ASSERT_TRUE(LoadData(":D a :Room ;\n  :door :D ; :colour :Red .", &loaded).ok());
  ASSERT_EQ(loaded.diagnostics_size(), 1);
  EXPECT_EQ(loaded.diagnostics(0).file(), "data.ttl");
  EXPECT_EQ(loaded.diagnostics(0).line(), 3);
  EXPECT_EQ(loaded.diagnostics(0).column(), 22);

  // a part of a document has line numbers of its own
  request.set_kind(v1::LoadRequest::DATA);
  request.set_document("d");
  request.set_text("<urn:w:E> a <urn:w:Room> .");
  v1::LoadReply part;
  const grpc::Status status = Call(ontologies_, &v1::Ontologies::Stub::Load, request, &part);
  EXPECT_THAT(status.error_message(), HasSubstr("nothing was changed:\nviolation: :E "));
}

TEST_F(ServerShapesTest, AServerThatWarnsLoadsAndSaysWhy) {
  settings_.on_violation = OnViolation::kWarn;
  StartServer();
  ASSERT_TRUE(Load(v1::LoadRequest::ONTOLOGY, "shapes.ttl", kShapes).ok());
  v1::LoadReply reply;
  ASSERT_TRUE(LoadData(":A a :Room .", &reply).ok());
  ASSERT_EQ(reply.diagnostics_size(), 1);
  EXPECT_THAT(reply.diagnostics(0).message(), HasSubstr("a room needs a door"));
  EXPECT_TRUE(Ask(":A a :Room"));
}

TEST_F(ServerShapesTest, ModulesAreAddedReplacedAndListedWithTheirVersions) {
  StartServer();
  EXPECT_EQ(LoadModule("m.ttl", ":a :b 1 .", v1::LoadRequest::REPLACE).error_code(),
            grpc::StatusCode::NOT_FOUND);
  ASSERT_TRUE(
      LoadModule("m.ttl", ":m a owl:Ontology ; owl:versionInfo \"1.0\" . :a :b 1 .", v1::LoadRequest::ADD)
          .ok());
  EXPECT_EQ(LoadModule("m.ttl", ":a :b 2 .", v1::LoadRequest::ADD).error_code(),
            grpc::StatusCode::ALREADY_EXISTS);
  EXPECT_TRUE(Ask(":a :b 1"));
  ASSERT_TRUE(
      LoadModule("m.ttl",
                 ":m a owl:Ontology ; owl:versionInfo \"1.1\" ; owl:versionIRI <urn:w:m/1.1> . :a :b 2 .",
                 v1::LoadRequest::REPLACE)
          .ok());
  EXPECT_FALSE(Ask(":a :b 1"));
  EXPECT_TRUE(Ask(":a :b 2"));
  v1::ListOntologiesReply list;
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::List, v1::ListOntologiesRequest(), &list).ok());
  ASSERT_EQ(list.modules_size(), 1);
  EXPECT_EQ(list.modules(0).ontology(), "urn:w:m");
  EXPECT_EQ(list.modules(0).version_info(), "1.1");
  EXPECT_EQ(list.modules(0).version_iri(), "urn:w:m/1.1");
  EXPECT_EQ(list.modules(0).revision(), Revision());
}

TEST_F(ServerShapesTest, ModulesAreListedWithTheImportsThatAreNotLoaded) {
  StartServer();
  ASSERT_TRUE(
      LoadModule("m.ttl", ":m a owl:Ontology ; owl:imports :n , :o , :v1 .", v1::LoadRequest::ADD).ok());
  ASSERT_TRUE(LoadModule("n.ttl", ":n a owl:Ontology ; owl:versionIRI :v1 .", v1::LoadRequest::ADD).ok());
  v1::ListOntologiesReply list;
  ASSERT_TRUE(Call(ontologies_, &v1::Ontologies::Stub::List, v1::ListOntologiesRequest(), &list).ok());
  ASSERT_EQ(list.modules_size(), 2);
  ASSERT_EQ(list.modules(0).missing_imports_size(), 1);
  EXPECT_EQ(list.modules(0).missing_imports(0), "urn:w:o");
  EXPECT_EQ(list.modules(1).missing_imports_size(), 0);
}

TEST_F(ServerShapesTest, AModuleWithoutTriplesIsThere) {
  StartServer();
  ASSERT_TRUE(LoadModule("m.ttl", ":a :b 1 .", v1::LoadRequest::ADD).ok());
  ASSERT_TRUE(LoadModule("m.ttl", "", v1::LoadRequest::REPLACE).ok());
  EXPECT_FALSE(Ask(":a :b 1"));
  EXPECT_EQ(LoadModule("m.ttl", ":a :b 2 .", v1::LoadRequest::ADD).error_code(),
            grpc::StatusCode::ALREADY_EXISTS);
  ASSERT_TRUE(LoadModule("m.ttl", ":a :b 3 .", v1::LoadRequest::REPLACE).ok());
  EXPECT_TRUE(Ask(":a :b 3"));
}

}  // namespace
}  // namespace docent::server::test
