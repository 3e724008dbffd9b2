// Text files that the robot writes for people. Free functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_TEXT_FILE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_TEXT_FILE_H_

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace docent::robot {

// Writes a temporary file and renames it, so that readers never see a partial file. The system's error,
// naming the file.
absl::Status WriteTextFile(const std::string& path, const std::string& text);

// The part of an IRI after its last '#' or '/', with all characters except letters, digits, '-' and '_'
// replaced by '_'; "thing" if the part is empty. Safe as a file name.
std::string FileNameOf(std::string_view iri);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_TEXT_FILE_H_
