// Mapping of raw sensor readings (sensor, value, time) to subject–verb–object facts by the graph's
// docent:ReadingMapping resources (ontology/sensor.ttl): the paper's first step from sensed data to
// structural context (Choi et al. 2014).
//
//   expo:doorMapping a docent:ReadingMapping ; docent:forSensor expo:doorSensor ;
//     docent:subject docent:readingValue ; docent:predicate docent:isAt ; docent:object expo:Entrance ;
//     docent:valueMeaning [ docent:readingValue "tag-17" ; docent:means expo:John ] .
//
// docent:readingValue in place of a term stands for the mapped value of the reading; without a matching
// valueMeaning it is the raw value. docent:whenValue limits a mapping to one value; docent:effect
// docent:Withdraws removes the fact instead. Facts go into the graph of the batch's source: sensors that
// report through one source (a tracking system) share one state, so a tag seen at the next beacon is no
// longer at the one before.
#ifndef DOCENT_GRAPH_STORE_READING_MAPPER_H_
#define DOCENT_GRAPH_STORE_READING_MAPPER_H_

#include <vector>

#include "absl/status/statusor.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"

namespace docent {

// INVALID_ARGUMENT naming the reading ("readings[2]: …"): its sensor has no mapping, or a mapping is
// incomplete or gives no valid RDF here. A mapping that whenValue excludes gives no fact, which is no error.
absl::StatusOr<std::vector<QuadOperation>> MapReadings(const std::vector<SensorReading>& readings,
                                                       const Dictionary& dictionary,
                                                       const GraphVersion& version);

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_READING_MAPPER_H_
