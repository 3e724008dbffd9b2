#include "robot_adapters/sdk/decimal.h"

#include <string>

#include "absl/strings/str_format.h"
#include "graph/rdf/vocabulary.h"

namespace docent::robot {

Term Decimal(double value, int digits) {
  std::string text = absl::StrFormat("%.*f", digits, value);
  if (text.find('.') == std::string::npos) text += ".0";
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  if (text == "-0.0") text = "0.0";
  return Term::Literal(std::move(text), std::string(kXsdDecimal));
}

}  // namespace docent::robot
