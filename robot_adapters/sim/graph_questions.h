// Queries of the guide robot to the graph: where a visitor is, what a booth shows.
//
// A server that is away is waited for, until the command must stop. Any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_GRAPH_QUESTIONS_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_GRAPH_QUESTIONS_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "maps/geometry.h"
#include "robot_adapters/sdk/operation.h"
#include "robot_adapters/sdk/server_link.h"

namespace docent::robot {

// What is told about a booth; any field may be empty.
struct BoothInfo {
  std::string iri;
  std::string name;  // "B03"
  std::string description;
  std::string exhibitor;
  std::string slogan;
  std::vector<std::string> products;
};

// Where a person is, as precisely as the graph says it.
struct Whereabouts {
  std::optional<maps::Point2> point;  // docent:x, docent:y
  std::vector<std::string> regions;   // IRIs, docent:isAt
};

// CANCELLED when the command must stop first; otherwise what the server says about the query.
absl::StatusOr<BoothInfo> AskAboutBooth(ServerLink& server, OperationContext& context,
                                        const std::string& booth_iri);
// NOT_FOUND: nothing is told about where the person is.
absl::StatusOr<Whereabouts> AskWhereIs(ServerLink& server, OperationContext& context,
                                       const std::string& person_iri);

// The IRI of a command's argument. INVALID_ARGUMENT if it is missing, no IRI, or would not fit into a query.
absl::StatusOr<std::string> IriArgument(const OperationContext& context, std::string_view name);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_GRAPH_QUESTIONS_H_
