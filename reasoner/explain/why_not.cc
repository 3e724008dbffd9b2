#include "reasoner/explain/why_not.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "kb_server/rdf/vocabulary.h"
#include "reasoner/explain/display.h"
#include "reasoner/matching/trigger_analysis.h"

namespace docent::explain {
namespace {

using sparql::PatternTerm;

constexpr size_t kCandidates = 500;      // partial matches of one size that are looked at
constexpr size_t kExampleTries = 500;    // combinations of example values
constexpr size_t kValuesShown = 3;
constexpr size_t kSubsetsUpTo = 5;       // changes; of larger sets only those without one change are tried
constexpr int kWaysTried = 64;           // choices of what to withdraw for one set

sparql::TriplePattern PatternOf(const MissingFact& fact, const Dictionary& dictionary,
                                const absl::flat_hash_map<int, std::string>& names) {
  std::array<PatternTerm, 3> terms;
  for (int i = 0; i < 3; ++i) {
    terms[i] = fact.open[i] == MissingFact::kBound
                   ? PatternTerm::Of(dictionary.Decode(fact.terms[i]))
                   : PatternTerm::Of(sparql::Variable{names.at(fact.open[i])});
  }
  return {terms[0], terms[1], terms[2]};
}

// Each open variable gets a name of its own.
absl::flat_hash_map<int, std::string> DistinctNames(const Solution& solution) {
  absl::flat_hash_map<int, std::string> names;
  std::set<std::string> used;
  std::map<int, std::string> ordered(solution.names.begin(), solution.names.end());
  for (const auto& [open, written] : ordered) {
    std::string name = written.empty() ? "x" : written;
    for (int n = 2; !used.insert(name).second; ++n) name = absl::StrCat(written.empty() ? "x" : written, n);
    names[open] = name;
  }
  return names;
}

// "{ expo:R01 docent:task ?t }"; variables of its own are not called as others are.
std::string AbsenceText(const Absence& absence, const Row& row, const absl::flat_hash_map<int, std::string>& names,
                        const Dictionary& dictionary, const Display& display) {
  Values values = ValuesOf(row, dictionary, names);
  std::set<std::string> used;
  for (const auto& [open, name] : names) used.insert(name);
  for (const Clause& alternative : absence.alternatives) {
    for (size_t v = 0; v < alternative.names.size(); ++v) {
      const std::string& written = alternative.written[v];
      if (written.empty() || row.clause->Find(alternative.names[v]) >= 0 || values.contains(written)) continue;
      std::string name = written;
      for (int n = 2; !used.insert(name).second; ++n) name = absl::StrCat(written, n);
      values.emplace(written, PatternTerm::Of(sparql::Variable{name}));
    }
  }
  return display.Pattern(*absence.source, values);
}

// How many of its facts would change what a thing is.
size_t KindChanges(const Repair& repair) {
  return static_cast<size_t>(std::count_if(repair.tell.begin(), repair.tell.end(), [](const ToTell& tell) {
    return !tell.fact.predicate.IsVariable() && tell.fact.predicate.term().lexical == kRdfType;
  }));
}

void CollectConstants(const sparql::Expression& e, std::vector<Term>& constants) {
  if (e.kind == sparql::Expression::Kind::kTerm) constants.push_back(e.term);
  for (const auto& argument : e.arguments) CollectConstants(*argument, constants);
}

}  // namespace

WhyNotFinder::WhyNotFinder(Parts parts)
    : parts_(std::move(parts)),
      solver_(*parts_.version, *parts_.dictionary, parts_.functions, parts_.run, parts_.limits.explain_steps) {}

absl::StatusOr<bool> WhyNotFinder::MakesTrue(const std::vector<Quad>& add, const std::vector<Quad>& remove) {
  bool holds = false;
  absl::Status status = parts_.hypothesis->With(add, remove, [&](const GraphVersion& graph, const Delta&) {
    sparql::RunOptions run = parts_.run;
    run.version = &graph;
    auto answer = ask_->Ask(run);
    if (!answer.ok()) return answer.status();
    holds = *answer;
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return holds;
}

// Values to try an open variable with.
std::vector<TermId> WhyNotFinder::CandidatesFor(int open, const std::string& name, const Solution& solution) {
  std::vector<Term> terms;
  bool tested = false;
  for (const OpenTest& test : solution.tests) {
    const std::vector<int>& variables = test.test->variables;
    if (std::none_of(variables.begin(), variables.end(), [&](int v) { return test.row.open[v] == open; })) continue;
    tested = true;
    CollectConstants(*test.test->expression, terms);
    for (const int v : variables) {
      if (!test.row.values[v].IsNone()) terms.push_back(parts_.dictionary->Decode(test.row.values[v]));
    }
  }
  std::vector<TermId> ids;
  const auto take = [&](const Term& term) {
    const TermId id = parts_.dictionary->Intern(term);
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  };
  const Term fresh = Term::Iri(absl::StrCat("urn:docent:example:", name));
  if (!tested) take(fresh);
  for (const Term& term : terms) {
    const bool integer = term.datatype == kXsdInteger;
    if (!integer && term.datatype != kXsdDecimal && term.datatype != kXsdDouble) continue;
    double number = 0;
    if (!absl::SimpleAtod(term.lexical, &number) || std::abs(number) > 1e9) continue;
    for (const double step : {1.0, -1.0, 0.1, -0.1}) {  // a little above and below
      const bool whole = integer && std::abs(step) == 1.0;
      take(whole ? Term::Integer(static_cast<int64_t>(number + step))
                 : Term::Literal(absl::StrFormat("%.4f", number + step), std::string(kXsdDecimal)));
    }
  }
  for (const Term& term : terms) take(term);
  if (tested) {
    for (const MissingFact& fact : solution.missing) {
      if (fact.open[2] != open || fact.open[1] != MissingFact::kBound) continue;
      size_t looked = 0;
      parts_.version->ForEach({TermId(), fact.terms[1], TermId(), TermId()}, [&](const Quad& quad) {
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

// True also where a variable of the filter has no example yet.
bool WhyNotFinder::LetsThrough(const OpenTest& test, const Examples& examples) {
  std::vector<TermId> row = test.row.values;
  for (const int v : test.test->variables) {
    if (!row[v].IsNone()) continue;
    const auto found = examples.find(test.row.open[v]);
    if (found == examples.end()) return true;
    row[v] = found->second;
  }
  return solver_.Holds(test, row);
}

bool WhyNotFinder::PickFrom(const std::vector<int>& open, size_t at, const Solution& solution,
                            const absl::flat_hash_map<int, std::vector<TermId>>& candidates, Examples& examples,
                            size_t& tries) {
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

bool WhyNotFinder::PickExamples(const Solution& solution, Examples& examples) {
  std::set<int> all;
  for (const MissingFact& fact : solution.missing) {
    for (int o : fact.open) {
      if (o != MissingFact::kBound) all.insert(o);
    }
  }
  const auto names = DistinctNames(solution);
  absl::flat_hash_map<int, std::vector<TermId>> candidates;
  for (int o : all) {
    std::vector<TermId>& ids = candidates[o] = CandidatesFor(o, names.at(o), solution);
    // filters on this variable alone
    for (const OpenTest& test : solution.tests)
      std::erase_if(ids, [&](TermId id) { return !LetsThrough(test, {{o, id}}); });
    if (ids.empty()) return false;
  }
  size_t tries = 0;
  return PickFrom({all.begin(), all.end()}, 0, solution, candidates, examples, tries);
}

// Other objects that the graph has where the fact would stand.
std::vector<Term> WhyNotFinder::ValuesNow(const MissingFact& fact) const {
  std::vector<Term> now;
  if (fact.open[0] != MissingFact::kBound || fact.open[1] != MissingFact::kBound) return now;
  if (fact.terms[1] == parts_.dictionary->FindIri(kRdfType)) return now;
  TermId before;
  parts_.version->ForEach({fact.terms[0], fact.terms[1], TermId(), TermId()}, [&](const Quad& quad) {
    if (quad.object != before) now.push_back(parts_.dictionary->Decode(quad.object));
    before = quad.object;
    return now.size() <= kValuesShown;
  });
  std::sort(now.begin(), now.end());
  if (now.size() > kValuesShown) now.resize(kValuesShown);
  return now;
}

// False: not one that can be tried.
absl::StatusOr<bool> WhyNotFinder::Make(const Solution& solution, Repair& repair) {
  Dictionary& dictionary = *parts_.dictionary;
  const Display display(parts_.prefixes);
  Examples examples;
  if (!PickExamples(solution, examples)) return false;
  const auto names = DistinctNames(solution);
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
    tell.now = ValuesNow(fact);
    tell.example = {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                    dictionary.Decode(quad.object), dictionary.Decode(quad.graph)};
    repair.add.push_back(quad);
  }
  for (const Blocker& blocker : solution.blockers) {
    // the one that a change of state would take away: the last that is not about what a thing is
    const TermId type = dictionary.InternIri(kRdfType);
    const Quad* fact = nullptr;
    for (const Quad& quad : blocker.facts) {
      if (fact == nullptr || quad.predicate != type) fact = &quad;
    }
    if (fact == nullptr) return false;  // nothing that could be withdrawn
    InTheWay& way = repair.in_the_way.emplace_back();
    way.fact = {dictionary.Decode(fact->subject), dictionary.Decode(fact->predicate),
                dictionary.Decode(fact->object), Term()};
    way.absence = AbsenceText(*blocker.absence, blocker.row, names, dictionary, display);
  }
  for (const Quad& quad : solution.facts) {
    TermQuad fact{dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                  dictionary.Decode(quad.object), Term()};
    if (std::find(repair.holds.begin(), repair.holds.end(), fact) == repair.holds.end())
      repair.holds.push_back(std::move(fact));
  }
  for (const Inference& inference : solution.inferences) {
    repair.inferred.emplace_back(parts_.rules->rules()[inference.rule].label,
                                 PatternOf(inference.fact, dictionary, names));
  }
  const Clause& clause = *solution.row.clause;
  for (size_t v = 0; v < clause.names.size(); ++v) {
    if (clause.written[v].empty() || solution.row.values[v].IsNone()) continue;
    repair.bindings.emplace_back(clause.written[v], dictionary.Decode(solution.row.values[v]));
  }
  for (const OpenTest& test : solution.tests)
    repair.conditions.push_back(display.Filter(*test.test->expression, ValuesOf(test.row, dictionary, names)));
  for (const OpenAbsence& open : solution.absences) {
    repair.conditions.push_back(
        absl::StrCat("there is no ", AbsenceText(*open.absence, open.row, names, dictionary, display)));
  }
  return true;
}

// Ways to make a fact go: what tells it; of an inferred one, each told fact of its proof, a state before what things
// are.
absl::StatusOr<std::vector<std::vector<Quad>>> WhyNotFinder::WaysToRemove(const Quad& fact) {
  Dictionary& dictionary = *parts_.dictionary;
  const auto told_quads = [&](const Quad& of) {
    std::vector<Quad> quads;
    const TermId inferred = dictionary.InternIri(kInferredGraph);
    parts_.version->ForEach({of.subject, of.predicate, of.object, TermId()}, [&](const Quad& quad) {
      if (quad.graph != inferred) quads.push_back(quad);
      return true;
    });
    return quads;
  };
  std::vector<std::vector<Quad>> ways;
  if (std::vector<Quad> told = told_quads(fact); !told.empty()) {
    ways.push_back(std::move(told));
    return ways;
  }
  auto support = parts_.prover->ToldSupport(fact);
  if (!support.ok()) return support.status();
  for (const Quad& quad : *support) {
    std::vector<Quad> way = told_quads(quad);
    if (std::find(ways.begin(), ways.end(), way) == ways.end()) ways.push_back(std::move(way));
  }
  const auto rank = [&](const std::vector<Quad>& way) {
    const bool state = IsState({PatternTerm::Of(dictionary.Decode(way[0].subject)),
                                PatternTerm::Of(dictionary.Decode(way[0].predicate)),
                                PatternTerm::Of(dictionary.Decode(way[0].object))});
    return state ? 0 : way[0].predicate == dictionary.FindIri(kRdfType) ? 2 : 1;
  };
  std::stable_sort(ways.begin(), ways.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return ways;
}

// Finds what to withdraw for the facts in the way, and tries the whole.
absl::StatusOr<bool> WhyNotFinder::Check(Repair& repair) {
  const Dictionary& dictionary = *parts_.dictionary;
  std::vector<std::vector<std::vector<Quad>>> ways;
  for (const InTheWay& way : repair.in_the_way) {
    auto found = WaysToRemove({*dictionary.Find(way.fact.subject), *dictionary.Find(way.fact.predicate),
                               *dictionary.Find(way.fact.object), TermId()});
    if (!found.ok()) return found.status();
    if (found->empty()) return false;
    ways.push_back(*std::move(found));
  }
  std::vector<size_t> choice(ways.size(), 0);
  for (int tried = 0; tried < kWaysTried; ++tried) {
    repair.remove.clear();
    for (size_t i = 0; i < ways.size(); ++i) {
      for (const Quad& quad : ways[i][choice[i]]) {
        if (std::find(repair.remove.begin(), repair.remove.end(), quad) == repair.remove.end())
          repair.remove.push_back(quad);
      }
    }
    auto works = MakesTrue(repair.add, repair.remove);
    if (!works.ok()) return works;
    if (*works) {
      auto minimal = IsMinimal(repair);
      if (!minimal.ok()) return minimal;
      if (*minimal) {
        for (size_t i = 0; i < ways.size(); ++i) {
          for (const Quad& quad : ways[i][choice[i]])
            repair.in_the_way[i].withdraw.push_back({dictionary.Decode(quad.subject),
                                                     dictionary.Decode(quad.predicate),
                                                     dictionary.Decode(quad.object), dictionary.Decode(quad.graph)});
        }
        return true;
      }
    }
    size_t digit = 0;
    while (digit < ways.size() && ++choice[digit] == ways[digit].size()) choice[digit++] = 0;
    if (digit == ways.size()) return false;
  }
  return false;
}

// Whether no proper subset does it, too. Tellings of one triple in several graphs count as one change.
absl::StatusOr<bool> WhyNotFinder::IsMinimal(const Repair& repair) {
  std::vector<std::vector<Quad>> removals;
  for (const Quad& quad : repair.remove) {
    const auto alike = std::find_if(removals.begin(), removals.end(), [&](const std::vector<Quad>& group) {
      return group[0].subject == quad.subject && group[0].predicate == quad.predicate &&
             group[0].object == quad.object;
    });
    if (alike == removals.end()) {
      removals.push_back({quad});
    } else {
      alike->push_back(quad);
    }
  }
  const size_t count = repair.add.size() + removals.size();
  const uint32_t full = (1u << count) - 1;
  for (uint32_t subset = 1; subset < full; ++subset) {
    if (count > kSubsetsUpTo && static_cast<size_t>(__builtin_popcount(subset)) + 1 != count) continue;
    std::vector<Quad> add, remove;
    for (size_t i = 0; i < count; ++i) {
      if ((subset >> i & 1) == 0) continue;
      if (i < repair.add.size()) {
        add.push_back(repair.add[i]);
      } else {
        const auto& group = removals[i - repair.add.size()];
        remove.insert(remove.end(), group.begin(), group.end());
      }
    }
    auto holds = MakesTrue(add, remove);
    if (!holds.ok()) return holds;
    if (*holds) return false;
  }
  return true;
}

bool WhyNotFinder::IsState(const sparql::TriplePattern& fact) const {
  if (fact.predicate.IsVariable()) return false;
  const auto property = parts_.dictionary->Find(fact.predicate.term());
  const auto type = parts_.dictionary->FindIri(kRdfType);
  const auto state = parts_.dictionary->FindIri(DocentIri("StateProperty"));
  return property && type && state && parts_.version->Count({*property, *type, *state, TermId()}) > 0;
}

// Fewest changes; then what can change (state) before what things are; then what differs from a value that is there;
// then by text.
void WhyNotFinder::Rank(std::vector<Repair>& repairs) const {
  const Display display(parts_.prefixes);
  using Key = std::tuple<size_t, size_t, size_t, size_t, size_t, std::string>;
  std::vector<std::pair<Key, Repair>> keyed;
  for (Repair& repair : repairs) {
    const size_t kinds = KindChanges(repair);
    size_t fixed = 0, open = 0;
    std::string text;
    for (const ToTell& tell : repair.tell) {
      fixed += IsState(tell.fact) ? 0 : 1;
      open += (tell.fact.subject.IsVariable() ? 2 : 0) + (tell.fact.object.IsVariable() ? 1 : 0);
      absl::StrAppend(&text, display.Fact(tell.fact), "\n");
    }
    for (const InTheWay& way : repair.in_the_way) absl::StrAppend(&text, display.Fact(way.fact), "\n");
    for (const auto& [name, value] : repair.bindings) absl::StrAppend(&text, name, display.Of(value), "\n");
    Key key{repair.size(), kinds, fixed, open, repair.inferred.size(), std::move(text)};
    keyed.emplace_back(std::move(key), std::move(repair));
  }
  std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  repairs.clear();
  for (auto& [key, repair] : keyed) repairs.push_back(std::move(repair));
}

// Partial matches that lack exactly `changes`.
absl::Status WhyNotFinder::Gather(const Clause& clause, int changes, bool tell_derived, bool tell_schema,
                                  std::vector<Repair>& found) {
  SolveOptions options;
  options.changes = changes;
  options.rules = parts_.rules;
  options.tell_derived = tell_derived;
  options.tell_schema = tell_schema;
  if (tell_schema) options.rule_depth = 1;  // an axiom follows from many others
  // Solutions first: making a repair of one uses the solver's filters, not its search.
  std::vector<Solution> solutions;
  absl::flat_hash_set<std::string> keys;
  absl::Status status = solver_.Solve(clause, {}, options, [&](const Solution& solution) {
    std::vector<std::string> parts;
    for (const MissingFact& fact : solution.missing) {
      std::string part;
      for (int i = 0; i < 4; ++i) absl::StrAppend(&part, fact.terms[i].bits(), ",", fact.open[i], ";");
      parts.push_back(std::move(part));
    }
    std::sort(parts.begin(), parts.end());
    for (const Blocker& blocker : solution.blockers) {
      for (const Quad& quad : blocker.facts)
        parts.push_back(absl::StrCat("-", quad.subject.bits(), " ", quad.predicate.bits(), " ",
                                     quad.object.bits()));
    }
    if (keys.insert(absl::StrJoin(parts, "|")).second) solutions.push_back(solution);
    return solutions.size() < kCandidates;
  });
  if (!status.ok()) return status;
  for (const Solution& solution : solutions) {
    Repair repair;
    auto made = Make(solution, repair);
    if (!made.ok()) return made.status();
    if (*made) found.push_back(std::move(repair));
  }
  return absl::OkStatus();
}

absl::StatusOr<WhyNotAnswer> WhyNotFinder::Find(const sparql::Query& ask, size_t sets) {
  sparql::PrepareOptions prepare;
  prepare.functions = parts_.functions;
  prepare.default_graph =
      parts_.default_graph.IsNone() ? sparql::DefaultGraph::kUnion : sparql::DefaultGraph::kStrict;
  auto prepared = sparql::PreparedQuery::Prepare(ask, *parts_.dictionary, prepare);
  if (!prepared.ok()) return prepared.status();
  ask_ = *std::move(prepared);
  auto clauses = ToClauses(WithoutModifiers(*ask.algebra), *parts_.dictionary, parts_.default_graph);
  if (!clauses.ok()) return clauses.status();

  WhyNotAnswer answer;
  const Display display(parts_.prefixes);
  // Facts about things before axioms, whatever the number: one axiom makes everything true.
  struct Pass {
    bool tell_derived, tell_schema;
  };
  for (const Pass pass : {Pass{false, false}, Pass{true, false}, Pass{false, true}, Pass{true, true}}) {
    if (pass.tell_schema && !solver_.spared_schema()) break;
    if (solver_.exhausted()) {
      solver_.Refresh();
      answer.whole = false;
    }
    for (int changes = 1; changes <= parts_.limits.explain_changes; ++changes) {
      std::vector<Repair> candidates;
      for (const Clause& clause : *clauses) {
        if (absl::Status status = Gather(clause, changes, pass.tell_derived, pass.tell_schema, candidates); !status.ok())
          return status;
      }
      Rank(candidates);
      size_t tried = 0;
      size_t kinds = 0;  // changes of what a thing is, in the first set
      for (Repair& candidate : candidates) {
        if (!answer.repairs.empty() && KindChanges(candidate) > kinds) break;
        if (answer.repairs.size() >= sets) {
          ++answer.more;
          continue;
        }
        if (++tried > kCandidates / 5) {
          answer.whole = false;
          break;
        }
        auto right = Check(candidate);
        if (!right.ok()) return right.status();
        std::vector<std::string> texts;
        for (const Quad& quad : candidate.add)
          texts.push_back(absl::StrCat(quad.subject.bits(), " ", quad.predicate.bits(), " ", quad.object.bits()));
        std::sort(texts.begin(), texts.end());
        for (const InTheWay& way : candidate.in_the_way) texts.push_back(display.Fact(way.fact));
        if (*right && seen_.insert(absl::StrJoin(texts, "\n")).second)
          answer.repairs.push_back(std::move(candidate));
        if (answer.repairs.size() == 1) kinds = KindChanges(answer.repairs[0]);
      }
      if (!answer.repairs.empty()) break;  // the smallest ones are found
      if (solver_.exhausted()) break;
    }
    if (!answer.repairs.empty()) break;
  }
  answer.whole = answer.whole && !solver_.exhausted();
  if (solver_.failed_part() != nullptr && answer.repairs.empty()) {
    answer.failed_part = display.Pattern(*solver_.failed_part()->pattern, {});
  }
  return answer;
}

}  // namespace docent::explain
