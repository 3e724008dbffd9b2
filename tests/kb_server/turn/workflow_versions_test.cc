// The texts that were deployed under a name.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "kb_server/door/workflow_removal.h"
#include "tests/kb_server/turn/turn_fixture.h"

namespace docent::server {
namespace {

using test::Put;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class WorkflowVersionsTest : public test::TurnTest {
 protected:
  static std::string Text(const std::string& version) {
    return absl::StrCat("<CAWL name=\"Go\" version=\"", version,
                        "\"><flow name=\"F\"><source name=\"s\"/><node name=\"N\"/><sink name=\"e\"/>"
                        "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/></flow></CAWL>");
  }
  void Deploy(const std::string& version, const std::string& file = "go.cawl.xml") {
    Turn(Put(Document::Kind::kCawl, file, Text(version)));
  }
  static WriteBatch Act(const std::string& what, const std::string& name = "Go") {
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, name, what});
    return batch;
  }
  DocumentVersionsPtr Versions() const {
    return stages_->documents.versions().Find({Document::Kind::kCawl, "Go"});
  }
  // "number version revision", and "live" behind the last that is.
  std::vector<std::string> Shown() const {
    std::vector<std::string> shown;
    const DocumentVersionsPtr versions = Versions();
    if (versions == nullptr) return shown;
    for (const DocumentVersionPtr& v : versions->kept)
      shown.push_back(absl::StrCat(v->number, " ", v->own_version, " ", v->revision.value()));
    if (versions->live) shown.back() += " live";
    return shown;
  }
};

TEST_F(WorkflowVersionsTest, EachTextThatDiffersIsAVersion) {
  Deploy("a");
  Deploy("a", "another_file.xml");
  Deploy("b");
  Deploy("a");
  EXPECT_THAT(Shown(), ElementsAre("1 a 1", "2 b 3", "3 a 4 live"));
  EXPECT_EQ(Versions()->kept[0]->text, Text("a"));
  Restart();
  EXPECT_THAT(Shown(), ElementsAre("1 a 1", "2 b 3", "3 a 4 live"));
}

TEST_F(WorkflowVersionsTest, NumbersGoOnAfterAnUndeployment) {
  Deploy("a");
  Turn(Act(""));
  EXPECT_THAT(Shown(), ElementsAre("1 a 1"));
  Restart();
  EXPECT_THAT(Shown(), ElementsAre("1 a 1"));
  Deploy("b");
  EXPECT_THAT(Shown(), ElementsAre("1 a 1", "2 b 3 live"));
}

// Two people deploy at once: the second one does not take back what they have not seen.
TEST_F(WorkflowVersionsTest, AnotherVersionThanTheExpectedOneIsNotReplaced) {
  const auto deploy = [&](const std::string& version, uint32_t replaces) {
    WriteBatch batch = Put(Document::Kind::kCawl, "go", Text(version));
    batch.documents.back().replaces = replaces;
    batch.time_us = now_us_ += 1000;
    const auto outcome = RunTurn(stages_.get(), batch, head_ + 1);
    if (outcome.ok()) ++head_;
    return outcome.status();
  };
  const absl::Status first = deploy("a", 1);
  EXPECT_EQ(first.code(), absl::StatusCode::kAborted);
  EXPECT_THAT(std::string(first.message()), HasSubstr("of workflow Go, none is deployed and not version 1"));
  EXPECT_TRUE(deploy("a", 0).ok());
  EXPECT_EQ(deploy("b", 0).code(), absl::StatusCode::kAborted);
  EXPECT_TRUE(deploy("b", 1).ok());
  const absl::Status crossed = deploy("c", 1);
  EXPECT_EQ(crossed.code(), absl::StatusCode::kAborted);
  EXPECT_THAT(std::string(crossed.message()), HasSubstr("version 2 is deployed and not version 1"));
  EXPECT_EQ(Versions()->newest().own_version, "b");
  Turn(Act(""));
  EXPECT_TRUE(deploy("c", 0).ok());
}

TEST_F(WorkflowVersionsTest, ATurnThatIsRefusedMakesNone) {
  Deploy("a");
  for (WriteBatch bad :
       {Put(Document::Kind::kCawl, "go", Text("b")), Act(kRemovesRuns), Act(kRemovesStarts)}) {
    bad.documents.push_back({Document::Kind::kRules, Document::Action::kRemove, "none", ""});
    bad.time_us = now_us_ += 1000;
    EXPECT_FALSE(RunTurn(stages_.get(), bad, head_ + 1).ok());
    EXPECT_THAT(Shown(), ElementsAre("1 a 1 live"));
    EXPECT_TRUE(stages_->engine.IsEnabled("Go"));
  }
}

TEST_F(WorkflowVersionsTest, AnUnknownNameIsRefusedWithTheNearest) {
  Turn(Put(Document::Kind::kCawl, "guide", [] {
    std::string text = Text("a");
    return text.replace(text.find("Go"), 2, "Guide");
  }()));
  for (const char* what : {"", kRemovesRuns, kRemovesDisablement, kRemovesStarts}) {
    WriteBatch batch = Act(what, "Gide");
    batch.time_us = now_us_ += 1000;
    const auto refused = RunTurn(stages_.get(), batch, head_ + 1);
    EXPECT_TRUE(absl::IsNotFound(refused.status()));
    EXPECT_THAT(std::string(refused.status().message()), HasSubstr("did you mean Guide?"));
  }
}

TEST_F(WorkflowVersionsTest, TheCatalogTellsOfThem) {
  Deploy("a");
  Turn(Act(kRemovesStarts));
  const auto catalog = stages_->documents.MakeCatalog(stages_->engine);
  EXPECT_TRUE(catalog->disabled_workflows.contains("Go"));
  EXPECT_NE(catalog->versions.Find({Document::Kind::kCawl, "Go"}), nullptr);
  EXPECT_EQ(Count("docent:disabled"), 1u);
  Turn(Act(kRemovesDisablement));
  EXPECT_EQ(Count("docent:disabled"), 0u);
  Turn(Act(""));
  EXPECT_EQ(Count("docent:versionNumber"), 0u);
}

}  // namespace
}  // namespace docent::server
