// Functions on positions in the hall frame that queries, rules and conditions call by IRI.
//
//   docent:distance(?x1, ?y1, ?x2, ?y2)   metres between two positions, xsd:decimal to the millimetre
//   docent:routeLength(?from, ?to, ?roadmap)  metres between two points, "X Y" or WKT POINT(X Y), along the ways of a roadmap: a
//                                         literal "X1 Y1 X2 Y2; POINT(X1 Y1) POINT(X2 Y2) LENGTH; …" (maps/roadmap.h). Without ways,
//                                         along the straight line; an error where none lead there
//   docent:inRegion(?x, ?y, ?outline)     whether the position lies in the polygon whose outline is WKT, as geo:asWKT
//                                         gives it; on the edge itself it may be either
//
// An argument that is no number, or no polygon, is a type error of the expression (SPARQL 1.1 section 17.2).
#ifndef DOCENT_KB_SERVER_TURN_SPATIAL_FUNCTIONS_H_
#define DOCENT_KB_SERVER_TURN_SPATIAL_FUNCTIONS_H_

#include "graph/sparql/values/function_registry.h"

namespace docent::server {

// Into a registry that has none of them. The functions may be called on any thread.
void RegisterSpatialFunctions(sparql::FunctionRegistry* functions);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_SPATIAL_FUNCTIONS_H_
