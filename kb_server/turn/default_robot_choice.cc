#include "kb_server/turn/default_robot_choice.h"

#include <string>
#include <utility>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/number.h"
#include "graph/sparql/values/value.h"

namespace docent::server {

DefaultRobotChoice::DefaultRobotChoice(Dictionary* dictionary)
    : dictionary_(*dictionary),
      type_(dictionary->InternIri(kRdfType)),
      robot_(dictionary->InternIri(DocentIri("Robot"))),
      battery_(dictionary->InternIri(DocentIri("battery"))),
      load_(dictionary->InternIri(DocentIri("load"))),
      last_used_(dictionary->InternIri(DocentIri("lastUsed"))),
      x_(dictionary->InternIri(DocentIri("x"))),
      service_point_(dictionary->InternIri(DocentIri("servicePoint"))) {}

void DefaultRobotChoice::Refresh(const Delta& delta) {
  if (known_.empty()) return;
  for (const std::vector<Quad>* quads : {&delta.added, &delta.removed}) {
    for (const Quad& quad : *quads) {
      const bool is_read = quad.predicate == load_ || quad.predicate == last_used_ ||
                           quad.predicate == battery_ || (quad.predicate == type_ && quad.object == robot_);
      if (is_read && quad.subject.IsIri())
        known_.erase(RobotId(std::string(dictionary_.Lexical(quad.subject))));
    }
  }
}

bool DefaultRobotChoice::Has(const GraphVersion& version, TermId subject, TermId predicate,
                             TermId object) const {
  return version.ContainsMatch({subject, predicate, object, {}});
}

const DefaultRobotChoice::Standing& DefaultRobotChoice::Of(const RobotId& robot,
                                                           const GraphVersion& version) {
  const auto [entry, is_new] = known_.try_emplace(robot);
  Standing& standing = entry->second;
  if (!is_new) return standing;
  const std::optional<TermId> id = dictionary_.FindIri(robot.value());
  standing.is_robot = id && Has(version, *id, type_, robot_);
  if (!standing.is_robot) return standing;
  QuadCursor cursor;
  for (const auto& [predicate, value] :
       {std::pair(battery_, &standing.charge), {load_, &standing.load}, {last_used_, &standing.used}}) {
    version.Rescan({*id, predicate, {}, {}}, &cursor);
    if (!cursor.Valid()) continue;
    *value = cursor.term(2);
    cursor.NextTriple();
    standing.several = standing.several || cursor.Valid();
  }
  if (standing.load.IsNone()) standing.load = *InlineIntegerId(0);
  return standing;
}

int DefaultRobotChoice::Compare(TermId a, TermId b) const {
  if (a == b) return 0;
  if (a.IsNone() || b.IsNone()) return static_cast<int>(b.IsNone()) - static_cast<int>(a.IsNone());
  if (const auto order = sparql::CompareForOrder(a, b, dictionary_)) return *order;
  return sparql::CompareForOrder(sparql::Value::OfId(a, dictionary_), sparql::Value::OfId(b, dictionary_));
}

bool DefaultRobotChoice::IsBefore(const Standing& a, const RobotId& of_a, const Standing& b,
                                  const RobotId& of_b) const {
  if (const int order = Compare(b.charge, a.charge)) return order < 0;
  if (const int order = Compare(a.load, b.load)) return order < 0;
  if (const int order = Compare(a.used, b.used)) return order < 0;
  return of_a < of_b;
}

std::optional<RobotId> DefaultRobotChoice::Best(const GraphVersion& version, std::optional<TermId> goal,
                                                const std::vector<RobotId>& able) {
  if (goal && (Has(version, *goal, x_) || Has(version, *goal, service_point_))) return std::nullopt;
  Standing best;
  const RobotId* best_robot = nullptr;
  for (const RobotId& robot : able) {
    const Standing& standing = Of(robot, version);
    if (!standing.is_robot) continue;
    if (standing.several) return std::nullopt;
    if (best_robot != nullptr && !IsBefore(standing, robot, best, *best_robot)) continue;
    best = standing;
    best_robot = &robot;
  }
  return best_robot != nullptr ? *best_robot : able.front();
}

}  // namespace docent::server
