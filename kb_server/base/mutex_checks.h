// What a program says of its mutexes before it has any threads.
#ifndef DOCENT_KB_SERVER_BASE_MUTEX_CHECKS_H_
#define DOCENT_KB_SERVER_BASE_MUTEX_CHECKS_H_

#include "absl/synchronization/mutex.h"

namespace docent {

// Debian's Abseil is built for debugging: each lock, gRPC's too, looks for circles in the order of locks. Our debug
// builds leave it at that; others do without.
inline void SetMutexChecks() {
#ifdef NDEBUG
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
#endif
}

}  // namespace docent

#endif  // DOCENT_KB_SERVER_BASE_MUTEX_CHECKS_H_
