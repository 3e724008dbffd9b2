// Numbers of runs in a replay of one of them (Engine::PlayInstead). Private to this folder. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_RUN_NUMBERS_H_
#define DOCENT_WORKFLOW_ENGINE_RUN_NUMBERS_H_

#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>

#include "workflow/engine/engine.h"

namespace docent::engine {

class RunNumbers {
 public:
  explicit RunNumbers(PlayedRun played)
      : played_(std::move(played)), reserved_(played_.nested.begin(), played_.nested.end()) {}

  const PlayedRun& played() const { return played_; }
  // Of the played run, what it begins with; of another one nothing changes.
  void Begin(uint64_t number, cawl::DocumentPtr* document, size_t* flow, TermBinding* variables) const;
  // Of a run that is nested in the played one.
  uint64_t Nested() { return taken_ < played_.nested.size() ? played_.nested[taken_++] : more_++; }
  // Of any other run.
  uint64_t Other(uint64_t* next) const {
    while (reserved_.contains(*next)) ++*next;
    return (*next)++;
  }

 private:
  // Of runs that the recorded one did not have: above those of all data folders.
  static constexpr uint64_t kMore = 1'000'000'000;

  const PlayedRun played_;
  const std::set<uint64_t> reserved_;
  size_t taken_ = 0;
  uint64_t more_ = kMore;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_RUN_NUMBERS_H_
