// Ontologies and rules that the command line names, loaded when a server starts, unless the graph has them as they are.
#ifndef DOCENT_KB_SERVER_START_FILES_H_
#define DOCENT_KB_SERVER_START_FILES_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "kb_server/door/ports.h"

namespace docent::server {

// The files' names name their modules. Errors name the file.
absl::Status LoadOntologyFiles(const RunPorts& ports, const std::vector<std::string>& files);

// `names`: of files, of built-in rule sets, or "none". Naming a built-in set, or none, says which of them are in force;
// files are added to those that are.
absl::Status LoadRuleFiles(const RunPorts& ports, const std::vector<std::string>& names);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_START_FILES_H_
