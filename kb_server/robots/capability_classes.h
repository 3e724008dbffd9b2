// Classes of operations: what stands above a class, told or inferred. Any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_CAPABILITY_CLASSES_H_
#define DOCENT_KB_SERVER_ROBOTS_CAPABILITY_CLASSES_H_

#include <set>
#include <string>

#include "graph/rdf/dictionary.h"
#include "graph/store/graph_reader.h"
#include "graph/store/graph_version.h"

namespace docent::server {

// The class itself and all that stand above it by rdfs:subClassOf or owl:equivalentClass.
std::set<TermId> ClassesAbove(const Dictionary& dictionary, const GraphVersion& version, TermId iri);

// Whether the robot says that it offers an operation of this class, or of one below it (docent:hasCapability).
bool IsCapable(const GraphReader& graph, const std::string& robot, const std::string& iri);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_CAPABILITY_CLASSES_H_
