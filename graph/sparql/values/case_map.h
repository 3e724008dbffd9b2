// Upper and lower case of UTF-8 text: Unicode's full case mapping (XPath and XQuery Functions sections 5.4.7
// and 5.4.8) by ICU. It is independent of language and of the process's locale. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_CASE_MAP_H_
#define DOCENT_GRAPH_SPARQL_VALUES_CASE_MAP_H_

#include <string>
#include <string_view>

namespace docent::sparql {

std::string UpperCase(std::string_view text);  // may be longer: "ß" gives "SS"
std::string LowerCase(std::string_view text);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_CASE_MAP_H_
