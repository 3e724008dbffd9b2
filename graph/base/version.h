// The version of Docent's programs. Any thread.
#ifndef DOCENT_GRAPH_BASE_VERSION_H_
#define DOCENT_GRAPH_BASE_VERSION_H_

#include <string_view>

namespace docent {

// "0.1.0".
std::string_view Version();

// For people: "0.1.0 (commit 86ed301b2c4d)", followed by ", changed" if the tree had uncommitted changes;
// "0.1.0" if the commit is not known. Defined in the library docent_commit, which only the programs link: a
// new commit recompiles one small file.
std::string_view VersionWithCommit();

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_VERSION_H_
