// librdf_storage_docent.so: what librdf loads from its module path (REDLAND_MODULE_PATH). The name of a
// storage is a data folder, or grpc://HOST:PORT for a running server.
#include <stdlib.h>
#include <unistd.h>

#include <memory>
#include <random>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "graph/base/clock.h"
#include "graph/redland/client_store.h"
#include "graph/redland/storage.h"
#include "kb_server/writer/folder_store.h"
#include "spdlog/sinks/null_sink.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

constexpr char kServer[] = "grpc://";

absl::StatusOr<std::unique_ptr<redland::QuadStore>> OpenStore(const std::string& name, bool make_new) {
  const bool is_server = absl::StartsWith(name, kServer);
  if (name.empty() || name == kServer || (!is_server && absl::StrContains(name, "://"))) {
    return absl::InvalidArgumentError(absl::StrCat(
        "\"", name, "\" names no storage; give a data folder, or the gRPC address of a running server, ",
        kServer, "HOST:PORT, which docent serve prints (HTTP's is another)"));
  }
  if (is_server) {
    std::random_device random;
    auto store = redland::ClientStore::Open(std::string(absl::StripPrefix(name, kServer)),
                                            absl::StrCat("redland-", getpid(), "-", absl::Hex(random()),
                                                         absl::Hex(random()), absl::Hex(random())));
    if (!store.ok()) return store.status();
    if (make_new) return absl::InvalidArgumentError("new='yes' is for a data folder, not for a server");
    return *std::move(store);
  }
  static const SystemClock* clock = new SystemClock;
  auto store = FolderStore::Open(name, make_new, clock);
  if (!store.ok()) return store.status();
  return *std::move(store);
}

}  // namespace
}  // namespace docent::server

// Called by librdf for each world that is opened.
extern "C" __attribute__((visibility("default"))) void librdf_storage_module_register_factory(
    librdf_world_s* world) {
  // What these would print is told through librdf's log, one line an error.
  setenv("GRPC_VERBOSITY", "NONE", 0);
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("docent", std::make_shared<spdlog::sinks::null_sink_mt>()));
  docent::redland::RegisterStorage(world, docent::server::OpenStore);
}
