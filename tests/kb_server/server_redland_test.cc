// A running server's graph as the store of a Redland storage.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "graph/rdf/vocabulary.h"
#include "graph/redland/client_store.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using redland::ClientStore;
using redland::QuadQuery;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr QuadOperation::Kind kAdd = QuadOperation::Kind::kAdd;
constexpr QuadOperation::Kind kRemove = QuadOperation::Kind::kRemove;

TermQuad Quad(const std::string& s, const Term& o, const std::string& g = "") {
  return {s[0] == '_' ? Term::Blank(s.substr(1)) : Term::Iri("urn:w:" + s), Term::Iri("urn:w:p"), o,
          Term::Iri(g.empty() ? std::string(kDefaultGraph) : "urn:w:" + g)};
}

class ServerRedlandTest : public ServerTest {
 protected:
  void OpenStore(const Limits& limits = {}) {
    auto store = ClientStore::Open(server_->grpc_address(), "test", limits);
    ASSERT_TRUE(store.ok()) << store.status();
    store_ = *std::move(store);
  }
  std::vector<std::string> Find(const QuadQuery& query) {
    auto stream = store_->Find(query);
    EXPECT_TRUE(stream.ok()) << stream.status();
    std::vector<std::string> lines;
    for (TermQuad q; stream.ok() && (*stream)->Next(&q);) {
      lines.push_back(
          absl::StrCat(ToNTriples(q.subject), " ", ToNTriples(q.object), " ", ToNTriples(q.graph)));
    }
    return lines;
  }

  std::unique_ptr<ClientStore> store_;
};

TEST_F(ServerRedlandTest, FindsByEachPartBlankNodesToo) {
  for (auto mode : {sparql::DefaultGraph::kUnion, sparql::DefaultGraph::kStrict}) {
    SCOPED_TRACE(mode == sparql::DefaultGraph::kUnion ? "union" : "strict");
    settings_.data_folder = folder_ / (mode == sparql::DefaultGraph::kUnion ? "union" : "strict");
    settings_.default_graph = mode;
    StartServer();
    OpenStore();
    ASSERT_TRUE(store_
                    ->Apply({{kAdd, Quad("a", Term::LangString("x \"y\"", "en"))},
                             {kAdd, Quad("a", Term::LangString("x \"y\"", "en"), "g")},
                             {kAdd, Quad("_b1", Term::Integer(7), "g")},
                             {kAdd, Quad("_b2", Term::Blank("b1"), "h")}})
                    .ok());
    EXPECT_EQ(*store_->Size(), 4u);
    EXPECT_THAT(Find({}), ElementsAre("_:b1 \"7\"^^<http://www.w3.org/2001/XMLSchema#integer> <urn:w:g>",
                                      "_:b2 _:b1 <urn:w:h>",
                                      "<urn:w:a> \"x \\\"y\\\"\"@en <https://w3id.org/docent#default>",
                                      "<urn:w:a> \"x \\\"y\\\"\"@en <urn:w:g>"));
    EXPECT_THAT(Find({Term::Blank("b1"), {}, {}, {}}), ElementsAre(HasSubstr("\"7\"")));
    EXPECT_THAT(Find({{}, {}, Term::Blank("b1"), {}}), ElementsAre(HasSubstr("_:b2 ")));
    EXPECT_THAT(Find({{}, {}, Term::Blank("b2"), {}}), IsEmpty());
    EXPECT_THAT(Find({{}, {}, Term::LangString("x \"y\"", "en"), Term::Iri(std::string(kDefaultGraph))}),
                ElementsAre(HasSubstr("#default>")));
    EXPECT_THAT(Find({Term::Literal("a"), {}, {}, {}}), IsEmpty()) << "no triple can have it";
    EXPECT_THAT(*store_->Graphs(), ElementsAre(Term::Iri(std::string(kDefaultGraph)), Term::Iri("urn:w:g"),
                                               Term::Iri("urn:w:h")));
    ASSERT_TRUE(store_->Apply({{kRemove, Quad("_b1", Term::Integer(7), "g")}}).ok());
    EXPECT_EQ(*store_->Size(), 3u);
    StopServer();
  }
}

TEST_F(ServerRedlandTest, AChangeIsMadeWholeOrRefusedWithItsReason) {
  StartServer();
  OpenStore();
  TermQuad reserved = Quad("a", Term::Integer(2));
  reserved.graph = Term::Iri(std::string(kRunsGraph));
  absl::Status refused = store_->Apply({{kAdd, Quad("a", Term::Integer(1))}, {kAdd, reserved}});
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("only the server writes"));
  EXPECT_EQ(*store_->Size(), 0u);

  Limits small;
  small.grpc_message_bytes = 1000;
  OpenStore(small);
  std::vector<QuadOperation> many;
  for (int i = 0; i < 100; ++i) many.push_back({kAdd, Quad("a", Term::Integer(i))});
  refused = store_->Apply(many);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("grpc_message_bytes is 1000"));
  EXPECT_EQ(*store_->Size(), 0u);

  auto cut = store_->FindAtMost({}, 0, "rasqal_quads");
  EXPECT_TRUE(cut.ok());
  MustTell(":a :p 1, 2, 3 .");
  cut = store_->FindAtMost({}, 2, "rasqal_quads");
  EXPECT_THAT(std::string(cut.status().message()), HasSubstr("rasqal_quads = 2"));
  EXPECT_EQ(store_->FindAtMost({}, 3, "rasqal_quads")->size(), 3u);
}

TEST_F(ServerRedlandTest, AServerThatComesBackMeanwhileGetsTheChangeOnce) {
  settings_.grpc_address = "127.0.0.1:0";
  StartServer();
  OpenStore();
  settings_.grpc_address = server_->grpc_address();  // the same one again
  ASSERT_TRUE(store_->Apply({{kAdd, Quad("a", Term::Integer(1))}}).ok());
  StopServer();
  EXPECT_EQ(store_->Find({}).status().code(), absl::StatusCode::kUnavailable) << "no short answer";
  std::thread restart([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    StartServer();
  });
  absl::Status status = store_->Apply({{kAdd, Quad("a", Term::Integer(2))}});
  restart.join();
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(*store_->Size(), 2u);
}

TEST_F(ServerRedlandTest, AServerThatNeverAnswersIsNotWaitedForLonger) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(fd, 8), 0);
  ASSERT_EQ(getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size), 0);
  Limits limits;
  limits.redland_answer_ms = 300;
  auto store = ClientStore::Open(absl::StrCat("127.0.0.1:", ntohs(address.sin_port)), "test", limits);
  EXPECT_EQ(store.status().code(), absl::StatusCode::kDeadlineExceeded) << store.status();
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("redland_answer_ms = 300"));
  close(fd);
}

TEST_F(ServerRedlandTest, NoServerIsOneClearLine) {
  auto store = ClientStore::Open("127.0.0.1:1", "test");
  EXPECT_EQ(store.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("no server answers at 127.0.0.1:1"));
}

}  // namespace
}  // namespace docent::server::test
