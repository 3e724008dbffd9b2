#include "robot_adapters/sdk/command_journal.h"

#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "gtest/gtest.h"

namespace docent::robot {
namespace {

class CommandJournalTest : public testing::Test {
 protected:
  CommandJournalTest() {
    folder_ = testing::TempDir() + "journal_" + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    path_ = folder_ + "/commands.journal";
  }
  std::unique_ptr<CommandJournal> Open(size_t remembered = CommandJournal::kCommandsRemembered) {
    auto journal = CommandJournal::Open(path_, &clock_, remembered);
    EXPECT_TRUE(journal.ok()) << journal.status();
    return journal.ok() ? *std::move(journal) : nullptr;
  }
  std::string Text() const {
    std::ostringstream out;
    out << std::ifstream(path_).rdbuf();
    return out.str();
  }
  void AppendText(const std::string& text) { std::ofstream(path_, std::ios::app) << text; }

  ManualClock clock_{1000};
  std::string folder_;
  std::string path_;
};

TEST_F(CommandJournalTest, FinishedCommandIsKnownAfterRestartWithItsResults) {
  const NamedTerms results = {{"page", Term::Iri("http://127.0.0.1/a")},
                              {"said", Term::Literal("tab\there\nand \\ there")},
                              {"count", Term::Integer(3)},
                              {"word", Term::LangString("Stand", "de")},
                              {"node", Term::Blank("b1")}};
  {
    auto journal = Open();
    ASSERT_TRUE(journal->Begin(CommandId("run/1"), "brief").ok());
    ASSERT_TRUE(journal->Finish(CommandId("run/1"), CommandOutcome::kSucceeded, "", results).ok());
  }
  auto entry = Open()->Find(CommandId("run/1"));
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->state, JournalEntry::State::kFinished);
  EXPECT_EQ(entry->outcome, CommandOutcome::kSucceeded);
  EXPECT_EQ(entry->operation, "brief");
  EXPECT_EQ(entry->results, results);
}

TEST_F(CommandJournalTest, UnfinishedCommandIsLostAfterRestart) {
  std::string first;
  {
    auto journal = Open();
    first = journal->incarnation();
    ASSERT_TRUE(journal->Begin(CommandId("run/1"), "drive").ok());
  }
  auto journal = Open();
  EXPECT_NE(journal->incarnation(), first);
  auto entry = journal->Find(CommandId("run/1"));
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->state, JournalEntry::State::kLost);
  EXPECT_EQ(entry->incarnation, first);
  EXPECT_TRUE(absl::IsAlreadyExists(journal->Begin(CommandId("run/1"), "drive")));
  EXPECT_TRUE(
      absl::IsFailedPrecondition(journal->Finish(CommandId("run/1"), CommandOutcome::kSucceeded, "", {})));
  EXPECT_NE(Text().find("lost\t1000\t"), std::string::npos);
}

TEST_F(CommandJournalTest, ALostCommandStaysLostUntilItIsForgotten) {
  ASSERT_TRUE(Open()->Begin(CommandId("run/1"), "drive").ok());
  Open();
  auto journal = Open(/*remembered=*/1);
  auto entry = journal->Find(CommandId("run/1"));
  ASSERT_TRUE(entry.has_value());
  EXPECT_EQ(entry->state, JournalEntry::State::kLost);
  ASSERT_TRUE(journal->Begin(CommandId("run/2"), "drive").ok());
  ASSERT_TRUE(journal->Finish(CommandId("run/2"), CommandOutcome::kSucceeded, "", {}).ok());
  EXPECT_FALSE(journal->Find(CommandId("run/1")).has_value());
  EXPECT_TRUE(journal->Find(CommandId("run/2")).has_value());
}

TEST_F(CommandJournalTest, IncarnationsAreCounted) {
  EXPECT_EQ(Open()->incarnation().substr(0, 2), "1-");
  EXPECT_EQ(Open()->incarnation().substr(0, 2), "2-");
  EXPECT_EQ(Open()->incarnation().substr(0, 2), "3-");
}

TEST_F(CommandJournalTest, HalfWrittenLastLineIsCutOff) {
  {
    auto journal = Open();
    ASSERT_TRUE(journal->Begin(CommandId("run/1"), "drive").ok());
    ASSERT_TRUE(journal->Finish(CommandId("run/1"), CommandOutcome::kFailed, "wheel stuck", {}).ok());
  }
  AppendText("begun\t2000\t1-00\trun/2");
  auto journal = Open();
  EXPECT_FALSE(journal->Find(CommandId("run/2")).has_value());
  EXPECT_EQ(journal->Find(CommandId("run/1"))->message, "wheel stuck");
  EXPECT_TRUE(journal->Begin(CommandId("run/2"), "drive").ok());
}

TEST_F(CommandJournalTest, DamagedLineIsAnErrorThatNamesIt) {
  Open();
  AppendText("bogus\tline\n");
  auto journal = CommandJournal::Open(path_, &clock_);
  ASSERT_TRUE(absl::IsDataLoss(journal.status())) << journal.status();
  EXPECT_NE(journal.status().message().find(path_ + ":2:"), absl::string_view::npos) << journal.status();
}

TEST_F(CommandJournalTest, SecondAdapterOnTheSameJournalIsRefused) {
  auto journal = Open();
  EXPECT_TRUE(absl::IsFailedPrecondition(CommandJournal::Open(path_, &clock_).status()));
}

TEST_F(CommandJournalTest, ForgetsTheOldestBeyondItsLimitAndShortensTheFile) {
  constexpr size_t kRemembered = 3;
  {
    auto journal = Open(kRemembered);
    for (int i = 0; i < 20; ++i) {
      CommandId id("run/" + std::to_string(i));
      ASSERT_TRUE(journal->Begin(id, "drive").ok());
      ASSERT_TRUE(journal->Finish(id, CommandOutcome::kSucceeded, "", {}).ok());
    }
    EXPECT_TRUE(journal->Find(CommandId("run/17")).has_value());
    EXPECT_FALSE(journal->Find(CommandId("run/16")).has_value());
  }
  const size_t before = Text().size();
  auto journal = Open(kRemembered);
  EXPECT_LT(Text().size(), before / 2);
  EXPECT_TRUE(journal->Find(CommandId("run/19")).has_value());
  EXPECT_FALSE(journal->Find(CommandId("run/16")).has_value());
  EXPECT_EQ(journal->incarnation().substr(0, 2), "2-");
  journal.reset();
  EXPECT_EQ(Open(kRemembered)->Find(CommandId("run/19"))->state, JournalEntry::State::kFinished);
}

TEST_F(CommandJournalTest, TheFileIsShortenedBeyondEightLinesForEachThatIsRemembered) {
  constexpr size_t kRemembered = 3;
  const auto lines = [this] {
    const std::string text = Text();
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
  };
  for (size_t i = 1; i <= 8 * kRemembered; ++i) {
    Open(kRemembered).reset();  // adds a line
    EXPECT_EQ(lines(), i);
  }
  Open(kRemembered).reset();
  EXPECT_EQ(lines(), 2u);
}

TEST_F(CommandJournalTest, EmptyPathKeepsCommandsInMemoryOnly) {
  auto journal = CommandJournal::Open("", &clock_);
  ASSERT_TRUE(journal.ok());
  EXPECT_TRUE((*journal)->Begin(CommandId("a"), "drive").ok());
  EXPECT_TRUE((*journal)->Find(CommandId("a")).has_value());
}

TEST_F(CommandJournalTest, FullDiskIsReportedAndNothingIsRecorded) {
  auto journal = Open();
  ASSERT_TRUE(journal->Begin(CommandId("a"), "drive").ok());
  const std::string before = Text();
  rlimit old_limit;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  signal(SIGXFSZ, SIG_IGN);
  rlimit limit = old_limit;
  limit.rlim_cur = before.size() + 10;  // the next line is cut in the middle
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  absl::Status refused = journal->Begin(CommandId("b"), "drive");
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  EXPECT_FALSE(refused.ok());
  EXPECT_EQ(Text(), before);
  EXPECT_FALSE(journal->Find(CommandId("b")).has_value());
  EXPECT_TRUE(journal->Begin(CommandId("b"), "drive").ok());
}

TEST_F(CommandJournalTest, UnwritableFolderIsAnErrorThatNamesTheFile) {
  std::ofstream(folder_) << "a file where a folder should be";
  auto journal = CommandJournal::Open(path_, &clock_);
  ASSERT_FALSE(journal.ok());
  EXPECT_NE(journal.status().message().find(path_), absl::string_view::npos) << journal.status();
}

}  // namespace
}  // namespace docent::robot
