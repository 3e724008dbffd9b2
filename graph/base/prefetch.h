// Bringing memory into the cache before it is looked at.
#ifndef DOCENT_GRAPH_BASE_PREFETCH_H_
#define DOCENT_GRAPH_BASE_PREFETCH_H_

#include <cstddef>

namespace docent {

inline constexpr size_t kCacheLine = 64;

// The line of the cache that `at` is in; any address may be named. GCC takes a function that does nothing else for one
// without effect and leaves calls of it out: the empty asm says that it has one.
inline void Prefetch(const void* at) {
  __builtin_prefetch(at);
  asm volatile("" : : "r"(at));
}

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_PREFETCH_H_
