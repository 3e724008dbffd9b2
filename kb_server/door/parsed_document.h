// A CAWL or RSEL document as the service that checked it has parsed it: it goes through the door beside its text, so that the
// writer's turn need not parse it once more. Value; any thread.
#ifndef DOCENT_KB_SERVER_DOOR_PARSED_DOCUMENT_H_
#define DOCENT_KB_SERVER_DOOR_PARSED_DOCUMENT_H_

#include "graph/store/write_batch.h"
#include "workflow/cawl/ast.h"
#include "workflow/rsel/ast.h"

namespace docent::server {

// One of the two is set: a correct document, parsed from the text of the same Document under its name.
struct ParsedDocument final : ParsedText {
  explicit ParsedDocument(cawl::DocumentPtr document) : cawl(std::move(document)) {}
  explicit ParsedDocument(rsel::DocumentPtr document) : rsel(std::move(document)) {}

  const cawl::DocumentPtr cawl;
  const rsel::DocumentPtr rsel;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_PARSED_DOCUMENT_H_
