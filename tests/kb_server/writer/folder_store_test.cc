#include "kb_server/writer/folder_store.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "graph/log/sqlite_log.h"
#include "graph/rdf/vocabulary.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

constexpr QuadOperation::Kind kAdd = QuadOperation::Kind::kAdd;

class FolderStoreTest : public ServerWorkflowTest {
 protected:
  std::unique_ptr<FolderStore> Open(bool make_new = false, const Limits& limits = {}) {
    auto store = FolderStore::Open(folder_ / "data", make_new, &clock_, limits);
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }
  std::string Refusal(const std::string& folder, bool make_new = false) {
    auto store = FolderStore::Open(folder, make_new, &clock_);
    EXPECT_FALSE(store.ok());
    return std::string(store.status().message());
  }
  static bool Has(FolderStore* store, const TermQuad& quad) {
    auto stream = store->Find({quad.subject, quad.predicate, quad.object, quad.graph});
    TermQuad found;
    return stream.ok() && (*stream)->Next(&found);
  }
  static TermQuad Default(TermQuad quad) {
    quad.graph = Term::Iri(std::string(kDefaultGraph));
    return quad;
  }
  uint64_t Head() {
    auto log = log::SqliteLog::Open(folder_ / "data");
    EXPECT_TRUE(log.ok()) << log.status();
    return (*log)->Head()->offset;
  }
};

TEST_F(FolderStoreTest, WhatIsWrittenIsThereForTheServerAndTheOtherWayRound) {
  const TermQuad fact = Default(Fact("John", "docent:isAt", "Hall"));
  {
    auto store = Open(/*make_new=*/true);
    ASSERT_TRUE(store->Apply({{kAdd, fact}}).ok());
    EXPECT_TRUE(Has(store.get(), fact));
    EXPECT_EQ(*store->Size(), 1u);
  }
  StartServer();
  EXPECT_TRUE(Ask(":John <https://w3id.org/docent#isAt> :Hall"));
  MustTell(":Ann docent:isAt :Hall .");
  EXPECT_THAT(Refusal(folder_ / "data"), HasSubstr("in use by process"));
  StopServer();
  auto store = Open();
  EXPECT_TRUE(Has(store.get(), Default(Fact("Ann", "docent:isAt", "Hall"))));
  EXPECT_THAT(Refusal(folder_ / "data"), HasSubstr("in use by process"));
}

TEST_F(FolderStoreTest, ReadingWritesNothingNotEvenWhatIsDue) {
  settings_.clock = &clock_;
  StartServer();
  v1::AssertRequest request = Turtle(":John :p :Hall .");
  request.set_lifetime_ms(1000);
  ASSERT_TRUE(Assert(request).ok());
  StopServer();
  const uint64_t head = Head();
  clock_.Advance(std::chrono::seconds(10));
  {
    auto store = Open();
    EXPECT_EQ(*store->Size(), 1u);
    EXPECT_EQ(store->Graphs()->size(), 1u);
  }
  EXPECT_EQ(Head(), head);
  {
    auto store = Open();
    ASSERT_TRUE(store->Apply({{kAdd, Default(Fact("a", "p", "b"))}}).ok());
    EXPECT_EQ(*store->Size(), 1u) << "the write is a turn: what was due has gone";
  }
}

TEST_F(FolderStoreTest, AChangeIsATurnRulesInferAndRunsMove) {
  StartServer();
  SetUpGreeting();
  v1::StartReply started;
  ASSERT_TRUE(StartRun("Greeting", &started).ok());
  StopServer();
  const uint64_t head = Head();
  {
    auto store = Open();
    ASSERT_TRUE(store
                    ->Apply({{kAdd, Default(Fact("John", "docent:isAt", "Hall"))},
                             {kAdd, Default(Fact("R1", "docent:isAt", "Hall"))}})
                    .ok());
  }
  EXPECT_EQ(Head(), head + 1) << "one change, one record";
  StartServer();  // replays it, and would refuse a record whose decisions are others
  EXPECT_TRUE(Ask("GRAPH <https://w3id.org/docent#inferred> { :John ?p :R1 }"));
  EXPECT_NE(FindNode(GetRun(started.run()), "Hello")->state(), "waiting");
}

TEST_F(FolderStoreTest, SnapshotsCutTheReplayShortAndTheLogIsTrimmed) {
  Limits limits;
  limits.snapshot_records = 10;
  limits.log_bytes_kept = 1;
  std::vector<TermQuad> facts;
  for (int i = 0; i < 60; ++i) facts.push_back(Default(Fact(absl::StrCat("s", i), "p", "o")));
  for (size_t i = 0; i < facts.size(); ++i) {  // each by a program of its own, as with rdfproc
    auto store = Open(/*make_new=*/i == 0, limits);
    ASSERT_TRUE(store);
    ASSERT_TRUE(store->Apply({{kAdd, facts[i]}}).ok());
  }
  {
    auto log = log::SqliteLog::Open(folder_ / "data");
    ASSERT_TRUE(log.ok()) << log.status();
    EXPECT_GT(*(*log)->First(), 1u) << "trimmed";
    EXPECT_FALSE((*log)->SnapshotOffsets()->empty());
  }
  auto store = Open(/*make_new=*/false, limits);
  for (const TermQuad& fact : facts) EXPECT_TRUE(Has(store.get(), fact)) << fact.subject.lexical;
  EXPECT_EQ(*store->Size(), facts.size());
}

TEST_F(FolderStoreTest, AMistypedFolderIsLeftAsItIs) {
  std::filesystem::create_directories(folder_ / "other");
  EXPECT_THAT(Refusal(folder_ / "other"), HasSubstr("there is no data folder"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "other"));
}

TEST_F(FolderStoreTest, RefusalsAreOneClearLine) {
  EXPECT_THAT(Refusal(folder_ / "none"), HasSubstr("there is no data folder"));
  {
    auto store = Open(/*make_new=*/true);
    TermQuad reserved = Fact("a", "p", "b");
    reserved.graph = Term::Iri(std::string(kInferredGraph));
    absl::Status status = store->Apply({{kAdd, Default(Fact("a", "p", "c"))}, {kAdd, reserved}});
    EXPECT_THAT(std::string(status.message()), HasSubstr("add[1]: graph:"));
    EXPECT_EQ(*store->Size(), 0u);
    ASSERT_TRUE(store->Apply({{kAdd, Default(Fact("a", "p", "c"))}}).ok());
  }
  EXPECT_THAT(Refusal(folder_ / "data", /*make_new=*/true), HasSubstr("holds 1 records"));
}

}  // namespace
}  // namespace docent::server::test
