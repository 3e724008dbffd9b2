// Read set of a WHERE clause, as patterns of quads. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_UPDATE_READS_H_
#define DOCENT_GRAPH_SPARQL_RUN_UPDATE_READS_H_

#include <vector>

#include "graph/sparql/syntax/algebra.h"
#include "graph/store/recent_changes.h"

namespace docent::sparql {

// Adds all patterns that `where` reads, at any depth; never too few. Graphs are left open: the data
// set decides on them. A path, and a GRAPH whose solutions depend on the set of graphs, read
// everything.
void AddReads(const Algebra& where, std::vector<ReadPattern>* out);
// Adds one. Some hundred become the one that reads everything: the writer compares each with each quad that changes.
void AddRead(ReadPattern read, std::vector<ReadPattern>* out);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_UPDATE_READS_H_
