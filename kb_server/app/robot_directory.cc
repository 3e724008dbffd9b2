#include "kb_server/app/robot_directory.h"

#include <algorithm>

#include "kb_server/base/text.h"
#include "kb_server/rdf/vocabulary.h"

namespace docent {

std::string OperationIri(std::string_view name) { return Concat("urn:docent:operation:", name); }

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

std::vector<RobotOffer> GraphRobotDirectory::Offers(const std::string& operation) const {
  std::vector<RobotOffer> offers;
  std::optional<TermId> offers_id = dictionary_.FindIri(DocentIri("offers"));
  std::optional<TermId> operation_id = dictionary_.FindIri(OperationIri(operation));
  if (!offers_id || !operation_id) return offers;
  bool idempotent = OneValue(dictionary_, version_, *operation_id, DocentIri("idempotent")) == "true";
  TermId last;
  version_.ForEach({{}, *offers_id, *operation_id, {}}, [&](const Quad& quad) {
    if (quad.subject == last) return true;  // told in two graphs
    last = quad.subject;
    RobotOffer offer;
    offer.robot = RobotId(dictionary_.Decode(quad.subject).lexical);
    offer.incarnation = OneValue(dictionary_, version_, quad.subject, DocentIri("incarnation"));
    offer.idempotent = idempotent;
    offer.offline = OneValue(dictionary_, version_, quad.subject, DocentIri("status")) == DocentIri("Offline");
    offers.push_back(std::move(offer));
    return true;
  });
  std::sort(offers.begin(), offers.end(), [](const RobotOffer& a, const RobotOffer& b) { return a.robot < b.robot; });
  return offers;
}

}  // namespace docent
