// How long a term's texts are: for limits. Any thread.
#ifndef DOCENT_KB_SERVER_RDF_TEXT_BYTES_H_
#define DOCENT_KB_SERVER_RDF_TEXT_BYTES_H_

#include <cstddef>

#include "kb_server/rdf/term.h"

namespace docent {

inline size_t TextBytes(const Term& term) {
  return term.lexical.size() + term.datatype.size() + term.language.size();
}

}  // namespace docent

#endif  // DOCENT_KB_SERVER_RDF_TEXT_BYTES_H_
