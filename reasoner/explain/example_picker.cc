#include "reasoner/explain/example_picker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/vocabulary.h"

namespace docent::explain {
namespace {

constexpr size_t kExampleTries = 500;  // combinations of example values

void CollectConstants(const sparql::Expression& e, std::vector<Term>& constants) {
  if (e.kind == sparql::Expression::Kind::kTerm) constants.push_back(e.term);
  for (const auto& argument : e.arguments) CollectConstants(*argument, constants);
}

// Values a little above and below a number, a date or a time.
void AddNear(const Term& term, std::vector<Term>& out) {
  const bool integer = term.datatype == kXsdInteger;
  double number = 0;
  if (integer || term.datatype == kXsdDecimal || term.datatype == kXsdDouble) {
    if (!absl::SimpleAtod(term.lexical, &number) || std::abs(number) > 1e9) return;
    for (const double step : {1.0, -1.0, 0.1, -0.1}) {
      const bool whole = integer && std::abs(step) == 1.0;
      out.push_back(whole ? Term::Integer(static_cast<int64_t>(number + step))
                          : Term::Literal(absl::StrFormat("%.4f", number + step), std::string(kXsdDecimal)));
    }
  }
  for (const char* format : {"%Y-%m-%dT%H:%M:%E*S%Ez", "%Y-%m-%dT%H:%M:%E*S", "%Y-%m-%d"}) {
    if (term.datatype != kXsdDateTime && term.datatype != kXsdDate) return;
    absl::Time time;
    if (!absl::ParseTime(format, term.lexical, &time, nullptr)) continue;
    for (const int days : {1, -1}) {
      out.push_back(Term::Literal(
          absl::FormatTime(format, time + days * absl::Hours(24), absl::UTCTimeZone()), term.datatype));
    }
    return;
  }
}

// Values likely to pass a string function: an IRI with that beginning, a text in that language.
void AddLike(const Term& term, std::vector<Term>& out) {
  const std::string& text = term.lexical;
  if (!term.IsLiteral() || !term.datatype.empty() || !term.language.empty()) return;
  if (IsValidTermIri(text)) out.push_back(Term::Iri(text + "example"));
  const auto letter = [](char c) { return absl::ascii_isalpha(static_cast<unsigned char>(c)) || c == '-'; };
  if (text.size() >= 2 && text.size() <= 8 && std::all_of(text.begin(), text.end(), letter))
    out.push_back(Term::LangString("example", absl::AsciiStrToLower(text)));
}

}  // namespace

// Candidate values of an open variable.
std::vector<TermId> ExamplePicker::CandidatesFor(int open, const std::string& name,
                                                 const Solution& solution) {
  std::vector<Term> terms;
  bool tested = false;
  for (const OpenTest& test : solution.tests) {
    const std::vector<int>& variables = test.test->variables;
    if (std::none_of(variables.begin(), variables.end(), [&](int v) { return test.row.open[v] == open; }))
      continue;
    tested = true;
    CollectConstants(*test.test->expression, terms);
    for (const int v : variables) {
      if (!test.row.values[v].IsNone()) terms.push_back(dictionary_.Decode(test.row.values[v]));
    }
  }
  std::vector<TermId> ids;
  const auto take = [&](const Term& term) {
    const TermId id = dictionary_.Intern(term);
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  };
  const Term fresh = Term::Iri(absl::StrCat("urn:docent:example:", name));
  if (!tested) take(fresh);
  std::vector<Term> near, like;
  for (const Term& term : terms) AddNear(term, near);
  for (const Term& term : terms) AddLike(term, like);
  for (const std::vector<Term>* some : std::array<const std::vector<Term>*, 3>{&near, &like, &terms}) {
    for (const Term& term : *some) take(term);
  }
  if (tested) {
    for (const MissingFact& fact : solution.missing) {
      if (fact.open[2] != open || fact.open[1] != MissingFact::kBound) continue;
      size_t looked = 0;
      version_.ForEach({TermId(), fact.terms[1], TermId(), TermId()}, [&](const Quad& quad) {
        if (std::find(ids.begin(), ids.end(), quad.object) == ids.end()) ids.push_back(quad.object);
        return ++looked < 20;
      });
    }
    take(fresh);
    take(Term::Integer(0));
    take(Term::Integer(1));
    take(Term::Boolean(true));
    take(Term::Boolean(false));
    take(Term::Literal("example"));
  }
  return ids;
}

// True also if a variable of the filter has no example yet.
bool ExamplePicker::LetsThrough(const OpenTest& test, const Examples& examples) {
  std::vector<TermId> row = test.row.values;
  for (const int v : test.test->variables) {
    if (!row[v].IsNone()) continue;
    const auto found = examples.find(test.row.open[v]);
    if (found == examples.end()) return true;
    row[v] = found->second;
  }
  return solver_.Holds(test, row);
}

bool ExamplePicker::PickFrom(const std::vector<int>& open, size_t at, const Solution& solution,
                             const absl::flat_hash_map<int, std::vector<TermId>>& candidates,
                             Examples& examples, size_t& tries) {
  if (++tries > kExampleTries) return false;
  for (const OpenTest& test : solution.tests) {
    if (!LetsThrough(test, examples)) return false;
  }
  if (at == open.size()) return true;
  for (const TermId id : candidates.at(open[at])) {
    examples[open[at]] = id;
    if (PickFrom(open, at + 1, solution, candidates, examples, tries)) return true;
    examples.erase(open[at]);
  }
  return false;
}

std::optional<Examples> ExamplePicker::Pick(const Solution& solution) {
  std::set<int> all;
  for (const MissingFact& fact : solution.missing) {
    for (int o : fact.open) {
      if (o != MissingFact::kBound) all.insert(o);
    }
  }
  Examples examples;
  const OpenNames names = DistinctNames(solution);
  absl::flat_hash_map<int, std::vector<TermId>> candidates;
  for (int o : all) {
    std::vector<TermId>& ids = candidates[o] = CandidatesFor(o, names.at(o), solution);
    // filters on this variable alone
    for (const OpenTest& test : solution.tests)
      std::erase_if(ids, [&](TermId id) { return !LetsThrough(test, {{o, id}}); });
    if (ids.empty()) return std::nullopt;
  }
  size_t tries = 0;
  if (!PickFrom({all.begin(), all.end()}, 0, solution, candidates, examples, tries)) return std::nullopt;
  return examples;
}

}  // namespace docent::explain
