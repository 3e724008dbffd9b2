#include "kb_server/robots/lease_watch.h"

#include <utility>

#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/robots/robot_facts.h"
#include "kb_server/robots/robot_records.h"
#include "spdlog/spdlog.h"

namespace docent::server {

void LeaseWatch::Begin() {
  const GraphVersionPtr version = queries_.Newest();
  const GraphReader graph(dictionary_, *version);
  for (const std::string& robot : RobotsOnline(dictionary_, *version)) {
    const AdapterAddress adapter = AdapterOf(graph, robot);
    leases_.Expect(robot, adapter.address, adapter.incarnation);
  }
}

void LeaseWatch::Look() {
  for (const FleetLeases::Lost& lost : leases_.TakeLost()) {
    WriteBatch batch = FactsOfLoss(lost.robot, lost.seen_us, dictionary_, *queries_.Newest());
    inbox_.Push(std::move(batch), [this, robot = lost.robot](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) spdlog::warn("{} has not renewed its lease: offline", robot);
      leases_.ToldLost(robot, outcome.ok());
    });
  }
}

}  // namespace docent::server
