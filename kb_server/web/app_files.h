// The files of the browser app, in memory as they are sent: with their types, packed forms and entity tags. Read once at the
// start and immutable then, so that no request reaches the disk; any thread.
#ifndef DOCENT_KB_SERVER_WEB_APP_FILES_H_
#define DOCENT_KB_SERVER_WEB_APP_FILES_H_

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "graph/base/web_limits.h"

namespace docent::server {

struct AppFile {
  std::string content_type;
  std::string etag;  // of `bytes`, without quotes
  std::string bytes;
  std::string gzip;        // empty: not worth it
  std::string brotli;      // empty: there is none
  bool is_hashed = false;  // its name changes with its content, so that it may be kept for ever
};

class AppFiles {
 public:
  // No app.
  AppFiles() = default;
  // All files below `folder`, which has an index.html. NAME.gz and NAME.br beside NAME are its packed forms; where there is
  // no NAME.gz, one is made. NOT_FOUND: there is no such folder, or no index.html in it; RESOURCE_EXHAUSTED naming the limit.
  static absl::StatusOr<AppFiles> Read(const std::string& folder, const WebLimits& limits = {});
  // The folder of the app that comes with this program: share/docent/web beside it, or web/dist in the source tree. Empty:
  // there is none.
  static std::string FindFolder();

  bool empty() const { return files_.empty(); }
  // The file at "/assets/app-1f3c.js"; "/" is index.html, "/visit" is visit.html or visit/index.html. Null: there is none.
  const AppFile* Find(const std::string& path) const;
  // The page of every view. Not of an empty app.
  const AppFile& index() const { return files_.at("/index.html"); }

 private:
  std::map<std::string, AppFile, std::less<>> files_;  // by path, "/index.html"
};

// The media type of a file by the ending of its name; "application/octet-stream" of an unknown one.
std::string_view ContentTypeOf(std::string_view name);
// True for names such as "/assets/index-B3xY9_aQ.js": in the folder assets, with eight or more characters after the last '-' or
// '.' before the ending, as Vite and others write them.
bool IsHashedName(std::string_view path);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WEB_APP_FILES_H_
