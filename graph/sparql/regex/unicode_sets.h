// Character sets with names in XPath's regular expressions: general categories and blocks of the Unicode
// Character Database (in ICU's version), the multi-character escapes of XML Schema, and case variants. The
// tables are made at first use and never change. Any thread.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_UNICODE_SETS_H_
#define DOCENT_GRAPH_SPARQL_REGEX_UNICODE_SETS_H_

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "graph/sparql/regex/character_set.h"

namespace docent::sparql {

using CharacterSetPtr = std::shared_ptr<const CharacterSet>;

// \p{L}, \p{Lu}, …: the categories in XSD 1.1 part 2 appendix G. Null: unknown name.
CharacterSetPtr CategorySet(std::string_view name);

// \p{IsName}: `name` is a block's name in Blocks.txt without its spaces ("Latin-1Supplement"), or a name from
// older versions of Unicode that XML Schema 1.0 lists ("Greek", "CombiningMarksforSymbols", "PrivateUse").
// Null: unknown name.
CharacterSetPtr BlockSet(std::string_view name);
// Names of all blocks, for "did you mean".
std::vector<std::string> BlockNames();

// \s \S \d \D \w \W \i \I \c \C, and `.` (XSD 1.1 part 2, G.4.2.5; `.` is all but \n and \r). Null: another
// letter.
CharacterSetPtr EscapeSet(char32_t letter);

// Case variants under flag `i` (XPath and XQuery Functions 3.1, 5.6.2): two characters are variants of each
// other if their full lower case or their full upper case is the same string.
CharacterSet WithCaseVariants(const CharacterSet& set);
bool AreCaseVariants(char32_t a, char32_t b);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_UNICODE_SETS_H_
