// The version of Docent's programs. Any thread.
#ifndef DOCENT_GRAPH_BASE_VERSION_H_
#define DOCENT_GRAPH_BASE_VERSION_H_

#include <string_view>

namespace docent {

// "0.1.0".
std::string_view Version();

// For people: "0.1.0 (commit 86ed301b2c4d)", with ", changed" where the tree had changes that are not committed; "0.1.0"
// where the commit is not known. Defined in the library docent_commit, which the programs alone link, so that a new commit
// compiles one small file and nothing else.
std::string_view VersionWithCommit();

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_VERSION_H_
