#include "reasoner/explain/conflict.h"

#include <algorithm>

#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/example_picker.h"
#include "reasoner/rules/schema_words.h"

namespace docent::explain {
namespace {

constexpr size_t kFills = 20;  // solutions of one absence, of one size, that are tried
constexpr int kDeepest = 4;    // absences in absences

template <typename T>
bool Has(const std::vector<T>& all, const T& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

// False: already present.
template <typename T>
bool AddNew(const T& one, std::vector<T>& to) {
  if (Has(to, one)) return false;
  to.push_back(one);
  return true;
}

}  // namespace

bool Conflict::IsHitBy(const Repair& repair) const {
  return std::any_of(ways.begin(), ways.end(), [&](const Repair& way) {
    return std::all_of(way.add.begin(), way.add.end(),
                       [&](const Quad& quad) { return Has(repair.add, quad); }) &&
           std::all_of(way.remove.begin(), way.remove.end(),
                       [&](const Quad& quad) { return Has(repair.remove, quad); });
  });
}

bool Join(const Repair& way, Repair& repair) {
  bool news = false;
  for (size_t i = 0; i < way.add.size(); ++i) {
    if (!AddNew(way.add[i], repair.add)) continue;
    repair.tell.push_back(way.tell[i]);
    news = true;
  }
  for (const std::string& condition : way.conditions) AddNew(condition, repair.conditions);
  for (const Quad& quad : way.remove) news = AddNew(quad, repair.remove) || news;
  for (const InTheWay& added : way.in_the_way) {
    const auto known = std::find_if(
        repair.in_the_way.begin(), repair.in_the_way.end(),
        [&](const InTheWay& other) { return other.fact == added.fact && other.absence == added.absence; });
    if (known == repair.in_the_way.end()) {
      repair.in_the_way.push_back(added);
    } else {
      for (const TermQuad& quad : added.withdraw) AddNew(quad, known->withdraw);
    }
  }
  return news;
}

ConflictFinder::ConflictFinder(const Parts& parts)
    : parts_(parts), solver_(*parts.graph, *parts.dictionary, parts.functions, parts.run, parts.steps) {}

absl::StatusOr<std::vector<ConflictFinder::Match>> ConflictFinder::MatchesOf(
    const std::vector<AbsenceOf>& absences, size_t most) {
  std::vector<Match> matches;
  for (const AbsenceOf& of : absences) {
    for (const Clause& alternative : of.absence->alternatives) {
      if (matches.size() >= most) return matches;
      absl::Status status =
          solver_.Solve(alternative, SeedOf(alternative, of.row), {}, [&](const Solution& solution) {
            const bool known = std::any_of(matches.begin(), matches.end(), [&](const Match& match) {
              return match.facts == solution.facts &&
                     (alternative.parts.empty() || match.row.values == solution.row.values);
            });
            if (!known) matches.push_back({&of, solution.row, solution.facts});
            return matches.size() < most;
          });
      if (!status.ok()) return status;
    }
  }
  return matches;
}

absl::StatusOr<std::vector<Conflict>> ConflictFinder::Find(const std::vector<AbsenceOf>& absences,
                                                           const Examples& examples, const OpenNames& names,
                                                           size_t most) {
  std::vector<AbsenceOf> bound = absences;
  for (AbsenceOf& of : bound) {
    for (size_t v = 0; v < of.row.values.size(); ++v) {
      const auto example = examples.find(of.row.open[v]);
      if (example != examples.end()) of.row.values[v] = example->second;
    }
  }
  auto matches = MatchesOf(bound, most);
  if (!matches.ok()) return matches.status();
  std::vector<Conflict> conflicts;
  for (const Match& match : *matches) {
    const AbsenceOf& shown = absences[static_cast<size_t>(match.of - bound.data())];
    const std::string text =
        AbsenceText(*shown.absence, shown.row, names, *parts_.dictionary, *parts_.display);
    Conflict& conflict = conflicts.emplace_back();
    if (absl::Status status = Break(match, text, 0, conflict); !status.ok()) return status;
    if (solver_.exhausted()) conflict.left_out = 1;
  }
  return conflicts;
}

// The ways to break one match.
absl::Status ConflictFinder::Break(const Match& match, const std::string& absence, int depth,
                                   Conflict& conflict) {
  if (depth > kDeepest) {
    conflict.left_out = 1;
    return absl::OkStatus();
  }
  std::vector<AbsenceOf> absences;
  for (const Absence& inner : match.row.clause->absences) absences.push_back({&inner, match.row});
  auto further = parts_.prover->FurtherSupportOf(match.row);
  if (!further.ok()) return further.status();
  if (!further->whole) {
    conflict.lasts = false;
    conflict.left_out = 1;
  }
  std::vector<Quad> facts = match.facts;
  for (const Quad& fact : further->facts) AddNew(fact, facts);
  const auto inferred = parts_.dictionary->FindIri(kInferredGraph);
  for (const Quad& fact : facts) {
    if (!fact.graph.IsNone() && fact.graph != inferred) {
      Withdraw(fact, fact, absence, conflict);
      continue;
    }
    auto support = parts_.prover->SupportOf(fact);
    if (absl::IsResourceExhausted(support.status())) support = Support{{}, {}, false};
    if (!support.ok()) return support.status();
    for (const Quad& told : support->told) Withdraw(told, fact, absence, conflict);
    absences.insert(absences.end(), support->absences.begin(), support->absences.end());
    if (!support->whole) {
      conflict.lasts = false;
      conflict.left_out = 1;
    }
  }
  for (const AbsenceOf& of : absences) {
    if (absl::Status status = Fill(of, absence, depth, conflict); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// Adds as a way the withdrawal of the asserted fact `told`, from all graphs or from the one that it names;
// `fact` is this fact or one inferred from it. Facts asserted by the changes so far stay.
void ConflictFinder::Withdraw(const Quad& told, const Quad& fact, const std::string& absence,
                              Conflict& conflict) {
  const Dictionary& dictionary = *parts_.dictionary;
  const auto decode = [&](const Quad& quad, const Term& graph) {
    return TermQuad{dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                    dictionary.Decode(quad.object), graph};
  };
  const bool itself =
      told.subject == fact.subject && told.predicate == fact.predicate && told.object == fact.object;
  const TermQuad as_terms = decode(told, Term());
  if (!itself && !parts_.telling.tell_schema &&
      rules::IsSchemaPattern(as_terms.predicate.lexical,
                             as_terms.object.IsIri() ? as_terms.object.lexical : "")) {
    conflict.schema_skipped = true;
    return;
  }
  Repair way;
  InTheWay& shown = way.in_the_way.emplace_back(InTheWay{decode(fact, Term()), absence, {}});
  const auto inferred = dictionary.FindIri(kInferredGraph);
  bool stays = false;
  parts_.graph->ForEach({told.subject, told.predicate, told.object, told.graph}, [&](const Quad& quad) {
    if (quad.graph == inferred) return true;
    stays = stays || !parts_.base->Contains(quad);
    way.remove.push_back(quad);
    shown.withdraw.push_back(decode(quad, dictionary.Decode(quad.graph)));
    return true;
  });
  if (stays) {
    conflict.lasts = false;
  } else {
    conflict.ways.push_back(std::move(way));
  }
}

// Adds as ways the additions that make the absence's pattern hold: asserted facts, or, if only an inner
// absence keeps the pattern from holding, changes that break that absence.
absl::Status ConflictFinder::Fill(const AbsenceOf& of, const std::string& absence, int depth,
                                  Conflict& conflict) {
  conflict.lasts = false;
  SolveOptions options = parts_.telling;
  options.abductive = true;
  ExamplePicker picker(*parts_.graph, *parts_.dictionary, solver_);
  bool filled = false, more = true;
  for (options.missing = 0; options.missing <= parts_.room && more && !filled; ++options.missing) {
    more = false;
    for (const Clause& alternative : of.absence->alternatives) {
      std::vector<Solution> solutions;
      absl::Status status =
          solver_.Solve(alternative, SeedOf(alternative, of.row), options, [&](const Solution& solution) {
            solutions.push_back(solution);
            return solutions.size() < kFills;
          });
      if (!status.ok()) return status;
      more = more || solver_.missing_limit_reached();
      if (solutions.size() == kFills || solver_.rules_skipped())
        conflict.left_out = std::min(conflict.left_out, std::max(1, options.missing));
      if (solver_.missing_in_parts() > 0) conflict.left_out = 1;
      for (const Solution& solution : solutions) {
        if (options.missing == 0) {
          auto matches = MatchesOf(solution.absences, 1);
          if (!matches.ok()) return matches.status();
          if (matches->empty()) continue;
          if (status = Break(matches->front(), absence, depth + 1, conflict); !status.ok()) return status;
          continue;
        }
        const auto examples = picker.Pick(solution);
        Repair way;
        if (!examples || !AddMissing(solution, *examples, DistinctNames(solution), *parts_.base,
                                     *parts_.dictionary, *parts_.display, way))
          continue;
        for (ToTell& tell : way.tell) tell.absence = absence;
        conflict.ways.push_back(std::move(way));
        filled = true;
      }
    }
  }
  // larger ways matter only for sets that are larger by the same number
  if (more) conflict.left_out = std::min(conflict.left_out, options.missing);
  return absl::OkStatus();
}

}  // namespace docent::explain
