// Where the text of a rule set comes from.
#ifndef DOCENT_REASONER_RULES_RULE_TEXT_ORIGIN_H_
#define DOCENT_REASONER_RULES_RULE_TEXT_ORIGIN_H_

#include <cstdint>

namespace docent::rules {

enum class RuleTextOrigin : uint8_t {
  kNew,       // somebody gives it now
  kAccepted,  // it is in force, or the log has it: what an older version took stays accepted
};

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_TEXT_ORIGIN_H_
