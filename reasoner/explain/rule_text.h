// Text of a rule set in force, for reasoning beside the writer. Value; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_RULE_TEXT_H_
#define DOCENT_REASONER_EXPLAIN_RULE_TEXT_H_

#include <memory>
#include <string>

namespace docent::explain {

struct RuleText {
  std::string name;
  std::shared_ptr<const std::string> text;  // in the rule language (reasoner/rules/rule_parser.h)
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_RULE_TEXT_H_
