#include "reasoner/explain/repair.h"

#include <algorithm>
#include <map>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"

namespace docent::explain {
namespace {

using sparql::PatternTerm;

constexpr size_t kValuesShown = 3;

// The objects that the graph has in place of the fact's object.
std::vector<Term> ValuesNow(const MissingFact& fact, const GraphVersion& version,
                            const Dictionary& dictionary) {
  std::vector<Term> now;
  if (fact.open[0] != MissingFact::kBound || fact.open[1] != MissingFact::kBound) return now;
  if (fact.terms[1] == dictionary.FindIri(kRdfType)) return now;
  TermId before;
  version.ForEach({fact.terms[0], fact.terms[1], TermId(), TermId()}, [&](const Quad& quad) {
    if (quad.object != before) now.push_back(dictionary.Decode(quad.object));
    before = quad.object;
    return now.size() <= kValuesShown;
  });
  std::sort(now.begin(), now.end());
  if (now.size() > kValuesShown) now.resize(kValuesShown);
  return now;
}

}  // namespace

std::vector<std::vector<Quad>> Repair::Withdrawals() const {
  std::vector<std::vector<Quad>> triples;
  for (const Quad& quad : remove) {
    const auto alike = std::find_if(triples.begin(), triples.end(), [&](const std::vector<Quad>& group) {
      return group[0].subject == quad.subject && group[0].predicate == quad.predicate &&
             group[0].object == quad.object;
    });
    if (alike == triples.end()) {
      triples.push_back({quad});
    } else {
      alike->push_back(quad);
    }
  }
  return triples;
}

OpenNames DistinctNames(const Solution& solution) {
  OpenNames names;
  std::set<std::string> used;
  std::map<int, std::string> ordered(solution.names.begin(), solution.names.end());
  for (const auto& [open, written] : ordered) {
    std::string name = written.empty() ? "x" : written;
    for (int n = 2; !used.insert(name).second; ++n) name = absl::StrCat(written.empty() ? "x" : written, n);
    names[open] = name;
  }
  return names;
}

sparql::TriplePattern PatternOf(const MissingFact& fact, const Dictionary& dictionary,
                                const OpenNames& names) {
  std::array<PatternTerm, 3> terms;
  for (int i = 0; i < 3; ++i) {
    terms[i] = fact.open[i] == MissingFact::kBound
                   ? PatternTerm::Of(dictionary.Decode(fact.terms[i]))
                   : PatternTerm::Of(sparql::Variable{names.at(fact.open[i])});
  }
  return {terms[0], terms[1], terms[2]};
}

std::string AbsenceText(const Absence& absence, const Row& row, const OpenNames& names,
                        const Dictionary& dictionary, const Display& display) {
  Values values = ValuesOf(row, dictionary, names);
  std::set<std::string> used;
  for (const auto& [open, name] : names) used.insert(name);
  for (const Clause& alternative : absence.alternatives) {
    for (size_t v = 0; v < alternative.names.size(); ++v) {
      const std::string& written = alternative.written[v];
      if (written.empty() || row.clause->Find(alternative.names[v]) >= 0 || values.contains(written))
        continue;
      std::string name = written;
      for (int n = 2; !used.insert(name).second; ++n) name = absl::StrCat(written, n);
      values.emplace(written, PatternTerm::Of(sparql::Variable{name}));
    }
  }
  return display.Pattern(*absence.source, values);
}

bool AddMissing(const Solution& solution, const Examples& examples, const OpenNames& names,
                const GraphVersion& version, Dictionary& dictionary, const Display& display, Repair& repair) {
  for (const MissingFact& fact : solution.missing) {
    ToTell& tell = repair.tell.emplace_back();
    tell.fact = PatternOf(fact, dictionary, names);
    Quad quad{fact.terms[0], fact.terms[1], fact.terms[2], fact.terms[3]};
    const std::array<TermId*, 4> places = {&quad.subject, &quad.predicate, &quad.object, &quad.graph};
    for (int i = 0; i < 4; ++i) {
      if (fact.open[i] != MissingFact::kBound) *places[i] = examples.at(fact.open[i]);
    }
    if (!quad.graph.IsNone()) tell.graph = dictionary.Decode(quad.graph);
    if (quad.graph.IsNone()) quad.graph = dictionary.InternIri(kDefaultGraph);
    if (quad.subject.IsLiteral() || !quad.predicate.IsIri()) return false;
    if (quad.graph == dictionary.FindIri(kInferredGraph)) return false;
    tell.now = ValuesNow(fact, version, dictionary);
    tell.example = {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                    dictionary.Decode(quad.object), dictionary.Decode(quad.graph)};
    repair.add.push_back(quad);
  }
  for (const OpenTest& test : solution.tests)
    repair.conditions.push_back(
        display.Filter(*test.test->expression, ValuesOf(test.row, dictionary, names)));
  return true;
}

}  // namespace docent::explain
