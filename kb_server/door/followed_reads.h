// Tells which followed reads have to be asked again. It keeps what each read looked at, and what the newest turns changed. Where
// it cannot tell, the answer counts as changed. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_FOLLOWED_READS_H_
#define DOCENT_KB_SERVER_DOOR_FOLLOWED_READS_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/delta.h"
#include "graph/store/graph_version.h"
#include "graph/store/read_trace.h"

namespace docent::server {

// Metadata of a call within this process: the name of the trace that it fills.
inline constexpr char kTraceKey[] = "docent-trace";

class FollowedReads {
 public:
  // `dictionary` must outlive it.
  explicit FollowedReads(const Dictionary* dictionary) : dictionary_(*dictionary) {}
  FollowedReads(const FollowedReads&) = delete;
  FollowedReads& operator=(const FollowedReads&) = delete;

  // The trace of a read that begins, for a call that names it.
  struct Begun {
    std::string name;
    std::shared_ptr<ReadTrace> trace;
  };
  Begun Begin();
  // The trace of that name; null: there is none, or its read was given up.
  std::shared_ptr<ReadTrace> Find(std::string_view name);

  // Whether somebody follows reads. Turns that come meanwhile are kept.
  void Keep(bool keep);
  // Turns lead to `version`, which is not visible yet; `others`: they changed more than the graph (documents, rules). Versions
  // come in order, from one thread.
  void Add(const GraphVersion& version, const std::vector<const Delta*>& turns, bool others);
  // Whether the answer that was read when `after` was visible may be another one on version `until`.
  bool MayHaveChanged(const ReadTrace& trace, uint64_t after, uint64_t until) const;

 private:
  static constexpr size_t kMostTurns = 1024;
  static constexpr size_t kMostQuads = 256;  // of one; beyond, it may have changed anything

  struct Turn {
    uint64_t revision = 0;
    bool anything = false;
    bool names = false;  // there are other graphs or predicates
    std::vector<Quad> quads;
  };
  static Turn Summary(const GraphVersion& version, const std::vector<const Delta*>& turns, bool others);

  const Dictionary& dictionary_;
  mutable absl::Mutex mutex_;
  uint64_t last_name_ ABSL_GUARDED_BY(mutex_) = 0;
  absl::flat_hash_map<std::string, std::weak_ptr<ReadTrace>> traces_ ABSL_GUARDED_BY(mutex_);
  size_t drop_gone_at_ ABSL_GUARDED_BY(mutex_) = 64;
  bool keeps_ ABSL_GUARDED_BY(mutex_) = false;
  uint64_t kept_after_ ABSL_GUARDED_BY(mutex_) = 0;  // turns beyond this revision are kept
  uint64_t newest_ ABSL_GUARDED_BY(mutex_) = 0;
  std::deque<Turn> turns_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_FOLLOWED_READS_H_
