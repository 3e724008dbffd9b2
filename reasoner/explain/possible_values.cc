#include "reasoner/explain/possible_values.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"

namespace docent::explain {
namespace {

class ValueChecker {
 public:
  ValueChecker(const Repair& repair, const GraphVersion& version, const Dictionary& dictionary)
      : repair_(repair), version_(version), dictionary_(dictionary), type_(dictionary.FindIri(kRdfType)) {}

  bool IsPossible(const Quad& told) const {
    if (IsA(told.predicate, DocentIri("StateProperty")) && NeedsAnother(told)) return false;
    if (IsA(told.predicate, Concat(kOwlNs, "FunctionalProperty")) &&
        (TellsAnother(told, false) || HasAnother({told.subject, told.predicate, {}, {}}, told)))
      return false;
    return !IsA(told.predicate, Concat(kOwlNs, "InverseFunctionalProperty")) ||
           !HasAnother({{}, told.predicate, told.object, {}}, told);
  }

 private:
  bool IsA(TermId property, const std::string& type) const {
    const std::optional<TermId> id = dictionary_.FindIri(type);
    return type_ && id && version_.ContainsMatch({property, *type_, *id, {}});
  }
  // Another value of the same subject, of the same source where `of_source`.
  bool TellsAnother(const Quad& told, bool of_source) const {
    return std::any_of(repair_.add.begin(), repair_.add.end(), [&](const Quad& other) {
      return other.subject == told.subject && other.predicate == told.predicate &&
             other.object != told.object && (!of_source || other.graph == told.graph);
    });
  }
  // It is told, or what holds of the match has it.
  bool NeedsAnother(const Quad& told) const {
    if (TellsAnother(told, true)) return true;
    return std::any_of(repair_.holds.begin(), repair_.holds.end(), [&](const TermQuad& fact) {
      const auto subject = dictionary_.Find(fact.subject), predicate = dictionary_.Find(fact.predicate),
                 object = dictionary_.Find(fact.object);
      if (!subject || !predicate || !object) return false;
      return *subject == told.subject && *predicate == told.predicate && *object != told.object &&
             version_.ContainsMatch({*subject, *predicate, *object, told.graph}) &&
             version_.Count({*subject, *predicate, *object, {}}) == 1;
    });
  }
  // The graph has it, and the repair does not withdraw it.
  bool HasAnother(const QuadPattern& pattern, const Quad& told) const {
    bool found = false;
    version_.ForEach(pattern, [&](const Quad& quad) {
      const bool same = quad.subject == told.subject && quad.object == told.object;
      const bool goes = std::find(repair_.remove.begin(), repair_.remove.end(), quad) != repair_.remove.end();
      found = !same && !goes;
      return !found;
    });
    return found;
  }

  const Repair& repair_;
  const GraphVersion& version_;
  const Dictionary& dictionary_;
  const std::optional<TermId> type_;
};

}  // namespace

bool HasPossibleValues(const Repair& repair, const GraphVersion& version, const Dictionary& dictionary) {
  const ValueChecker checker(repair, version, dictionary);
  return std::all_of(repair.add.begin(), repair.add.end(),
                     [&](const Quad& told) { return checker.IsPossible(told); });
}

}  // namespace docent::explain
