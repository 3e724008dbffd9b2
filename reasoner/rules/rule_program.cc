#include "reasoner/rules/rule_program.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
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

Diagnostic CycleDiagnostic(const std::vector<CompiledRule>& rules, const std::vector<uint32_t>& cycle) {
  const CompiledRule& first = rules[cycle[0]];
  std::string message = "negation through recursion: ";
  for (size_t i = 0; i < cycle.size(); ++i) {
    absl::StrAppend(&message, rules[cycle[i]].label,
                    i == 0 ? " negates what is derived by " : ", which needs ");
  }
  absl::StrAppend(&message, cycle.size() == 1 ? "itself" : first.label);
  return {first.set, first.span, std::move(message),
          "take the negation out of the cycle: a rule may negate only what does not depend on it"};
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

bool HeadTriple::SeedFrom(const Triple& triple, size_t column_count, std::vector<TermId>& seed) const {
  seed.assign(column_count, TermId());
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

bool RuleProgram::Compile(const RuleSets& sets, Dictionary& dictionary,
                          const sparql::FunctionRegistry* functions, Diagnostics& diagnostics) {
  bool ok = true;
  for (const auto& [name, parsed] : sets) {
    int number = 0;
    for (const Rule& rule : parsed->rules) {
      CompiledRule compiled;
      compiled.label = absl::StrCat(name, " rule ", ++number, " (line ", rule.span.line, ")");
      compiled.set = name;
      compiled.span = rule.span;
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
    for (uint32_t i = 0; i < patterns.size(); ++i) triggers.Add(patterns[i].match, {r, i});
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
  const Stratification strata = Stratify(count, dependencies);
  if (!strata.negative_cycle.empty()) {
    diagnostics.push_back(CycleDiagnostic(program->rules, strata.negative_cycle));
    return nullptr;
  }
  program->stratum_count = strata.count;
  for (uint32_t r = 0; r < count; ++r) program->rules[r].stratum = strata.stratum[r];
  program->Index();
  return program;
}

}  // namespace docent
