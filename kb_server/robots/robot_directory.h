// Index of the robots that offer an operation, or one of a class, by the graph: docent:offers, docent:incarnation,
// docent:status, docent:idempotent, docent:input, docent:capability, docent:outOfService, and the classes above a class; and of reservations. Answers
// are kept until a change of one of these properties. It also says which adapters' addresses a turn changed. Writer thread only.
#ifndef DOCENT_KB_SERVER_ROBOTS_ROBOT_DIRECTORY_H_
#define DOCENT_KB_SERVER_ROBOTS_ROBOT_DIRECTORY_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/store/delta.h"
#include "graph/store/graph_version.h"
#include "kb_server/robots/robot_records.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

class GraphRobotDirectory final : public engine::RobotDirectory {
 public:
  // `dictionary` must outlive the directory.
  explicit GraphRobotDirectory(Dictionary* dictionary);

  // From now on answers are those of `version`, to which `delta` leads from the one before.
  void Refresh(const GraphVersion& version, const Delta& delta);
  // The turn failed: nothing that was kept counts.
  void Rollback() { Forget(); }

  const std::vector<engine::RobotOffer>& Offers(const std::string& operation) const override;
  const std::vector<engine::Reservation>& ReservationsOf(const RobotId& robot) const override;
  bool changed() const override { return changed_; }

  // Adapters of which `delta` tells a new address or incarnation; `version` is the graph after it.
  std::vector<AdapterAddress> AddressesIn(const Delta& delta, const GraphVersion& version) const;

 private:
  void Forget() {
    known_.clear();
    reservations_.reset();
  }
  std::vector<engine::RobotOffer> Read(const std::string& operation) const;
  std::vector<engine::RobotOffer> ReadOperation(TermId operation) const;
  std::vector<engine::RobotOffer> ReadCapability(std::string_view iri) const;
  void ReadStatus(TermId robot, engine::RobotOffer* offer) const;

  const Dictionary& dictionary_;
  const TermId address_, incarnation_;    // the properties
  const std::vector<TermId> properties_;  // what an offer is read from
  const GraphVersion* version_ = nullptr;
  bool changed_ = true;
  mutable std::map<std::string, std::vector<engine::RobotOffer>> known_;
  mutable std::optional<std::map<RobotId, std::vector<engine::Reservation>>> reservations_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_ROBOT_DIRECTORY_H_
