#include "reasoner/rules/rule_program.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "graph/base/rule_limits.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "reasoner/rules/equality_rules.h"
#include "reasoner/rules/schema_words.h"

namespace docent::rules {
namespace {

// Adds a → b with the strongest sign that any of their patterns gives: once for dependencies that hold for
// all axioms, and once for a rule with a part about axioms, which decide its results. A pattern that matches
// reports without naming them depends on them only as far as there is an order (RuleProgram::IsLate).
void AddDependencies(const std::vector<CompiledRule>& rules, const ReportWords& words, uint32_t a, uint32_t b,
                     std::vector<RuleDependency>& out) {
  RuleDependency found[2] = {{a, b, false, false}, {a, b, false, true}};
  bool any[2] = {false, false};
  for (const matching::Trigger& trigger : rules[a].body->triggers()) {
    const bool about_axioms = trigger.pattern >= 0 && (rules[a].schema & (1u << trigger.pattern)) != 0;
    for (const HeadTriple& head : rules[b].conclusions()) {
      if (!CanUnify(trigger.match.constants, head.Pattern())) continue;
      const bool by_axioms = rules[b].schema != 0 || (rules[a].schema != 0 && !about_axioms) ||
                             (rules[b].check && !words.AreNamedBy(trigger.match.constants));
      any[by_axioms] = true;
      found[by_axioms].negative |= trigger.polarity != matching::Polarity::kPositive;
    }
  }
  for (const int by_axioms : {0, 1}) {
    if (any[by_axioms]) out.push_back(found[by_axioms]);
  }
}

// Of all rules with all: each only with those whose heads have a predicate of its body. It ends past `most`.
std::vector<RuleDependency> DependenciesOf(const std::vector<CompiledRule>& rules, const ReportWords& words,
                                           size_t most) {
  const auto count = static_cast<uint32_t>(rules.size());
  absl::flat_hash_map<TermId, std::vector<uint32_t>> makers;  // by predicate; kNone: of any
  for (uint32_t b = 0; b < count; ++b) {
    for (const HeadTriple& head : rules[b].conclusions()) {
      std::vector<uint32_t>& of_predicate = makers[head.Pattern().predicate];
      if (of_predicate.empty() || of_predicate.back() != b) of_predicate.push_back(b);
    }
  }
  std::vector<RuleDependency> dependencies;
  for (uint32_t a = 0; a < count && dependencies.size() <= most; ++a) {
    std::vector<uint32_t> used;
    for (const matching::Trigger& trigger : rules[a].body->triggers()) {
      const TermId predicate = trigger.match.constants.predicate;
      for (const auto& [made, makers_of] : makers) {
        if (!predicate.IsNone()) break;
        used.insert(used.end(), makers_of.begin(), makers_of.end());
      }
      for (const TermId made : {predicate, TermId()}) {
        const auto found = makers.find(made);
        if (found != makers.end()) used.insert(used.end(), found->second.begin(), found->second.end());
      }
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const uint32_t b : used) AddDependencies(rules, words, a, b, dependencies);
  }
  return dependencies;
}

std::vector<RuleDependency> WithoutAxioms(const std::vector<RuleDependency>& dependencies) {
  std::vector<RuleDependency> certain;
  for (const RuleDependency& d : dependencies) {
    if (!d.by_axioms) certain.push_back(d);
  }
  return certain;
}

HeadTriple CompileHead(const sparql::TriplePattern& triple, const matching::Body& body,
                       Dictionary& dictionary) {
  HeadTriple head;
  const std::array<const sparql::PatternTerm*, 3> terms = {&triple.subject, &triple.predicate,
                                                           &triple.object};
  for (int i = 0; i < 3; ++i) {
    if (terms[i]->IsVariable()) {
      head.columns[i] = static_cast<int16_t>(body.ColumnOf(terms[i]->variable().name));
    } else {
      head.constants[i] = dictionary.Intern(terms[i]->term());
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

// Splits a positive body into its patterns about the schema and the rest. A check of equal things and other
// facts about them (eq-diff1) is not split: there may be very many pairs, and an instance saves one lookup
// only.
void FindSchemaPart(const Dictionary& dictionary, CompiledRule& rule) {
  const auto text = [&](TermId id) { return id.IsIri() ? dictionary.Lexical(id) : std::string_view(); };
  uint32_t schema = 0;
  bool of_equality_alone = rule.check;
  for (size_t i = 0; i < rule.body->patterns().size(); ++i) {
    const matching::Body::Pattern& pattern = rule.body->patterns()[i];
    if (!IsSchemaPattern(text(pattern.constants[1]), text(pattern.constants[2]))) {
      of_equality_alone = of_equality_alone && !pattern.constants[1].IsNone();
      continue;
    }
    schema |= 1u << i;
    of_equality_alone = of_equality_alone && text(pattern.constants[1]) == kOwlSameAs;
  }
  rule.of_schema = schema == rule.patterns;
  rule.schema = rule.of_schema || of_equality_alone ? 0 : schema;
  rule.filters = rule.body->has_filters() && (rule.schema == 0 || !rule.body->FiltersDecidedBy(rule.schema));
}

bool Aggregates(const CompiledRule& rule) {
  return std::any_of(rule.body->triggers().begin(), rule.body->triggers().end(),
                     [](const matching::Trigger& t) { return t.polarity == matching::Polarity::kBoth; });
}

Diagnostic CycleDiagnostic(const std::vector<CompiledRule>& rules, const std::vector<uint32_t>& cycle) {
  const CompiledRule& first = rules[cycle[0]];
  std::string message = "negation through recursion: ";
  for (size_t i = 0; i < cycle.size(); ++i) {
    absl::StrAppend(&message, rules[cycle[i]].label,
                    i > 0               ? ", which needs "
                    : Aggregates(first) ? " aggregates the results of "
                                        : " negates the results of ");
  }
  absl::StrAppend(&message, cycle.size() == 1 ? "itself" : first.label);
  return {first.set, first.span, std::move(message),
          Aggregates(first)
              ? "take the aggregate out of the cycle: a rule may count or sum only what does not depend on it"
              : "take the negation out of the cycle: a rule may negate only what does not depend on it"};
}

// Finds rules that compute endlessly new values from their own results; each is an error with its cycle.
bool CheckTermination(const RuleSets& sets, const std::vector<CompiledRule>& rules,
                      const std::vector<RuleDependency>& dependencies, Diagnostics& diagnostics) {
  constexpr int kMostTold = 20;
  const auto count = static_cast<uint32_t>(rules.size());
  const DependencyGraph graph = GraphOf(count, dependencies);
  const std::vector<int> component = Stratify(count, dependencies).stratum;
  std::vector<bool> cyclic(rules.size());  // by component
  for (const RuleDependency& d : dependencies) {
    if (component[d.from] == component[d.to]) cyclic[component[d.from]] = true;
  }
  int told = 0;
  uint32_t number = 0;
  for (const auto& [name, parsed] : sets) {
    for (const Rule& rule : parsed->rules) {
      const uint32_t r = number++;
      if (rule.growing.empty() || !cyclic[component[r]] || told == kMostTold) continue;
      const std::vector<uint32_t> cycle = CycleThrough(r, graph);
      std::string message = absl::StrCat("may never end: ?", rule.growing[0],
                                         " is computed from the results of the rule itself: ");
      for (const uint32_t each : cycle) absl::StrAppend(&message, rules[each].label, " needs ");
      absl::StrAppend(&message, cycle.size() == 1 ? "itself" : rules[r].label);
      diagnostics.push_back(
          {name, rule.growing_span.line > 0 ? rule.growing_span : rule.span, std::move(message),
           "bound it by a FILTER that compares, such as FILTER(?n < 100), or break the cycle"});
      ++told;
    }
  }
  return told == 0;
}

}  // namespace

bool CanUnify(const QuadPattern& a, const QuadPattern& b) {
  const auto agree = [](TermId x, TermId y) { return x.IsNone() || y.IsNone() || x == y; };
  return agree(a.subject, b.subject) && agree(a.predicate, b.predicate) && agree(a.object, b.object);
}

bool HeadTriple::Make(absl::Span<const TermId> row, Triple& out) const {
  std::array<TermId, 3> terms;
  for (int i = 0; i < 3; ++i) {
    terms[i] = columns[i] == matching::Trigger::kNoColumn ? constants[i] : row[columns[i]];
    if (terms[i].IsNone()) return false;
  }
  out = {terms[0], terms[1], terms[2]};
  return !out.subject.IsLiteral() && out.predicate.IsIri();
}

bool HeadTriple::SeedFrom(const Triple& triple, absl::Span<TermId> seed) const {
  const std::array<TermId, 3> terms = {triple.subject, triple.predicate, triple.object};
  for (int i = 0; i < 3; ++i) {
    if (columns[i] == matching::Trigger::kNoColumn) {
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
  const matching::Body::Pattern& pattern = body->patterns()[i];
  const auto at = [&](int k) {
    return pattern.columns[k] == matching::Trigger::kNoColumn ? pattern.constants[k]
                                                              : row[pattern.columns[k]];
  };
  return {at(0), at(1), at(2)};
}

absl::Status CompiledRule::Named(absl::Status status) const {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(label, ": ", status.message()));
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
      auto body = matching::Body::Compile(rule.body, dictionary, functions);
      if (!body.ok()) {
        diagnostics.push_back({name, rule.span, std::string(body.status().message()), ""});
        ok = false;
        continue;
      }
      compiled.body = *std::move(body);
      for (const sparql::TriplePattern& triple : rule.head) {
        compiled.head.push_back(CompileHead(triple, *compiled.body, dictionary));
      }
      const std::vector<matching::Trigger>& patterns = compiled.body->triggers();
      compiled.positive =
          compiled.body->flat() && std::all_of(patterns.begin(), patterns.end(),
                                               [](const matching::Trigger& t) { return t.required; });
      if (compiled.positive) {
        compiled.patterns = static_cast<uint32_t>((uint64_t{1} << compiled.body->patterns().size()) - 1);
        FindSchemaPart(dictionary, compiled);
      }
      if (compiled.check) AddReports(dictionary, compiled);
      rules.push_back(std::move(compiled));
    }
  }
  return ok;
}

void RuleProgram::AddReports(Dictionary& dictionary, CompiledRule& check) {
  if (report_words.inconsistency.IsNone()) report_words = ReportWords::Intern(dictionary);
  check.reports.push_back({.constants = {TermId(), report_words.type, report_words.inconsistency}});
  for (const TermId word : report_words.words)
    check.reports.push_back({.constants = {TermId(), word, TermId()}});
  for (const matching::Trigger& trigger : check.body->triggers()) {
    if (trigger.polarity == matching::Polarity::kPositive) continue;
    check.negates_itself =
        check.negates_itself ||
        std::any_of(check.reports.begin(), check.reports.end(), [&](const HeadTriple& form) {
          return CanUnify(trigger.match.constants, form.Pattern());
        });
  }
  any_negates_itself_ = any_negates_itself_ || check.negates_itself;
}

void RuleProgram::FindEquality(const RuleSets& sets, Dictionary& dictionary) {
  std::array<std::vector<uint32_t>, kEqualityRules> found;
  uint32_t number = 0;
  for (const auto& [name, parsed] : sets) {
    for (const Rule& rule : parsed->rules) {
      if (const auto which = EqualityRuleOf(rule)) found[static_cast<size_t>(*which)].push_back(number);
      ++number;
    }
  }
  if (std::any_of(found.begin(), found.end(), [](const auto& rules_of) { return rules_of.empty(); })) return;
  equality = {true, found[static_cast<size_t>(EqualityRule::kTransitivity)][0],
              found[static_cast<size_t>(EqualityRule::kSubject)][0],
              dictionary.InternIri(std::string(kOwlSameAs))};
  for (const std::vector<uint32_t>& rules_of : found) {
    for (const uint32_t r : rules_of) rules[r].of_equality = true;
  }
}

// From components in order of dependency to as few strata as negation needs: a rule is above the rules that
// it negates and not below the rules that it uses.
bool RuleProgram::Place(NegationOrder order) {
  const bool same = !rules_of_stratum.empty() && order.IsSame(order_);
  order_ = std::move(order);
  if (same) return false;
  std::vector<int> first(static_cast<size_t>(component_count_), 0);
  std::vector<std::vector<std::pair<int, bool>>> needs(static_cast<size_t>(component_count_));
  for (const RuleDependency& d : dependencies_) {
    if (component_[d.from] != component_[d.to])
      needs[component_[d.from]].push_back({component_[d.to], d.negative});
  }
  const int height =
      order_.of_rules.empty() ? 0 : *std::max_element(order_.of_rules.begin(), order_.of_rules.end());
  const auto last = [&](int component) { return first[component] + (component == entangled_ ? height : 0); };
  stratum_count = 0;
  for (int component = 0; component < component_count_; ++component) {
    for (const auto& [below, negative] : needs[component]) {
      first[component] = std::max(first[component], last(below) + (negative ? 1 : 0));
    }
    stratum_count = std::max(stratum_count, last(component) + 1);
  }
  for (uint32_t r = 0; r < rules.size(); ++r) rules[r].stratum = first[component_[r]];
  if (entangled_ >= 0) {
    first_entangled = first[entangled_];
    last_entangled = first_entangled + height;
  }
  for (size_t i = 0; i < ordered.size(); ++i) rules[ordered[i]].stratum += order_.of_rules[i];
  rules_of_stratum.assign(static_cast<size_t>(stratum_count), {});
  for (uint32_t r = 0; r < rules.size(); ++r) {
    for (int stratum = rules[r].stratum; stratum < stratum_count && Runs(r, stratum); ++stratum)
      rules_of_stratum[stratum].push_back(r);
  }
  return true;
}

int RuleProgram::StratumOf(const Triple& fact) const {
  int level = 0;
  const FactPattern pattern = {fact.subject, fact.predicate, fact.object, fact.subject == fact.object};
  AnyWider(pattern, order_.with_subjects.contains(fact.predicate), [&](const FactPattern& wider) {
    const auto found = order_.of_facts.find(wider);
    if (found != order_.of_facts.end()) level = std::max(level, found->second);
    return false;
  });
  return first_entangled + level;
}

// For a negative cycle of dependencies: false, with a diagnostic, if the axioms cannot break it. Several such
// cycles become one, with the rules between them; so a set refused among some rules is also refused among
// more rules.
bool RuleProgram::FindOrdered(Diagnostics& diagnostics) {
  const auto count = static_cast<uint32_t>(rules.size());
  Stratification components = Stratify(count, dependencies_);
  if (!components.negative_cycle.empty()) {
    const Stratification certain = Stratify(count, WithoutAxioms(dependencies_));
    if (!certain.negative_cycle.empty()) {
      diagnostics.push_back(CycleDiagnostic(rules, certain.negative_cycle));
      return false;
    }
    const uint32_t first = components.negative_cycle[0];
    std::vector<RuleDependency> together;
    for (const RuleDependency& d : dependencies_) {
      if (!d.negative || components.stratum[d.from] != components.stratum[d.to] || d.from == first) continue;
      together.push_back({first, d.from, false, true});
      together.push_back({d.from, first, false, true});
    }
    dependencies_.insert(dependencies_.end(), together.begin(), together.end());
    components = Stratify(count, dependencies_);
    entangled_ = components.stratum[first];
    std::vector<bool> negates(count);
    for (const RuleDependency& d : dependencies_) {
      const bool within = components.stratum[d.from] == entangled_ && components.stratum[d.to] == entangled_;
      negates[d.from] = negates[d.from] || (d.negative && within);
    }
    for (uint32_t r = 0; r < count; ++r) {
      if (negates[r]) ordered.push_back(r);
    }
  }
  component_ = std::move(components.stratum);
  component_count_ = components.count;
  return true;
}

void RuleProgram::Index() {
  for (uint32_t r = 0; r < rules.size(); ++r) {
    if (rules[r].of_equality) continue;
    const std::vector<matching::Trigger>& patterns = rules[r].body->triggers();
    for (uint32_t i = 0; i < patterns.size(); ++i) {
      const bool of_schema = patterns[i].pattern >= 0 && (rules[r].schema & (1u << patterns[i].pattern));
      if (rules[r].schema != 0 && !of_schema) continue;
      triggers.Add(patterns[i].match, {r, i});
      if (of_schema) schema_triggers.Add(patterns[i].match, {r, i});
    }
    if (rules[r].schema != 0) continue;
    for (uint32_t i = 0; i < rules[r].head.size(); ++i) {
      matching::MatchPattern match;
      match.constants = rules[r].head[i].Pattern();
      heads.Add(match, {r, i});
    }
  }
}

std::shared_ptr<RuleProgram> RuleProgram::Build(const RuleSets& sets, Dictionary& dictionary,
                                                const sparql::FunctionRegistry* functions,
                                                Diagnostics& diagnostics, RuleTextOrigin origin) {
  auto program = std::make_shared<RuleProgram>();
  if (!program->Compile(sets, dictionary, functions, diagnostics)) return nullptr;
  program->FindEquality(sets, dictionary);
  const size_t most =
      origin == RuleTextOrigin::kNew ? kRuleLimits.rule_dependencies : std::numeric_limits<size_t>::max();
  program->dependencies_ = DependenciesOf(program->rules, program->report_words, most);
  if (program->dependencies_.size() > most) {
    const CompiledRule& last = program->rules[program->dependencies_.back().from];
    diagnostics.push_back({last.set, last.span,
                           absl::StrCat("the rules depend on each other in more pairs than the limit "
                                        "rule_dependencies = ",
                                        most),
                           "write predicates in heads and bodies where there are variables"});
    return nullptr;
  }
  if (!program->FindOrdered(diagnostics)) return nullptr;
  if (!CheckTermination(sets, program->rules, WithoutAxioms(program->dependencies_), diagnostics))
    return nullptr;
  program->Place({.of_rules = std::vector<int>(program->ordered.size(), 1)});
  program->Index();
  return program;
}

}  // namespace docent::rules
