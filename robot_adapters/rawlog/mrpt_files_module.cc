#include "robot_adapters/rawlog/mrpt_files_module.h"

#include <dlfcn.h>

#include <filesystem>

#include "absl/strings/str_cat.h"

namespace docent::robot {
namespace {

absl::StatusOr<const MrptFiles*> Load() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string path =
      (program.parent_path().parent_path() / "lib" / "docent" / "docent_mrpt_files.so").string();
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat("recordings are read by ", path,
                                            ", which is not there: install the package docent-robot-replay"));
  }
  // It stays: its MRPT has registered its classes for good.
  void* module = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* files = module != nullptr ? dlsym(module, kMrptFilesSymbol) : nullptr;
  if (files == nullptr) return absl::InternalError(absl::StrCat("cannot load ", path, ": ", dlerror()));
  return static_cast<const MrptFiles*>(files);
}

}  // namespace

absl::StatusOr<const MrptFiles*> LoadMrptFiles() {
  static const auto* loaded = new absl::StatusOr<const MrptFiles*>(Load());
  return *loaded;
}

}  // namespace docent::robot
