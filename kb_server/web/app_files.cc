#include "kb_server/web/app_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/data_files.h"
#include "graph/base/fingerprint.h"
#include "graph/base/gzip.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

namespace fs = std::filesystem;

constexpr size_t kWorthPacking = 1024;  // bytes
constexpr size_t kHashCharacters = 8;

struct Type {
  std::string_view ending;
  std::string_view type;
};
constexpr Type kTypes[] = {{".html", "text/html; charset=utf-8"},
                           {".js", "text/javascript; charset=utf-8"},
                           {".mjs", "text/javascript; charset=utf-8"},
                           {".css", "text/css; charset=utf-8"},
                           {".json", "application/json"},
                           {".map", "application/json"},
                           {".webmanifest", "application/manifest+json"},
                           {".svg", "image/svg+xml"},
                           {".txt", "text/plain; charset=utf-8"},
                           {".xml", "application/xml"},
                           {".wasm", "application/wasm"},
                           {".png", "image/png"},
                           {".jpg", "image/jpeg"},
                           {".jpeg", "image/jpeg"},
                           {".webp", "image/webp"},
                           {".avif", "image/avif"},
                           {".gif", "image/gif"},
                           {".ico", "image/x-icon"},
                           {".woff2", "font/woff2"},
                           {".woff", "font/woff"},
                           {".ttf", "font/ttf"},
                           {".mp3", "audio/mpeg"},
                           {".mp4", "video/mp4"}};

bool IsPackable(std::string_view type) {
  return type.starts_with("text/") || type.ends_with("json") || type.ends_with("xml") ||
         type.ends_with("wasm") || type.ends_with("icon");
}

absl::StatusOr<std::string> ReadBytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.is_open() || in.bad()) return absl::NotFoundError(absl::StrCat("cannot read ", path.string()));
  return bytes;
}

// By path, as they lie in the folder.
absl::StatusOr<std::map<std::string, std::string, std::less<>>> ReadFolder(const std::string& folder,
                                                                           const WebLimits& limits) {
  std::map<std::string, std::string, std::less<>> found;
  size_t all = 0;
  std::error_code error;
  fs::recursive_directory_iterator entries(folder, error);
  for (; !error && entries != fs::recursive_directory_iterator(); entries.increment(error)) {
    if (!entries->is_regular_file(error) || error) continue;
    absl::StatusOr<std::string> bytes = ReadBytes(entries->path());
    if (!bytes.ok()) return bytes.status();
    all += bytes->size();
    if (found.size() == limits.web_files || all > limits.web_bytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the web app in ", folder, " has more files than web_files = ", limits.web_files,
                       ", or more bytes than web_bytes = ", limits.web_bytes, "; is that the right folder?"));
    }
    found.emplace("/" + fs::relative(entries->path(), folder).generic_string(), *std::move(bytes));
  }
  if (error)
    return absl::NotFoundError(absl::StrCat("cannot read the web app in ", folder, ": ", error.message()));
  return found;
}

}  // namespace

std::string_view ContentTypeOf(std::string_view name) {
  const std::string lower = absl::AsciiStrToLower(ToAbsl(name));
  for (const Type& one : kTypes) {
    if (std::string_view(lower).ends_with(one.ending)) return one.type;
  }
  return "application/octet-stream";
}

bool IsHashedName(std::string_view path) {
  if (path.find("/assets/") == std::string_view::npos) return false;
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const std::string_view stem = name.substr(0, name.rfind('.'));
  // Vite's hashes may have '-' and '_' in them: what counts is that eight characters stand at the end.
  if (stem.size() <= kHashCharacters) return false;
  const char before = stem[stem.size() - kHashCharacters - 1];
  const std::string_view hash = stem.substr(stem.size() - kHashCharacters);
  return (before == '-' || before == '.') && std::all_of(hash.begin(), hash.end(), [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
         });
}

absl::StatusOr<AppFiles> AppFiles::Read(const std::string& folder, const WebLimits& limits) {
  auto found = ReadFolder(folder, limits);
  if (!found.ok()) return found.status();
  AppFiles app;
  for (auto& [path, bytes] : *found) {
    const bool is_packed = path.ends_with(".gz") || path.ends_with(".br");
    if (is_packed && found->count(path.substr(0, path.size() - 3)) > 0) continue;
    AppFile& file = app.files_[path];
    file.content_type = ContentTypeOf(path);
    file.etag = absl::StrCat(absl::Hex(Fingerprint(bytes), absl::kZeroPad16));
    file.is_hashed = IsHashedName(path);
    if (const auto packed = found->find(path + ".br"); packed != found->end()) file.brotli = packed->second;
    if (const auto packed = found->find(path + ".gz"); packed != found->end()) {
      file.gzip = packed->second;
    } else if (bytes.size() >= kWorthPacking && IsPackable(file.content_type)) {
      file.gzip = Gzip(bytes);
    }
    file.bytes = bytes;
  }
  if (app.files_.count("/index.html") == 0) {
    return absl::NotFoundError(
        absl::StrCat("there is no index.html in ", folder, ": it is not the folder of a built web app"));
  }
  return app;
}

std::string AppFiles::FindFolder() {
  for (const char* name : {"web/dist", "web"}) {
    const auto assets = FindDataFile(absl::StrCat(name, "/assets"));  // a source folder has none
    if (!assets.ok()) continue;
    const fs::path folder = fs::path(*assets).parent_path();
    std::error_code error;
    if (fs::exists(folder / "index.html", error)) return folder.string();
  }
  return "";
}

const AppFile* AppFiles::Find(const std::string& path) const {
  const std::string without = path.ends_with('/') ? path.substr(0, path.size() - 1) : path;
  for (const std::string& name : {path, without + ".html", without + "/index.html"}) {
    const auto found = files_.find(name);
    if (found != files_.end()) return &found->second;
  }
  return nullptr;
}

}  // namespace docent::server
