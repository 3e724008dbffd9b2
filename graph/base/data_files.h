// Lookup of the files that come with Docent's programs: scenarios, ontologies. No path of the build machine
// is compiled in. Any thread.
#ifndef DOCENT_GRAPH_BASE_DATA_FILES_H_
#define DOCENT_GRAPH_BASE_DATA_FILES_H_

#include <string>

#include "absl/status/statusor.h"

namespace docent {

// The path of `name`, a path relative to the source tree ("ontology/docent.ttl"). If the environment variable
// DOCENT_DATA_DIR is set, only that folder is searched. Otherwise the search starts in ../share/docent beside
// the program's folder (installed), then in the folders above the program's (built in build/PRESET/bin).
// NOT_FOUND lists the places searched.
absl::StatusOr<std::string> FindDataFile(const std::string& name);

// The same for a program in the folder `program_folder`.
absl::StatusOr<std::string> FindDataFile(const std::string& name, const std::string& program_folder);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_DATA_FILES_H_
