// Terms in an archive (kb_server/base/archive.h). Any thread.
#ifndef DOCENT_KB_SERVER_RDF_TERM_ARCHIVE_H_
#define DOCENT_KB_SERVER_RDF_TERM_ARCHIVE_H_

#include "kb_server/base/archive.h"
#include "kb_server/rdf/term.h"

namespace docent {

template <class Archive>
void Fields(Archive& a, Term& term) {
  a(term.kind, term.lexical, term.datatype, term.language);
  if constexpr (Archive::kReads) {
    if (term.kind > TermKind::kLiteral) a.Fail();
  }
}

}  // namespace docent

#endif  // DOCENT_KB_SERVER_RDF_TERM_ARCHIVE_H_
