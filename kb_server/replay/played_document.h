// Workflow documents as a replay deploys them. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_REPLAY_PLAYED_DOCUMENT_H_
#define DOCENT_KB_SERVER_REPLAY_PLAYED_DOCUMENT_H_

#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/limits.h"
#include "kb_server/replay/run_case.h"
#include "workflow/cawl/ast.h"

namespace docent::server {

// A document that is correct: INVALID_ARGUMENT with every mistake, its place and remedy, if it is not. `name` is for people.
absl::StatusOr<cawl::DocumentPtr> ParseWorkflow(const std::string& text, const std::string& name,
                                                const Limits& limits);

// The same document with an activator that never fires: a replay starts its one run itself.
cawl::DocumentPtr WithoutFiring(const cawl::Document& document);

// The same with one node in one flow, which follows on the source at once. NOT_FOUND: there is no such flow or node; the nearest
// is named.
absl::StatusOr<cawl::DocumentPtr> OnlyNode(const cawl::Document& document, const std::string& flow,
                                           const std::string& node);

// A case with documents of robot services in place of those that have their names, also of those that came in its life.
// `services`: names are for people. INVALID_ARGUMENT with every mistake: one is not correct.
absl::StatusOr<RunCase> WithServices(RunCase recorded, const std::vector<Document>& services,
                                     const Limits& limits);

// The operations of robots that a document invokes, or that robot services and workflows among `others` do, by name.
absl::StatusOr<std::set<std::string>> OperationsOf(const cawl::Document& document,
                                                   const std::vector<Document>& others, const Limits& limits);

// An ASK with values in place of its variables.
std::string WithValues(const std::string& ask, const std::map<std::string, Term>& values);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_PLAYED_DOCUMENT_H_
