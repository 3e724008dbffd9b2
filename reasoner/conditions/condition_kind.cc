#include "reasoner/conditions/condition_kind.h"

#include <utility>

namespace docent::conditions {

ConditionKind::ConditionKind(matching::Body& b, Keys k, const std::vector<int16_t>& p, WatchIndexes& i)
    : body(b),
      indexes(i),
      has_keys(!k.empty()),
      keys(std::move(k)),
      parameters(p.begin(), p.end()),
      seed(b.columns().size()) {
  const auto is_parameter = [this](int16_t column) {
    return std::find(parameters.begin(), parameters.end(), column) != parameters.end();
  };
  for (int16_t column = 0; column < static_cast<int16_t>(seed.size()); ++column) {
    if (!is_parameter(column)) open.push_back(column);
  }
  const std::vector<matching::Trigger>& triggers = body.triggers();
  const bool constant = std::any_of(triggers.begin(), triggers.end(), [&](const matching::Trigger& t) {
    return t.required && (!t.match.constants.subject.IsNone() || !t.match.constants.object.IsNone() ||
                          is_parameter(t.columns[0]) || is_parameter(t.columns[2]));
  });
  for (uint32_t at = 0; at < triggers.size(); ++at) {
    const matching::Trigger& trigger = triggers[at];
    Gifts& given = gifts.emplace_back();
    for (uint8_t word = 0; word < 4; ++word) {
      const int16_t column = trigger.columns[word];
      if (column == matching::Trigger::kNoColumn || is_parameter(column)) continue;
      const matching::Body::Column& of = body.columns()[static_cast<size_t>(column)];
      if (has_keys ? of.certain : of.seedable) given.push_back({word, column});
    }
    if (given.empty() && !constant) whole |= 1u << std::min(at, 31u);
    const auto detail = static_cast<uint16_t>(std::min<uint32_t>(at, WatchIndexes::kSomeTrigger));
    if (RisesOnAdd(trigger.polarity)) breakers.push_back({&trigger, false, detail});
    if (RisesOnRemove(trigger.polarity)) breakers.push_back({&trigger, true, detail});
  }
}

}  // namespace docent::conditions
