// Generated graph of `docent-bench kb`: three worlds in one graph, from a seed, as N-Triples.
//  - a university similar to LUBM (Guo et al., Journal of Web Semantics 2005): departments, courses,
//    advisors, publications; regular, deep
//  - a shop similar to WatDiv (Aluç et al., ISWC 2014): users who follow, like and befriend, products,
//    reviews, offers; skewed, sparse properties
//  - a live place: robots and visitors with poses, booths with topics
// Names, classes and counts are ours; only the shape of the published generators is followed. One thread.
#ifndef DOCENT_BENCH_KB_KB_DATA_H_
#define DOCENT_BENCH_KB_KB_DATA_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace docent::bench {

// Number of things of each kind, from which parameters are drawn.
struct KbCounts {
  size_t triples = 0;
  size_t departments = 0, universities = 0;
  size_t users = 0, products = 0, genres = 0, retailers = 0, cities = 0, countries = 0;
  size_t robots = 0, visitors = 0, booths = 0;
};

inline constexpr size_t kCoursesPerDepartment = 20, kProfessorsPerDepartment = 8;

// Writes about `triples` distinct triples to `path`. UNAVAILABLE if the file can't be written.
absl::StatusOr<KbCounts> WriteKbData(const std::string& path, size_t triples, uint64_t seed);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_KB_KB_DATA_H_
