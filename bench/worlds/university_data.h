// University data similar to LUBM (Guo, Pan, Heflin, Journal of Web Semantics 2005), for `docent-bench
// rules`: exactly the requested number of facts, and an ontology of 47 axioms (20 subclasses, 5
// subproperties, 10 domains, 9 ranges, a transitive property, 2 inverse ones). Names, counts and the
// generator are ours. Deterministic. Pure functions.
#ifndef DOCENT_BENCH_WORLDS_UNIVERSITY_DATA_H_
#define DOCENT_BENCH_WORLDS_UNIVERSITY_DATA_H_

#include <cstddef>
#include <functional>
#include <string>

namespace docent::bench {

inline constexpr char kUniversityNs[] = "http://example.org/university#";

// Local names in kUniversityNs; but "type", "subClassOf", "subPropertyOf", "domain", "range", "inverseOf" as
// predicates and "TransitiveProperty" as object stand for those of RDF, RDFS and OWL.
using TripleSink = std::function<void(const std::string& s, const std::string& p, const std::string& o)>;

void UniversityOntology(const TripleSink& sink);
// The first `count` facts: universities with departments, groups, teachers, students, courses and
// publications.
void UniversityFacts(size_t count, const TripleSink& sink);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_WORLDS_UNIVERSITY_DATA_H_
