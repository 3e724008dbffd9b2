#include "graph/rdf/formats/raptor_world.h"

#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace docent {
namespace {

class WorldPool {
 public:
  raptor_world* Take() {
    absl::MutexLock lock(&mutex_);
    if (!idle_.empty()) {
      raptor_world* world = idle_.back();
      idle_.pop_back();
      return world;
    }
    raptor_world* world = raptor_new_world();
    // libxml2's error handlers belong to the whole process: Raptor must not replace them.
    raptor_world_set_flag(world, RAPTOR_WORLD_FLAG_LIBXML_GENERIC_ERROR_SAVE, 0);
    raptor_world_set_flag(world, RAPTOR_WORLD_FLAG_LIBXML_STRUCTURED_ERROR_SAVE, 0);
    raptor_world_open(world);
    return world;
  }
  void Return(raptor_world* world) {
    absl::MutexLock lock(&mutex_);
    idle_.push_back(world);
  }

 private:
  absl::Mutex mutex_;
  std::vector<raptor_world*> idle_ ABSL_GUARDED_BY(mutex_);
};

WorldPool& Pool() {
  static WorldPool* pool = new WorldPool;  // never freed, and neither are its worlds
  return *pool;
}

void Silence(void*, raptor_log_message*) {}

}  // namespace

RaptorWorld::RaptorWorld(OnMessage on_message) : world_(Pool().Take()), on_message_(std::move(on_message)) {
  raptor_world_set_log_handler(world_, this, [](void* self, raptor_log_message* message) {
    static_cast<RaptorWorld*>(self)->on_message_(*message);
  });
}

RaptorWorld::~RaptorWorld() {
  raptor_world_set_log_handler(world_, nullptr, Silence);
  raptor_world_set_generate_bnodeid_handler(world_, nullptr, nullptr);
  Pool().Return(world_);
}

}  // namespace docent
