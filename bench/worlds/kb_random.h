// Pseudo-random numbers from a seed, the same on every machine (splitmix64, Steele et al., OOPSLA 2014). One
// thread.
#ifndef DOCENT_BENCH_WORLDS_KB_RANDOM_H_
#define DOCENT_BENCH_WORLDS_KB_RANDOM_H_

#include <cstddef>
#include <cstdint>

namespace docent::bench {

class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  // 0 <= result < n; n > 0 and far below 2^64.
  size_t Below(size_t n) {
    uint64_t z = state_ += 0x9E3779B97F4A7C15;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return static_cast<size_t>((z ^ (z >> 31)) % n);
  }

 private:
  uint64_t state_;
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_KB_RANDOM_H_
