// Keywords without space between them: SPARQL wants none where two terminals cannot be read as one (section 19.3), so that
// ORDERBY, LIMIT1 and FILTERNOTEXISTS are several. Pure function.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_JOINED_WORDS_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_JOINED_WORDS_H_

#include <cstddef>
#include <string_view>

namespace docent::sparql {

// The length of the first keyword of a word that consists of several, and of numbers between them; else of the whole word.
size_t FirstWordLength(std::string_view word);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_JOINED_WORDS_H_
