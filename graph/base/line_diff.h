// Difference of two texts, line by line, in the unified format of diff(1). Pure function; any thread.
#ifndef DOCENT_GRAPH_BASE_LINE_DIFF_H_
#define DOCENT_GRAPH_BASE_LINE_DIFF_H_

#include <string>
#include <string_view>

namespace docent {

// Headers with the two names, then hunks with three lines of context; empty where the texts are the same. What differs is
// shortest, unless the parts between the first and the last different line are long (the product of their numbers of lines is
// over 4 million): then all of that is one change.
std::string LineDiff(std::string_view before, std::string_view after, const std::string& before_name,
                     const std::string& after_name);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_LINE_DIFF_H_
