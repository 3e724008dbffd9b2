// Conversion of a server time to an xsd:dateTime, and back. Any thread.
#ifndef DOCENT_GRAPH_RDF_DATE_TIME_H_
#define DOCENT_GRAPH_RDF_DATE_TIME_H_

#include <string>

#include "graph/base/clock.h"
#include "graph/rdf/term.h"

namespace docent {

// In UTC, to the millisecond, in canonical form (XML Schema 1.1 Part 2, section 3.3.7): "2026-11-25T09:30:00.5Z".
Term DateTimeTerm(TimeMicros time_us);

// The time of the lexical form of an xsd:dateTime with a zone; 0 if it is none.
TimeMicros MicrosOfDateTime(const std::string& lexical);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_DATE_TIME_H_
