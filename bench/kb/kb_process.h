// Time and memory of a process of `docent-bench kb`, measured by itself.
#ifndef DOCENT_BENCH_KB_KB_PROCESS_H_
#define DOCENT_BENCH_KB_KB_PROCESS_H_

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <fstream>
#include <string>
#include <thread>

namespace docent::bench {

inline double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// malloc may keep unused memory for some seconds.
inline size_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

// Without pages of program and library files.
inline size_t AnonymousBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    size_t kilobytes = 0;
    if (word == "RssAnon:" && status >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

// The value once it has been stable for three seconds; at most half a minute.
inline size_t SettledResidentBytes() {
  size_t resident = ResidentBytes();
  for (int second = 0, still = 0; second < 30 && still < 3; ++second) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const size_t now = ResidentBytes();
    still = now == resident ? still + 1 : 0;
    resident = now;
  }
  return resident;
}

}  // namespace docent::bench

#endif  // DOCENT_BENCH_KB_KB_PROCESS_H_
