// What the processes of `docent-bench kb` measure of themselves.
#ifndef DOCENT_BENCH_KB_PROCESS_H_
#define DOCENT_BENCH_KB_PROCESS_H_

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <fstream>

namespace docent::bench {

inline double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline size_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  size_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace docent::bench

#endif  // DOCENT_BENCH_KB_PROCESS_H_
