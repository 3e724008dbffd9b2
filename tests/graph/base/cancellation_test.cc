#include "graph/base/cancellation.h"

#include <gtest/gtest.h>

#include <thread>

namespace docent {
namespace {

TEST(CancellationTest, CancelIsSeenAtOnce) {
  Cancellation cancellation;
  EXPECT_TRUE(cancellation.Check().ok());
  std::thread([&] { cancellation.Cancel(); }).join();
  EXPECT_EQ(cancellation.Check().code(), absl::StatusCode::kCancelled);
}

TEST(CancellationTest, WithoutTimeoutItNeverExpires) {
  Cancellation cancellation;
  for (int i = 0; i < 5000; ++i) ASSERT_TRUE(cancellation.Check().ok());
}

TEST(CancellationTest, DeadlineNamesTheLimitAndStays) {
  Cancellation cancellation(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  absl::Status status;
  for (int i = 0; i < 1024 && status.ok(); ++i) status = cancellation.Check();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_NE(status.message().find("query_timeout_ms = 1"), absl::string_view::npos);
  EXPECT_EQ(cancellation.Check().code(), absl::StatusCode::kDeadlineExceeded);
}

TEST(CancellationTest, StepsAreAllowedUpToTheLimit) {
  Cancellation any;
  any.Spend(uint64_t{1} << 60);
  EXPECT_TRUE(any.CheckNow().ok()) << "no limit was said";

  Cancellation limited;
  limited.AllowSteps(10);
  limited.Spend(10);
  EXPECT_TRUE(limited.Check().ok());
  limited.Spend(1);
  const absl::Status status = limited.Check();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(status.message().find("after 10 steps, what the limits steps_per_turn and steps_per_fact allow"),
            std::string::npos)
      << status;
  limited.AllowSteps(10);
  limited.Spend(10);
  EXPECT_TRUE(limited.Check().ok()) << "they are counted anew";
}

}  // namespace
}  // namespace docent
