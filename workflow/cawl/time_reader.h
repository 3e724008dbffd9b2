// Times as parts of conditions: <ext:time between="22:00-06:00" zone="Europe/Berlin"/> in a <rule> or <context>.
//
// A time becomes a constraint about facts that the clock tells (kb_server/clock), so that it can be joined with others by
// and, or and not, and shown and explained like them. Its subject is the IRI of the time (graph/calendar/time_spec.h).
//
//   lasts    between, days, from, until   <time> docent:timeHolds true .
//            open="?place"                ?place docent:openNow true .
//   occurs   at, every                    <time> docent:occurs ?_event_1 .      an event
//   after    no fact: the engine counts it from when the node is entered
#ifndef DOCENT_WORKFLOW_CAWL_TIME_READER_H_
#define DOCENT_WORKFLOW_CAWL_TIME_READER_H_

#include <cstdint>
#include <vector>

#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Mistakes are reported; then nothing is added to the rule.
void ReadTime(const xml::Element& element, xml::ElementReader* reader, Rule* rule);

// ext:zone of the root element, which counts where a time has no zone.
void CheckZone(const Text& zone, xml::ElementReader* reader);

// What a time cannot be where it stands: an `after` of an activator, an occurrence under `not`. Mistakes go to the reader.
void CheckTimes(const Document& document, xml::ElementReader* reader);

// The longest `after` of each alternative, in the order of CompileCondition; empty: none has one.
std::vector<int64_t> DelaysOf(const Condition& condition);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_TIME_READER_H_
