// Text files that commands write again in place. Any thread.
#ifndef DOCENT_KB_SERVER_CLI_TEXT_FILE_H_
#define DOCENT_KB_SERVER_CLI_TEXT_FILE_H_

#include <string>

#include "absl/status/status.h"

namespace docent::server {

// The file has `text` afterwards, or is as it was: a new file takes its place, with its permissions. A symbolic link stays
// one; what it leads to is replaced.
absl::Status ReplaceTextFile(const std::string& path, const std::string& text);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_TEXT_FILE_H_
