// Queries of the guide robot to the graph: the place of a visitor, the data of a booth.
//
// If the server is away, they wait for it until the command must stop. Any thread.
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

// Data of a booth; any field may be empty.
struct BoothInfo {
  std::string iri;
  std::string name;  // "B03"
  std::string description;
  std::string exhibitor;
  std::string slogan;
  std::vector<std::string> products;
  std::string image = {};  // schema:image of the booth, or of its exhibitor
};

// Place of a person, as precise as the graph has it.
struct Whereabouts {
  std::optional<maps::Point2> point;  // docent:x, docent:y
  std::vector<std::string> regions;   // IRIs, docent:isAt
};

// CANCELLED if the command must stop first; otherwise the server's result.
absl::StatusOr<BoothInfo> AskAboutBooth(ServerLink& server, OperationContext& context,
                                        const std::string& booth_iri);
// NOT_FOUND: the graph has no place for the person.
absl::StatusOr<Whereabouts> AskWhereIs(ServerLink& server, OperationContext& context,
                                       const std::string& person_iri);

// The IRI of a command's argument. INVALID_ARGUMENT if it is missing, no IRI, or would not fit into a query.
absl::StatusOr<std::string> IriArgument(const OperationContext& context, std::string_view name);
// The literal of the argument "text". INVALID_ARGUMENT if it is missing, no literal, or empty.
absl::StatusOr<Term> TextArgument(const OperationContext& context);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_GRAPH_QUESTIONS_H_
