#include "graph/base/pace.h"

#include <sys/resource.h>
#include <time.h>

#include <gtest/gtest.h>

#include <chrono>

namespace docent {
namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

nanoseconds CpuOfThread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + nanoseconds(time.tv_nsec);
}

// Number of voluntary sleeps of the thread.
long Sleeps() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

// Some 20 ms of work in small pieces.
void Work(Pace* pace) {
  const nanoseconds end = CpuOfThread() + std::chrono::milliseconds(20);
  while (CpuOfThread() < end) pace->Rest();
}

TEST(PaceTest, WorkTakesAThirdOfACoreAtMost) {
  Pace pace;
  const steady_clock::time_point start = steady_clock::now();
  const nanoseconds cpu = CpuOfThread();
  Work(&pace);
  // No rest follows the last stretch, and after a long interruption a stretch rests for less.
  EXPECT_GT(steady_clock::now() - start, 2 * (CpuOfThread() - cpu));
}

TEST(PaceTest, WhoIsWaitedForDoesNotRest) {
  Pace pace;
  pace.Hurry();
  const long before = Sleeps();
  Work(&pace);
  EXPECT_EQ(Sleeps(), before);
}

}  // namespace
}  // namespace docent
