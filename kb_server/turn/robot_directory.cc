#include "kb_server/turn/robot_directory.h"

#include <algorithm>

#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

std::string OneValue(const Dictionary& dictionary, const GraphVersion& version, TermId subject,
                     std::string_view predicate) {
  std::optional<TermId> id = dictionary.FindIri(predicate);
  if (!id) return "";
  std::optional<Term> first;
  version.ForEach({subject, *id, {}, {}}, [&](const Quad& quad) {
    Term term = dictionary.Decode(quad.object);
    if (!first || term < *first) first = std::move(term);
    return true;
  });
  return first ? first->lexical : "";
}

GraphRobotDirectory::GraphRobotDirectory(Dictionary* dictionary)
    : dictionary_(*dictionary),
      properties_{dictionary->InternIri(DocentIri("offers")), dictionary->InternIri(DocentIri("incarnation")),
                  dictionary->InternIri(DocentIri("status")),
                  dictionary->InternIri(DocentIri("idempotent"))} {}

void GraphRobotDirectory::Refresh(const GraphVersion& version, const Delta& delta) {
  auto concerns = [this](const Quad& quad) {
    return std::find(properties_.begin(), properties_.end(), quad.predicate) != properties_.end();
  };
  version_ = &version;
  changed_ = std::any_of(delta.added.begin(), delta.added.end(), concerns) ||
             std::any_of(delta.removed.begin(), delta.removed.end(), concerns);
  if (changed_) known_.clear();
}

const std::vector<RobotOffer>& GraphRobotDirectory::Offers(const std::string& operation) const {
  auto it = known_.find(operation);
  if (it == known_.end()) it = known_.emplace(operation, Read(operation)).first;
  return it->second;
}

std::vector<RobotOffer> GraphRobotDirectory::Read(const std::string& operation) const {
  std::vector<RobotOffer> offers;
  std::optional<TermId> offers_id = dictionary_.FindIri(DocentIri("offers"));
  std::optional<TermId> operation_id = dictionary_.FindIri(OperationIri(operation));
  if (!offers_id || !operation_id) return offers;
  bool idempotent = OneValue(dictionary_, *version_, *operation_id, DocentIri("idempotent")) == "true";
  TermId last;
  version_->ForEach({{}, *offers_id, *operation_id, {}}, [&](const Quad& quad) {
    if (quad.subject == last) return true;  // told in two graphs
    last = quad.subject;
    RobotOffer offer;
    offer.robot = RobotId(dictionary_.Decode(quad.subject).lexical);
    offer.incarnation = OneValue(dictionary_, *version_, quad.subject, DocentIri("incarnation"));
    offer.idempotent = idempotent;
    offer.offline =
        OneValue(dictionary_, *version_, quad.subject, DocentIri("status")) == DocentIri("Offline");
    offers.push_back(std::move(offer));
    return true;
  });
  std::sort(offers.begin(), offers.end(),
            [](const RobotOffer& a, const RobotOffer& b) { return a.robot < b.robot; });
  return offers;
}

}  // namespace docent
