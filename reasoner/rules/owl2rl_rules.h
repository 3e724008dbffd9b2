// The text of the rule set `owl2rl`. Private to this folder; pure.
#ifndef DOCENT_REASONER_RULES_OWL2RL_RULES_H_
#define DOCENT_REASONER_RULES_OWL2RL_RULES_H_

#include <string>

namespace docent::rules {

std::string Owl2RlRules();

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_OWL2RL_RULES_H_
