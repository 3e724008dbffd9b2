#include "graph/redland/redland_world.h"

#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "graph/redland/storage.h"

namespace docent::redland {
namespace {

class WorldPool {
 public:
  librdf_world* Take() {
    absl::MutexLock lock(&mutex_);
    if (!idle_.empty()) {
      librdf_world* world = idle_.back();
      idle_.pop_back();
      return world;
    }
    librdf_world* world = librdf_new_world();
    librdf_world_set_raptor_init_handler(world, nullptr, [](void*, raptor_world* raptor) {
      // libxml2's error handlers belong to the whole process: librdf must not replace them.
      raptor_world_set_flag(raptor, RAPTOR_WORLD_FLAG_LIBXML_GENERIC_ERROR_SAVE, 0);
      raptor_world_set_flag(raptor, RAPTOR_WORLD_FLAG_LIBXML_STRUCTURED_ERROR_SAVE, 0);
    });
    librdf_world_open(world);
    RegisterStorage(world, nullptr);
    return world;
  }
  void Return(librdf_world* world) {
    absl::MutexLock lock(&mutex_);
    idle_.push_back(world);
  }

 private:
  absl::Mutex mutex_;
  std::vector<librdf_world*> idle_ ABSL_GUARDED_BY(mutex_);
};

WorldPool& Pool() {
  static WorldPool* pool = new WorldPool;  // never freed, and neither are its worlds
  return *pool;
}

int Keep(void* errors, librdf_log_message* message) {
  auto* kept = static_cast<std::vector<std::string>*>(errors);
  if (kept == nullptr || librdf_log_message_level(message) < LIBRDF_LOG_ERROR) return 1;
  std::string text = librdf_log_message_message(message);
  if (kept->empty() || kept->back() != text) kept->push_back(std::move(text));  // once, not for each row
  return 1;                                                                     // handled
}

}  // namespace

RedlandWorld::RedlandWorld() : world_(Pool().Take()) {
  librdf_world_set_logger(world_, &errors_, Keep);
}

RedlandWorld::~RedlandWorld() {
  librdf_world_set_logger(world_, nullptr, Keep);
  Pool().Return(world_);
}

}  // namespace docent::redland
