#include "kb_server/clock/simulated_clock.h"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/rdf/date_time.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

constexpr absl::Duration kPoll = absl::Milliseconds(1);
constexpr size_t kLongestTime = 64;  // bytes of the file that are looked at
constexpr TimeMicros kYear10000 = 253'402'300'800'000'000;

absl::StatusOr<TimeMicros> ReadTime(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) {
    return absl::NotFoundError(absl::StrCat(
        "the simulated clock ", path, " cannot be read; write a time into it, such as 2026-05-12T09:00:00Z"));
  }
  char text[kLongestTime];
  const ssize_t length = read(file, text, sizeof text);
  close(file);
  const std::string written(absl::StripAsciiWhitespace({text, static_cast<size_t>(length < 0 ? 0 : length)}));
  const TimeMicros time_us = MicrosOfDateTime(written);
  if (time_us > 0 && time_us < kYear10000) return time_us;
  return absl::InvalidArgumentError(
      absl::StrCat("the simulated clock ", path, " says \"", written,
                   "\", which is no time; write one such as 2026-05-12T09:00:00Z into it"));
}

}  // namespace

absl::StatusOr<std::unique_ptr<SimulatedClock>> SimulatedClock::Open(const std::string& path) {
  const absl::StatusOr<TimeMicros> now = ReadTime(path);
  if (!now.ok()) return now.status();
  std::unique_ptr<SimulatedClock> clock(new SimulatedClock(path, *now));
  clock->thread_ = std::thread([clock = clock.get()] {
    pthread_setname_np(pthread_self(), "sim clock");
    clock->Run();
  });
  return clock;
}

SimulatedClock::~SimulatedClock() {
  {
    absl::MutexLock lock(&mutex_);
    stopped_ = true;
  }
  thread_.join();
}

void SimulatedClock::OnMove(std::function<void()> moved) {
  absl::MutexLock lock(&mutex_);
  moved_ = std::move(moved);
  if (moved_) moved_();
}

void SimulatedClock::Run() {
  while (true) {
    {
      absl::MutexLock lock(&mutex_);
      mutex_.AwaitWithTimeout(absl::Condition(&stopped_), kPoll);
      if (stopped_) return;
    }
    Look();
  }
}

// A file that is being written may be empty or cut for a moment: only what is wrong twice is told.
void SimulatedClock::Look() {
  const absl::StatusOr<TimeMicros> time = ReadTime(path_);
  if (!time.ok()) {
    const std::string fault(time.status().message());
    if (fault == fault_) return;
    absl::SleepFor(kPoll);
    if (ReadTime(path_).ok()) return;
    fault_ = fault;
    spdlog::warn("{}; time stands still at {}", fault, DateTimeTerm(Now()).lexical);
    return;
  }
  fault_.clear();
  if (*time <= Now()) return;
  now_.Set(*time);
  absl::MutexLock lock(&mutex_);
  if (moved_) moved_();
}

}  // namespace docent::server
