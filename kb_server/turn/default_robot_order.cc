#include "kb_server/turn/default_robot_order.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/number.h"
#include "graph/sparql/values/value.h"

namespace docent::server {
namespace {

// What the default query orders by, where no distance counts. None: unbound.
struct Candidate {
  size_t place = 0;  // in `able`
  std::string_view iri;
  TermId charge, load, used;
};

int Compare(TermId a, TermId b, const Dictionary& dictionary) {
  if (a.IsNone() || b.IsNone()) return static_cast<int>(b.IsNone()) - static_cast<int>(a.IsNone());
  if (const auto order = sparql::CompareForOrder(a, b, dictionary)) return *order;
  return sparql::CompareForOrder(sparql::Value::OfId(a, dictionary), sparql::Value::OfId(b, dictionary));
}

// Reads properties of one version.
class Reader {
 public:
  Reader(const GraphVersion& version, const Dictionary& dictionary)
      : version_(version), dictionary_(dictionary) {}

  std::optional<TermId> Find(std::string_view name) const { return dictionary_.FindIri(DocentIri(name)); }
  bool Has(TermId subject, const std::optional<TermId>& predicate, TermId object = {}) const {
    return predicate && version_.ContainsMatch({subject, *predicate, object, {}});
  }
  // None: there is no value. Sets *several where there are several.
  TermId Value(TermId subject, const std::optional<TermId>& predicate, bool* several) {
    if (!predicate) return {};
    version_.Rescan({subject, *predicate, {}, {}}, &cursor_);
    if (!cursor_.Valid()) return {};
    const TermId value = cursor_.term(2);
    cursor_.NextTriple();
    *several = *several || cursor_.Valid();
    return value;
  }

 private:
  const GraphVersion& version_;
  const Dictionary& dictionary_;
  QuadCursor cursor_;
};

}  // namespace

std::optional<std::vector<RobotId>> DefaultRobotOrder(const GraphVersion& version,
                                                      const Dictionary& dictionary,
                                                      std::optional<TermId> goal,
                                                      const std::vector<RobotId>& able) {
  Reader reader(version, dictionary);
  if (goal && (reader.Has(*goal, reader.Find("x")) || reader.Has(*goal, reader.Find("servicePoint"))))
    return std::nullopt;
  const std::optional<TermId> type = dictionary.FindIri(kRdfType), robot_class = reader.Find("Robot");
  const std::optional<TermId> battery = reader.Find("battery"), tasks = reader.Find("load"),
                              last_used = reader.Find("lastUsed");
  const TermId zero = *InlineIntegerId(0);
  std::vector<Candidate> named;
  std::vector<RobotId> others;
  bool several = false;
  for (size_t i = 0; i < able.size(); ++i) {
    const std::optional<TermId> robot = dictionary.FindIri(able[i].value());
    if (!robot || !robot_class || !reader.Has(*robot, type, *robot_class)) {
      others.push_back(able[i]);
      continue;
    }
    Candidate candidate{i, able[i].value(), reader.Value(*robot, battery, &several),
                        reader.Value(*robot, tasks, &several), reader.Value(*robot, last_used, &several)};
    if (several) return std::nullopt;
    if (candidate.load.IsNone()) candidate.load = zero;
    named.push_back(candidate);
  }
  std::sort(named.begin(), named.end(), [&](const Candidate& a, const Candidate& b) {
    if (const int order = Compare(b.charge, a.charge, dictionary)) return order < 0;
    if (const int order = Compare(a.load, b.load, dictionary)) return order < 0;
    if (const int order = Compare(a.used, b.used, dictionary)) return order < 0;
    return a.iri < b.iri;
  });
  std::vector<RobotId> ordered;
  ordered.reserve(able.size());
  for (const Candidate& candidate : named) ordered.push_back(able[candidate.place]);
  ordered.insert(ordered.end(), others.begin(), others.end());
  return ordered;
}

}  // namespace docent::server
