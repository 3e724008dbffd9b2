// The words in subject, verb and object, as ast.h shows them. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_WORD_READER_H_
#define DOCENT_WORKFLOW_CAWL_WORD_READER_H_

#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

enum class WordRole { kSubject, kVerb, kObject };

// The word of <subject>, <verb> or <object>, and its @type. A mistake is reported and leaves kMissing.
Word ReadWord(const xml::Element& element, WordRole role, xml::ElementReader* reader);

// "subject verb object" in an attribute (ext:while) of `element`; nullopt after a reported mistake.
std::optional<Constraint> ReadConstraintText(const xml::Element& element, const Text& text,
                                             xml::ElementReader* reader);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_WORD_READER_H_
