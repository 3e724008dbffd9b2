#include "kb_server/replay/play_outlook.h"

#include <algorithm>
#include <vector>

namespace docent::server {
namespace {

// Whether a fact may change what is waited for.
class Concern {
 public:
  explicit Concern(const Stages& stages) : stages_(stages), armed_(stages.conditions.Requests()) {}

  bool operator()(const TermQuad& fact) const {
    return std::any_of(armed_.begin(), armed_.end(), [&](const engine::ConditionRequest& request) {
      return stages_.conditions.MayChange(request.handle, fact);
    });
  }

 private:
  const Stages& stages_;
  const std::vector<engine::ConditionRequest> armed_;
};

std::optional<TimeMicros> EndOfLifetime(const Stages& stages, const Concern& concerns) {
  const Dictionary& dictionary = stages.dictionary;
  for (const auto& [end_us, quad] : stages.applier.Lifetimes()) {  // the first in front
    if (concerns({dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                  dictionary.Decode(quad.object), dictionary.Decode(quad.graph)}))
      return end_us;
  }
  return std::nullopt;
}

}  // namespace

std::optional<TimeMicros> GoesOnAt(const Stages& stages, const PlayedClock& clock) {
  const Concern concerns(stages);
  std::optional<TimeMicros> next;
  for (const std::optional<TimeMicros>& at :
       {stages.engine.NextDeadline(), stages.conditions.NextDeadline(), EndOfLifetime(stages, concerns),
        clock.NextChange(stages.dictionary, stages.writer.current(), concerns)}) {
    if (at) next = std::min(next.value_or(*at), *at);
  }
  return next;
}

}  // namespace docent::server
