// Files that the robot makes for people. Free functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_TEXT_FILE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_TEXT_FILE_H_

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace docent::robot {

// Written aside and renamed, so that a reader never sees half of it. The system's error, naming the file.
absl::Status WriteTextFile(const std::string& path, const std::string& text);

// The part of an IRI after its last '#' or '/', with everything but letters, digits, '-' and '_' as '_';
// "thing" if nothing is left. Safe as a file name.
std::string FileNameOf(std::string_view iri);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_TEXT_FILE_H_
