// Characters that are not seen, or that do something to what is shown around them. Pure function.
#ifndef DOCENT_GRAPH_RDF_HIDDEN_CHARACTER_H_
#define DOCENT_GRAPH_RDF_HIDDEN_CHARACTER_H_

namespace docent {

// Control characters of ASCII and ISO 8859-1; what breaks lines (U+2028, U+2029); and what a reader does not see: format
// characters, marks of the direction of writing (Unicode Standard Annex 9) and other default-ignorable characters (Unicode
// Standard, section 5.21).
bool IsHiddenCharacter(char32_t c);

// A hidden character that joins or tells apart the letters or pictures beside it: it says something after one that is not ASCII.
bool IsJoiner(char32_t c);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_HIDDEN_CHARACTER_H_
