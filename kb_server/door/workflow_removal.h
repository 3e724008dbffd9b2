// What is removed of a workflow (Document::Action::kRemove), by the text of the removal. Constants.
#ifndef DOCENT_KB_SERVER_DOOR_WORKFLOW_REMOVAL_H_
#define DOCENT_KB_SERVER_DOOR_WORKFLOW_REMOVAL_H_

namespace docent::server {

// Without a text: the workflow. Its live runs go on.
inline constexpr char kRemovesRuns[] = "runs";                // the workflow and its live runs
inline constexpr char kRemovesStarts[] = "starts";            // that it starts runs: it is disabled
inline constexpr char kRemovesDisablement[] = "disablement";  // that it is disabled

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_WORKFLOW_REMOVAL_H_
