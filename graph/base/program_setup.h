// Process-wide settings (mutex checks, malloc), made before the first thread starts. Only for files with a main().
#ifndef DOCENT_GRAPH_BASE_PROGRAM_SETUP_H_
#define DOCENT_GRAPH_BASE_PROGRAM_SETUP_H_

#include "absl/synchronization/mutex.h"

// Read by jemalloc, if the program is linked with it. A background thread of jemalloc returns unused memory
// within a second. Without that thread, memory is returned only during allocations, so a server that is idle
// after a large load would keep the memory of the load.
extern "C" {
[[gnu::used]] inline const char* malloc_conf = "background_thread:true,dirty_decay_ms:1000";
}

namespace docent {

// Debian's Abseil is built for debugging: each lock, also gRPC's, is checked for deadlock cycles. Debug
// builds keep the check; other builds turn it off.
inline void SetMutexChecks() {
#ifdef NDEBUG
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
#endif
}

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_PROGRAM_SETUP_H_
