#include "kb_server/robots/robot_directory.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/robots/capability_classes.h"
#include "kb_server/robots/operation_facts.h"
#include "kb_server/robots/reservations.h"

namespace docent::server {

GraphRobotDirectory::GraphRobotDirectory(Dictionary* dictionary)
    : dictionary_(*dictionary),
      address_(dictionary->InternIri(DocentIri("adapterAddress"))),
      incarnation_(dictionary->InternIri(DocentIri("incarnation"))),
      properties_{dictionary->InternIri(DocentIri("offers")),
                  incarnation_,
                  dictionary->InternIri(DocentIri("status")),
                  dictionary->InternIri(DocentIri("idempotent")),
                  dictionary->InternIri(DocentIri("input")),
                  dictionary->InternIri(DocentIri("inputsKnown")),
                  dictionary->InternIri(DocentIri("occupies")),
                  dictionary->InternIri(DocentIri("capability")),
                  dictionary->InternIri(DocentIri("reservedBy")),
                  dictionary->InternIri(DocentIri("reservedFor")),
                  dictionary->InternIri(DocentIri("reservationPriority")),
                  dictionary->InternIri(DocentIri("reservedAt")),
                  dictionary->InternIri(DocentIri("reservedUntil")),
                  dictionary->InternIri(Concat(kRdfsNs, "subClassOf")),
                  dictionary->InternIri(Concat(kOwlNs, "equivalentClass")),
                  dictionary->InternIri(DocentIri("outOfService"))} {}

void GraphRobotDirectory::Refresh(const GraphVersion& version, const Delta& delta) {
  auto concerns = [this](const Quad& quad) {
    return std::find(properties_.begin(), properties_.end(), quad.predicate) != properties_.end();
  };
  version_ = &version;
  changed_ = std::any_of(delta.added.begin(), delta.added.end(), concerns) ||
             std::any_of(delta.removed.begin(), delta.removed.end(), concerns);
  if (changed_) Forget();
}

const std::vector<engine::RobotOffer>& GraphRobotDirectory::Offers(const std::string& operation) const {
  auto it = known_.find(operation);
  if (it == known_.end()) it = known_.emplace(operation, Read(operation)).first;
  return it->second;
}

const std::vector<engine::Reservation>& GraphRobotDirectory::ReservationsOf(const RobotId& robot) const {
  static const std::vector<engine::Reservation> kNone;
  if (!reservations_) {
    reservations_.emplace();
    for (const engine::Reservation& reservation : ReadReservations(dictionary_, *version_)) {
      for (const RobotId& kept : reservation.robots) (*reservations_)[kept].push_back(reservation);
    }
  }
  const auto of_robot = reservations_->find(robot);
  return of_robot == reservations_->end() ? kNone : of_robot->second;
}

// Every teller of a status counts: an operator may take a robot out of service.
void GraphRobotDirectory::ReadStatus(TermId robot, engine::RobotOffer* offer) const {
  const std::optional<TermId> property = dictionary_.FindIri(DocentIri("status"));
  if (!property) return;
  version_->ForEach({robot, *property, {}, {}}, [&](const Quad& quad) {
    const std::string status = dictionary_.Decode(quad.object).lexical;
    if (status == DocentIri("Offline")) offer->offline = true;
    if (status == DocentIri("Busy")) offer->busy = true;
    for (const auto& [name, why] :
         {std::pair("Charging", "is charging"), {"Maintenance", "is in maintenance"}}) {
      if (status == DocentIri(name))
        offer->out_of_service = std::max<std::string>(offer->out_of_service, why);
    }
    return true;
  });
  if (const std::optional<TermId> out = dictionary_.FindIri(DocentIri("outOfService"))) {
    std::optional<std::string>
        reason;  // of several the first in the order of texts: that of ids is another one after a start
    version_->ForEach({robot, *out, {}, {}}, [&](const Quad& quad) {
      std::string other = dictionary_.Decode(quad.object).lexical;
      if (!reason || other < *reason) reason = std::move(other);
      return true;
    });
    if (reason) offer->out_of_service = absl::StrCat("is out of service: ", *reason);
  }
}

std::vector<AdapterAddress> GraphRobotDirectory::AddressesIn(const Delta& delta,
                                                             const GraphVersion& version) const {
  std::set<TermId> robots;
  for (const Quad& quad : delta.added) {
    if (quad.predicate == address_ || quad.predicate == incarnation_) robots.insert(quad.subject);
  }
  std::vector<AdapterAddress> addresses;
  const GraphReader graph(dictionary_, version);
  for (const TermId robot : robots) {
    AdapterAddress adapter = AdapterOf(graph, dictionary_.Decode(robot).lexical);
    if (!adapter.address.empty()) addresses.push_back(std::move(adapter));
  }
  return addresses;
}

std::vector<engine::RobotOffer> GraphRobotDirectory::Read(const std::string& operation) const {
  if (const auto iri = engine::CapabilityOf(operation)) return ReadCapability(*iri);
  const std::optional<TermId> id = dictionary_.FindIri(OperationIri(operation));
  return id ? ReadOperation(*id) : std::vector<engine::RobotOffer>();
}

std::vector<engine::RobotOffer> GraphRobotDirectory::ReadOperation(TermId operation) const {
  std::vector<engine::RobotOffer> offers;
  const std::optional<TermId> offers_id = dictionary_.FindIri(DocentIri("offers"));
  if (!offers_id) return offers;
  const GraphReader graph(dictionary_, *version_);
  const std::string iri = dictionary_.Decode(operation).lexical;
  TermId last;
  version_->ForEach({{}, *offers_id, operation, {}}, [&](const Quad& quad) {
    if (quad.subject == last) return true;  // told in two graphs
    last = quad.subject;
    engine::RobotOffer offer;
    offer.robot = RobotId(dictionary_.Decode(quad.subject).lexical);
    offer.incarnation = AdapterOf(graph, offer.robot.value()).incarnation;
    ReadStatus(quad.subject, &offer);
    const OperationFacts facts(graph, offer.robot.value(), iri);
    offer.idempotent = facts.Idempotent();
    offer.occupies = facts.Occupies();
    offer.inputs = facts.Inputs();
    if (offer.inputs) offer.input_types = facts.InputTypes();
    offers.push_back(std::move(offer));
    return true;
  });
  std::sort(offers.begin(), offers.end(),
            [](const engine::RobotOffer& a, const engine::RobotOffer& b) { return a.robot < b.robot; });
  return offers;
}

// What each robot says of its own operations, in its own graph. Of several operations of one robot, the one whose class has the
// fewest classes above it comes first: the most general does no more than what is asked for.
std::vector<engine::RobotOffer> GraphRobotDirectory::ReadCapability(std::string_view iri) const {
  const std::optional<TermId> wanted = dictionary_.FindIri(iri),
                              property = dictionary_.FindIri(DocentIri("capability"));
  if (!wanted || !property) return {};
  std::map<TermId, size_t> classes;  // those below `wanted`, and itself → how many stand above it
  std::map<TermId, std::map<TermId, size_t>> operations;  // → by robot, the smallest of these numbers
  version_->ForEach({{}, *property, {}, {}}, [&](const Quad& quad) {
    auto known = classes.find(quad.object);
    if (known == classes.end()) {
      const std::set<TermId> above = ClassesAbove(dictionary_, *version_, quad.object);
      known = classes.emplace(quad.object, above.contains(*wanted) ? above.size() : 0).first;
    }
    if (known->second == 0) return true;
    const auto [robot, is_new] = operations[quad.subject].emplace(quad.graph, known->second);
    if (!is_new) robot->second = std::min(robot->second, known->second);
    return true;
  });
  using Ranked = std::pair<size_t, engine::RobotOffer>;
  std::vector<Ranked> ranked;
  for (const auto& [operation, robots] : operations) {
    const std::optional<std::string> name = OperationOfIri(dictionary_.Decode(operation).lexical);
    if (!name) continue;
    for (engine::RobotOffer& offer : ReadOperation(operation)) {
      const std::optional<TermId> robot = dictionary_.FindIri(offer.robot.value());
      const auto said = robot ? robots.find(*robot) : robots.end();
      if (said == robots.end()) continue;
      offer.operation = *name;
      ranked.emplace_back(said->second, std::move(offer));
    }
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return std::tie(a.second.robot, a.first, a.second.operation) <
           std::tie(b.second.robot, b.first, b.second.operation);
  });
  std::vector<engine::RobotOffer> offers;
  for (Ranked& offer : ranked) offers.push_back(std::move(offer.second));
  return offers;
}

}  // namespace docent::server
