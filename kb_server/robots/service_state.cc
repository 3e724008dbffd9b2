#include "kb_server/robots/service_state.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"

namespace docent::server {
namespace {

constexpr char kNoReason[] = "no reason given";

}  // namespace

absl::Status SetServiceState(const std::string& robot, const std::optional<std::string>& reason,
                             const Dictionary& dictionary, const GraphVersion& graph, WriteBatch* batch) {
  const GraphReader reader(dictionary, graph);
  const std::vector<Term> types = reader.Objects(robot, kRdfType);
  if (std::find(types.begin(), types.end(), Term::Iri(DocentIri("Robot"))) == types.end()) {
    return absl::NotFoundError(
        absl::StrCat("there is no robot <", robot, ">; docent robots lists those that have joined"));
  }
  if (reason && reason->empty() && OutOfServiceReason(reader, robot)) return absl::OkStatus();
  const std::string property = DocentIri("outOfService");
  const std::optional<TermId> subject = dictionary.FindIri(robot), predicate = dictionary.FindIri(property);
  if (subject && predicate) {  // whoever told it
    graph.ForEach({*subject, *predicate, {}, {}}, [&](const Quad& quad) {
      batch->operations.push_back({QuadOperation::Kind::kRemove,
                                   {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                                    dictionary.Decode(quad.object), dictionary.Decode(quad.graph)}});
      return true;
    });
  }
  if (!reason) return absl::OkStatus();
  batch->operations.push_back(
      {QuadOperation::Kind::kAdd,
       {Term::Iri(robot), Term::Iri(property), Term::Literal(reason->empty() ? kNoReason : *reason),
        Term::Iri(std::string(kOperatorGraph))}});
  return absl::OkStatus();
}

std::optional<std::string> OutOfServiceReason(const GraphReader& graph, const std::string& robot) {
  const std::vector<Term> reasons = graph.Objects(robot, DocentIri("outOfService"));
  if (reasons.empty()) return std::nullopt;
  return reasons.front().lexical;
}

}  // namespace docent::server
