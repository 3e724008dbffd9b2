// Lexical check of literals against their datatype (XML Schema 1.1 part 2). Pure functions.
#ifndef DOCENT_REASONER_SHAPES_DATATYPE_CHECK_H_
#define DOCENT_REASONER_SHAPES_DATATYPE_CHECK_H_

#include <optional>
#include <string_view>

namespace docent::shapes {

// nullopt: not a known datatype of XML Schema.
std::optional<bool> IsValidLexicalForm(std::string_view text, std::string_view datatype);

// True if `datatype` is `base`, or derived from it by XML Schema part 2 (xsd:int from xsd:integer from xsd:decimal).
bool IsDerivedDatatype(std::string_view datatype, std::string_view base);

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_DATATYPE_CHECK_H_
