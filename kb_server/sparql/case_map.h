// Upper and lower case of UTF-8 text by code point (Unicode simple case mapping of Latin, Greek and Cyrillic
// letters; other letters stay). It does not depend on the process's locale, so that a replay gives the same.
// Pure functions.
#ifndef DOCENT_KB_SERVER_SPARQL_CASE_MAP_H_
#define DOCENT_KB_SERVER_SPARQL_CASE_MAP_H_

#include <string>
#include <string_view>

namespace docent::sparql {

std::string UpperCase(std::string_view text);
std::string LowerCase(std::string_view text);

}  // namespace docent::sparql

#endif  // DOCENT_KB_SERVER_SPARQL_CASE_MAP_H_
