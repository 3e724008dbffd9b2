// Files that come with Docent's programs: scenarios, ontologies. No path of the machine that built them is compiled in.
// Any thread.
#ifndef DOCENT_GRAPH_BASE_DATA_FILES_H_
#define DOCENT_GRAPH_BASE_DATA_FILES_H_

#include <string>

#include "absl/status/statusor.h"

namespace docent {

// The path of `name`, which is given as in the source tree ("ontology/docent.ttl"). Looked for in the folder that the
// environment variable DOCENT_DATA_DIR names, and there alone where it is set; else in ../share/docent from the program's
// folder, as it is installed, and then in the folders above the program's, as it is built in build/PRESET/bin.
// NOT_FOUND says where it was looked for.
absl::StatusOr<std::string> FindDataFile(const std::string& name);

// The same for a program in the folder `program_folder`.
absl::StatusOr<std::string> FindDataFile(const std::string& name, const std::string& program_folder);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_DATA_FILES_H_
