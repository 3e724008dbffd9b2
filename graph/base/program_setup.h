// Process-wide settings (mutex checks, malloc), made before the first thread starts. Only for files with a main().
#ifndef DOCENT_GRAPH_BASE_PROGRAM_SETUP_H_
#define DOCENT_GRAPH_BASE_PROGRAM_SETUP_H_

#include "absl/synchronization/mutex.h"

// Read by jemalloc, where the program is linked with it. It gives back within a second what nobody needs any more, from a
// thread of its own: without one it does so only while more is asked for, and a server that is idle after a large load
// keeps what the load needed.
extern "C" {
[[gnu::used]] inline const char* malloc_conf = "background_thread:true,dirty_decay_ms:1000";
}

namespace docent {

// Debian's Abseil is built for debugging: each lock, gRPC's too, looks for circles in the order of locks. Our debug
// builds leave it at that; others do without.
inline void SetMutexChecks() {
#ifdef NDEBUG
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
#endif
}

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_PROGRAM_SETUP_H_
