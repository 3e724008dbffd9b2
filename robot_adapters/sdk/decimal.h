// Numbers as facts: xsd:decimal in canonical form, so that they fit into the server's ids. Pure; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_DECIMAL_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_DECIMAL_H_

#include "graph/rdf/term.h"

namespace docent::robot {

// `value` rounded to `digits` (0..9) after the point, e.g. Decimal(1.25, 3) is "1.25", Decimal(2, 3) is "2.0"
// (XML Schema 1.0 Part 2, section 3.2.3.2). Requires a finite value below 10^9.
Term Decimal(double value, int digits);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_DECIMAL_H_
