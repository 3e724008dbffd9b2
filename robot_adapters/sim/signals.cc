#include "robot_adapters/sim/signals.h"

#include <signal.h>
#include <time.h>

namespace docent::robot {
namespace {

sigset_t OurSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (int number : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&signals, number);
  return signals;
}

}  // namespace

void BlockSignals() {
  const sigset_t signals = OurSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

Signal WaitForSignal(std::chrono::milliseconds timeout) {
  const sigset_t signals = OurSignals();
  timespec wait;
  wait.tv_sec = static_cast<time_t>(timeout.count() / 1000);
  wait.tv_nsec = static_cast<long>(timeout.count() % 1000) * 1'000'000;
  const int number = sigtimedwait(&signals, nullptr, &wait);
  return number < 0 ? Signal::kNone : number == SIGUSR1 ? Signal::kReport : Signal::kEnd;
}

}  // namespace docent::robot
