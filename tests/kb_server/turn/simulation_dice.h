// Random numbers of the simulation, which begin again at each part of it: what is left out changes nothing of the other parts.
//
// The environment says what is played: DOCENT_SIMULATION_SEED=17 one seed; DOCENT_SIMULATION_STEPS=0-12,15 only these steps;
// DOCENT_SIMULATION_WITHOUT=retry,timeout documents and worlds without these; DOCENT_SIMULATION_ROBOTS=1 fewer robots.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_SIMULATION_DICE_H_
#define DOCENT_TESTS_KB_SERVER_TURN_SIMULATION_DICE_H_

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"

namespace docent::server::test {

inline std::string FromEnvironment(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? "" : text;
}
inline int NumberFromEnvironment(const char* name, int otherwise) {
  int value = 0;
  return absl::SimpleAtoi(FromEnvironment(name), &value) ? value : otherwise;
}

class Dice {
 public:
  explicit Dice(uint32_t seed) : seed_(seed) {
    for (const std::string& part : Parts("DOCENT_SIMULATION_WITHOUT")) without_.insert(part);
    for (const std::string& range : Parts("DOCENT_SIMULATION_STEPS")) {
      const std::vector<std::string> ends = absl::StrSplit(range, '-');
      int first = 0, last = 0;
      if (absl::SimpleAtoi(ends.front(), &first) && absl::SimpleAtoi(ends.back(), &last))
        steps_.emplace_back(first, last);
    }
    Begin(0);
  }

  // The numbers that follow are those of this part of the simulation, whatever was drawn before.
  void Begin(uint32_t part) {
    std::seed_seq seeds{seed_, part};
    random_.seed(seeds);
  }
  int Below(int bound) { return static_cast<int>(random_() % static_cast<uint32_t>(bound)); }
  bool OneIn(int n) { return Below(n) == 0; }
  // The same, of a feature that may be left out.
  bool OneIn(int n, const char* feature) { return OneIn(n) && !without_.contains(feature); }
  bool Plays(int step) const {
    return steps_.empty() || std::any_of(steps_.begin(), steps_.end(), [step](const auto& range) {
             return range.first <= step && step <= range.second;
           });
  }

 private:
  static std::vector<std::string> Parts(const char* name) {
    return absl::StrSplit(FromEnvironment(name), ',', absl::SkipEmpty());
  }

  const uint32_t seed_;
  std::mt19937 random_;
  std::set<std::string> without_;
  std::vector<std::pair<int, int>> steps_;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_SIMULATION_DICE_H_
