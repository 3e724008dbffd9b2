// The clock that a simulator moves: a file says the time.
#include "kb_server/clock/simulated_clock.h"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/date_time.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

class SimulatedClockTest : public testing::Test {
 protected:
  SimulatedClockTest()
      : path_(absl::StrCat(testing::TempDir(), "/simulated_clock_", getpid(), "_",
                           testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove(path_);
  }
  ~SimulatedClockTest() override { std::filesystem::remove(path_); }

  void Write(const std::string& text) const { std::ofstream(path_) << text; }
  void Open() {
    auto clock = SimulatedClock::Open(path_);
    ASSERT_TRUE(clock.ok()) << clock.status();
    clock_ = *std::move(clock);
  }
  std::string Time() const { return DateTimeTerm(clock_->Now()).lexical; }
  void ExpectSoon(const std::string& time) const {
    for (int i = 0; i < 10000 && Time() != time; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(Time(), time);
  }
  // Long enough for many looks at the file.
  void ExpectStill(const std::string& time) const {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(Time(), time);
  }

  const std::string path_;
  std::unique_ptr<SimulatedClock> clock_;
};

TEST_F(SimulatedClockTest, AFileThatIsAwayOrSaysNoTimeIsRefused) {
  absl::Status status = SimulatedClock::Open(path_).status();
  EXPECT_TRUE(absl::IsNotFound(status)) << status;
  EXPECT_TRUE(absl::StrContains(status.message(), path_)) << status;
  for (const char* text :
       {"", "\n", "noon", "2026-05-12", "2026-05-12T09:00:00", "2026-02-30T09:00:00Z", "1778576400",
        "10000-01-01T00:00:00Z", "292278-01-01T00:00:00Z", "1969-12-31T23:59:59Z"}) {
    Write(text);
    status = SimulatedClock::Open(path_).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << text << ": " << status;
    EXPECT_TRUE(absl::StrContains(status.message(), "2026-05-12T09:00:00Z")) << status;
  }
}

TEST_F(SimulatedClockTest, TimeStandsStillUntilTheFileSaysALaterOne) {
  Write("2026-05-12T09:00:00Z\n");
  Open();
  EXPECT_EQ(Time(), "2026-05-12T09:00:00Z");
  ExpectStill("2026-05-12T09:00:00Z");
  Write("2026-05-12T09:00:00.250Z");
  ExpectSoon("2026-05-12T09:00:00.25Z");
  Write("2026-05-12T13:00:00+02:00");
  ExpectSoon("2026-05-12T11:00:00Z");
}

TEST_F(SimulatedClockTest, AnEarlierTimeAnEmptyFileAndNoFileChangeNothing) {
  Write("2026-05-12T09:00:00Z");
  Open();
  for (const char* text : {"2026-05-12T08:59:59Z", "", "later", "2026-05-1"}) {
    Write(text);
    ExpectStill("2026-05-12T09:00:00Z");
  }
  std::filesystem::remove(path_);
  ExpectStill("2026-05-12T09:00:00Z");
  Write("2026-05-12T09:00:01Z");
  ExpectSoon("2026-05-12T09:00:01Z");
}

TEST_F(SimulatedClockTest, WhoeverWaitsIsToldOfEachMoveUntilItAsksNoLonger) {
  Write("2026-05-12T09:00:00Z");
  Open();
  std::atomic<int> moves = 0;
  clock_->OnMove([&moves] { ++moves; });
  EXPECT_EQ(moves, 1) << "at once: it may have moved before";
  Write("2026-05-12T09:00:01Z");
  for (int i = 0; i < 10000 && moves < 2; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(moves, 2);
  clock_->OnMove(nullptr);
  Write("2026-05-12T09:00:02Z");
  ExpectSoon("2026-05-12T09:00:02Z");
  EXPECT_EQ(moves, 2);
}

}  // namespace
}  // namespace docent::server
