#include "reasoner/rules/rule_program.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "kb_server/sparql/algebra_printer.h"
#include "reasoner/rules/schema_words.h"
#include "reasoner/rules/stratification.h"

namespace docent {
namespace {

bool CanUnify(const QuadPattern& a, const QuadPattern& b) {
  const auto agree = [](TermId x, TermId y) { return x.IsNone() || y.IsNone() || x == y; };
  return agree(a.subject, b.subject) && agree(a.predicate, b.predicate) && agree(a.object, b.object);
}

// a → b with the strongest sign that any of their patterns gives it.
void AddDependencies(const std::vector<CompiledRule>& rules, uint32_t a, uint32_t b,
                     std::vector<RuleDependency>& out) {
  bool any = false;
  bool negative = false;
  for (const Trigger& trigger : rules[a].body->triggers()) {
    for (const HeadTriple& head : rules[b].head) {
      if (!CanUnify(trigger.match.constants, head.Pattern())) continue;
      any = true;
      negative = negative || trigger.polarity != Polarity::kPositive;
    }
  }
  if (any) out.push_back({a, b, negative});
}

HeadTriple CompileHead(const sparql::TriplePattern& triple, const Body& body, Dictionary& dictionary) {
  HeadTriple head;
  const std::array<const sparql::PatternTerm*, 3> terms = {&triple.subject, &triple.predicate,
                                                           &triple.object};
  for (int i = 0; i < 3; ++i) {
    if (terms[i]->IsVariable()) {
      head.columns[i] = static_cast<int16_t>(body.ColumnOf(terms[i]->variable->name));
    } else {
      head.constants[i] = dictionary.Intern(terms[i]->term);
    }
  }
  return head;
}

std::string CanonicalText(const Rule& rule) {
  std::string text = rule.name;
  for (const sparql::TriplePattern& triple : rule.head) {
    absl::StrAppend(&text, "\n", sparql::PrintTriple(triple));
  }
  return absl::StrCat(text, "\n<-\n", sparql::PrintPattern(*rule.body.algebra));
}

// Splits a positive body into what speaks of the schema and the rest.
void FindSchemaPart(const Dictionary& dictionary, CompiledRule& rule) {
  const auto text = [&](TermId id) { return id.IsIri() ? dictionary.Lexical(id) : std::string_view(); };
  uint32_t schema = 0;
  for (size_t i = 0; i < rule.body->patterns().size(); ++i) {
    const Body::Pattern& pattern = rule.body->patterns()[i];
    if (IsSchemaPattern(text(pattern.constants[1]), text(pattern.constants[2]))) schema |= 1u << i;
  }
  rule.of_schema = schema == rule.patterns;
  rule.schema = rule.of_schema ? 0 : schema;
  rule.filters = rule.body->has_filters() && (rule.schema == 0 || !rule.body->FiltersDecidedBy(rule.schema));
}

// SCCs in order of dependency → as few strata as negation needs: a rule lies above those that it negates and
// not below those that it uses.
int Flatten(const std::vector<RuleDependency>& dependencies, Stratification& strata) {
  std::vector<int> level(static_cast<size_t>(strata.count), 0);
  std::vector<std::vector<std::pair<int, bool>>> needs(static_cast<size_t>(strata.count));
  for (const RuleDependency& d : dependencies) {
    needs[strata.stratum[d.from]].push_back({strata.stratum[d.to], d.negative});
  }
  int highest = 0;
  for (int component = 0; component < strata.count; ++component) {
    for (const auto& [below, negative] : needs[component]) {
      level[component] = std::max(level[component], level[below] + (negative ? 1 : 0));
    }
    highest = std::max(highest, level[component]);
  }
  for (int& stratum : strata.stratum) stratum = level[stratum];
  return strata.count == 0 ? 0 : highest + 1;
}

bool Aggregates(const CompiledRule& rule) {
  return std::any_of(rule.body->triggers().begin(), rule.body->triggers().end(),
                     [](const Trigger& t) { return t.polarity == Polarity::kBoth; });
}

Diagnostic CycleDiagnostic(const std::vector<CompiledRule>& rules, const std::vector<uint32_t>& cycle) {
  const CompiledRule& first = rules[cycle[0]];
  std::string message = "negation through recursion: ";
  for (size_t i = 0; i < cycle.size(); ++i) {
    absl::StrAppend(&message, rules[cycle[i]].label,
                    i > 0               ? ", which needs "
                    : Aggregates(first) ? " aggregates what is derived by "
                                        : " negates what is derived by ");
  }
  absl::StrAppend(&message, cycle.size() == 1 ? "itself" : first.label);
  return {first.set, first.span, std::move(message),
          "take the negation out of the cycle: a rule may negate only what does not depend on it"};
}

// Rules that compute new values from values of their own make, without end: each an error with its cycle.
bool CheckTermination(const RuleSets& sets, const std::vector<CompiledRule>& rules,
                      const std::vector<RuleDependency>& dependencies, Diagnostics& diagnostics) {
  bool ok = true;
  uint32_t number = 0;
  for (const auto& [name, parsed] : sets) {
    for (const Rule& rule : parsed->rules) {
      const uint32_t r = number++;
      if (rule.growing.empty()) continue;
      const std::vector<uint32_t> cycle = CycleThrough(r, static_cast<uint32_t>(rules.size()), dependencies);
      if (cycle.empty()) continue;
      std::string message = absl::StrCat("may never end: ?", rule.growing[0],
                                         " is computed anew from what the rule itself leads to: ");
      for (const uint32_t each : cycle) absl::StrAppend(&message, rules[each].label, " needs ");
      absl::StrAppend(&message, cycle.size() == 1 ? "itself" : rules[r].label);
      diagnostics.push_back(
          {name, rule.growing_span.line > 0 ? rule.growing_span : rule.span, std::move(message),
           "bound it by a FILTER that compares, such as FILTER(?n < 100), or break the cycle"});
      ok = false;
    }
  }
  return ok;
}

}  // namespace

bool HeadTriple::Make(absl::Span<const TermId> row, Triple& out) const {
  std::array<TermId, 3> terms;
  for (int i = 0; i < 3; ++i) {
    terms[i] = columns[i] == Trigger::kNoColumn ? constants[i] : row[columns[i]];
    if (terms[i].IsNone()) return false;
  }
  out = {terms[0], terms[1], terms[2]};
  return !out.subject.IsLiteral() && out.predicate.IsIri();
}

bool HeadTriple::SeedFrom(const Triple& triple, absl::Span<TermId> seed) const {
  const std::array<TermId, 3> terms = {triple.subject, triple.predicate, triple.object};
  for (int i = 0; i < 3; ++i) {
    if (columns[i] == Trigger::kNoColumn) {
      if (constants[i] != terms[i]) return false;
      continue;
    }
    TermId& value = seed[columns[i]];
    if (!value.IsNone() && value != terms[i]) return false;
    value = terms[i];
  }
  return true;
}

Triple CompiledRule::Premise(size_t i, absl::Span<const TermId> row) const {
  const Body::Pattern& pattern = body->patterns()[i];
  const auto at = [&](int k) {
    return pattern.columns[k] == Trigger::kNoColumn ? pattern.constants[k] : row[pattern.columns[k]];
  };
  return {at(0), at(1), at(2)};
}

bool RuleProgram::Compile(const RuleSets& sets, Dictionary& dictionary,
                          const sparql::FunctionRegistry* functions, Diagnostics& diagnostics) {
  bool ok = true;
  for (const auto& [name, parsed] : sets) {
    int number = 0;
    for (const Rule& rule : parsed->rules) {
      CompiledRule compiled;
      compiled.name = ShortName(rule);
      compiled.set = name;
      compiled.span = rule.span;
      compiled.label = RuleLabel(name, rule, ++number);
      compiled.text = CanonicalText(rule);
      compiled.check = rule.head.empty();
      auto body = Body::Compile(rule.body, dictionary, functions);
      if (!body.ok()) {
        diagnostics.push_back({name, rule.span, std::string(body.status().message()), ""});
        ok = false;
        continue;
      }
      compiled.body = *std::move(body);
      for (const sparql::TriplePattern& triple : rule.head) {
        compiled.head.push_back(CompileHead(triple, *compiled.body, dictionary));
      }
      const std::vector<Trigger>& patterns = compiled.body->triggers();
      compiled.positive = compiled.body->flat() && std::all_of(patterns.begin(), patterns.end(),
                                                               [](const Trigger& t) { return t.required; });
      if (compiled.positive) {
        compiled.patterns = static_cast<uint32_t>((uint64_t{1} << compiled.body->patterns().size()) - 1);
        FindSchemaPart(dictionary, compiled);
      }
      rules.push_back(std::move(compiled));
    }
  }
  return ok;
}

void RuleProgram::Index() {
  rules_of_stratum.resize(static_cast<size_t>(stratum_count));
  for (uint32_t r = 0; r < rules.size(); ++r) {
    rules_of_stratum[rules[r].stratum].push_back(r);
    const std::vector<Trigger>& patterns = rules[r].body->triggers();
    for (uint32_t i = 0; i < patterns.size(); ++i) {
      const bool of_schema = patterns[i].pattern >= 0 && (rules[r].schema & (1u << patterns[i].pattern));
      if (rules[r].schema != 0 && !of_schema) continue;
      triggers.Add(patterns[i].match, {r, i});
      if (of_schema) schema_triggers.Add(patterns[i].match, {r, i});
    }
    if (rules[r].schema != 0) continue;
    for (uint32_t i = 0; i < rules[r].head.size(); ++i) {
      MatchPattern match;
      match.constants = rules[r].head[i].Pattern();
      heads.Add(match, {r, i});
    }
  }
}

std::shared_ptr<RuleProgram> RuleProgram::Build(const RuleSets& sets, Dictionary& dictionary,
                                                const sparql::FunctionRegistry* functions,
                                                Diagnostics& diagnostics) {
  auto program = std::make_shared<RuleProgram>();
  if (!program->Compile(sets, dictionary, functions, diagnostics)) return nullptr;
  const auto count = static_cast<uint32_t>(program->rules.size());
  std::vector<RuleDependency> dependencies;
  for (uint32_t a = 0; a < count; ++a) {
    for (uint32_t b = 0; b < count; ++b) AddDependencies(program->rules, a, b, dependencies);
  }
  Stratification strata = Stratify(count, dependencies);
  if (!strata.negative_cycle.empty()) {
    diagnostics.push_back(CycleDiagnostic(program->rules, strata.negative_cycle));
    return nullptr;
  }
  if (!CheckTermination(sets, program->rules, dependencies, diagnostics)) return nullptr;
  program->stratum_count = Flatten(dependencies, strata);
  for (uint32_t r = 0; r < count; ++r) program->rules[r].stratum = strata.stratum[r];
  program->Index();
  return program;
}

}  // namespace docent
