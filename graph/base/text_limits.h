// Limits of the texts that clients, operators and robots give, and of what lists show of them. As in limits.h, an error at a
// limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_TEXT_LIMITS_H_
#define DOCENT_GRAPH_BASE_TEXT_LIMITS_H_

#include <cstddef>

namespace docent {

struct TextLimits {
  size_t request_id_bytes = 256;  // request_id of any call
  size_t message_bytes = 4096;    // reason of an operator and message of a robot; what is longer is cut
  size_t label_bytes = 1024;  // label of a robot, and each name in its description; longer ones are refused
  size_t listed_text_bytes =
      4096;  // text of one value, reason or message in a list; a longer one is shown cut
  size_t shown_text_bytes = 1u << 20;  // the same where one run or robot is asked for
  size_t listed_bytes =
      8u << 20;  // texts of one page of a list, and of one run; beyond, they are shown shorter
};

inline constexpr TextLimits kTextLimits;

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_TEXT_LIMITS_H_
