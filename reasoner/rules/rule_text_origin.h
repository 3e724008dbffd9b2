// Origin of the text of a rule set.
#ifndef DOCENT_REASONER_RULES_RULE_TEXT_ORIGIN_H_
#define DOCENT_REASONER_RULES_RULE_TEXT_ORIGIN_H_

#include <cstdint>

namespace docent::rules {

enum class RuleTextOrigin : uint8_t {
  kNew,       // a user puts it now
  kAccepted,  // it is in force, or from the log: a text accepted by an older version stays accepted
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_TEXT_ORIGIN_H_
