// Makes Abseil's mutexes visible to the thread sanitizer. Debian's Abseil is compiled without the sanitizer,
// so everything that an absl::Mutex guards looks like a data race. In the tsan preset every program is linked
// with this file and `-Wl,--wrap` of the functions below: each calls the real one and reports the order that
// it establishes.
//
// Unlock and Await may evaluate the conditions of *other* waiting threads: reads under the mutex, but after
// the reported release. They are ignored.
#include <sanitizer/tsan_interface.h>

#include "absl/synchronization/mutex.h"
#include "absl/synchronization/notification.h"

extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
}

namespace {

class IgnoreReads {
 public:
  IgnoreReads() { AnnotateIgnoreReadsBegin(__FILE__, __LINE__); }
  ~IgnoreReads() { AnnotateIgnoreReadsEnd(__FILE__, __LINE__); }
};

// The flag that the inline Notification::HasBeenNotified reads: it follows the mutex.
void* NotifiedFlag(const absl::Notification* n) {
  return const_cast<char*>(reinterpret_cast<const char*>(n)) + sizeof(absl::Mutex);
}

}  // namespace

#define MUTEX(function) _ZN4absl7debian35Mutex##function
#define NOTIFICATION(function) _ZN4absl7debian312Notification##function
#define NOTIFICATION_CONST(function) _ZNK4absl7debian312Notification##function
#define JOIN(a, b) a##b
#define REAL_OF(name) JOIN(__real_, name)
#define WRAP_OF(name) JOIN(__wrap_, name)

// Acquires the mutex.
#define WRAP_LOCK(name)                        \
  extern "C" void REAL_OF(name)(void*);        \
  extern "C" void WRAP_OF(name)(void* mutex) { \
    REAL_OF(name)(mutex);                      \
    __tsan_acquire(mutex);                     \
  }
// Releases it.
#define WRAP_UNLOCK(name)                      \
  extern "C" void REAL_OF(name)(void*);        \
  extern "C" void WRAP_OF(name)(void* mutex) { \
    __tsan_release(mutex);                     \
    IgnoreReads ignore;                        \
    REAL_OF(name)(mutex);                      \
  }
// Releases it and acquires it again.
#define WRAP_AWAIT(name, result, ...)                                                                 \
  extern "C" result REAL_OF(name)(void*, const absl::Condition& __VA_OPT__(, ) __VA_ARGS__);          \
  extern "C" result WRAP_OF(name)(void* mutex,                                                        \
                                  const absl::Condition& condition __VA_OPT__(, __VA_ARGS__ limit)) { \
    struct After {                                                                                    \
      void* mutex;                                                                                    \
      ~After() { __tsan_acquire(mutex); }                                                             \
    } after{mutex};                                                                                   \
    __tsan_release(mutex);                                                                            \
    IgnoreReads ignore;                                                                               \
    return REAL_OF(name)(mutex, condition __VA_OPT__(, limit));                                       \
  }

WRAP_LOCK(MUTEX(4LockEv))
WRAP_LOCK(MUTEX(10ReaderLockEv))
WRAP_UNLOCK(MUTEX(6UnlockEv))
WRAP_UNLOCK(MUTEX(12ReaderUnlockEv))
WRAP_AWAIT(MUTEX(5AwaitERKNS0_9ConditionE), void)
WRAP_AWAIT(MUTEX(8LockWhenERKNS0_9ConditionE), void)
WRAP_AWAIT(MUTEX(16AwaitWithTimeoutERKNS0_9ConditionENS0_8DurationE), bool, absl::Duration)
WRAP_AWAIT(MUTEX(17AwaitWithDeadlineERKNS0_9ConditionENS0_4TimeE), bool, absl::Time)

extern "C" void REAL_OF(NOTIFICATION(6NotifyEv))(absl::Notification*);
extern "C" void WRAP_OF(NOTIFICATION(6NotifyEv))(absl::Notification* n) {
  __tsan_release(NotifiedFlag(n));
  REAL_OF(NOTIFICATION(6NotifyEv))(n);
}
extern "C" void REAL_OF(NOTIFICATION_CONST(19WaitForNotificationEv))(const absl::Notification*);
extern "C" void WRAP_OF(NOTIFICATION_CONST(19WaitForNotificationEv))(const absl::Notification* n) {
  REAL_OF(NOTIFICATION_CONST(19WaitForNotificationEv))(n);
  __tsan_acquire(NotifiedFlag(n));
}
extern "C" bool REAL_OF(NOTIFICATION_CONST(30WaitForNotificationWithTimeoutENS0_8DurationE))(
    const absl::Notification*, absl::Duration);
extern "C" bool WRAP_OF(NOTIFICATION_CONST(30WaitForNotificationWithTimeoutENS0_8DurationE))(
    const absl::Notification* n, absl::Duration limit) {
  const bool notified =
      REAL_OF(NOTIFICATION_CONST(30WaitForNotificationWithTimeoutENS0_8DurationE))(n, limit);
  if (notified) __tsan_acquire(NotifiedFlag(n));
  return notified;
}
