#include "reasoner/explain/rule_base.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/explain/count_form.h"
#include "reasoner/rules/rule_parser.h"

namespace docent::explain {
namespace {

AtomTerm HeadTerm(const sparql::PatternTerm& term, const Clause& body, Dictionary& dictionary) {
  if (!term.IsVariable()) return {dictionary.Intern(term.term()), AtomTerm::kConstant};
  return {TermId(), body.Find(term.variable().name)};
}

// True if the clause is a single pattern without a repeated variable.
bool IsOnePattern(const Clause& clause) {
  const size_t others = clause.absences.size() + clause.tests.size() + clause.assignments.size() +
                        clause.tables.size() + clause.parts.size();
  if (clause.atoms.size() != 1 || others > 0) return false;
  const auto& terms = clause.atoms[0].terms;
  const auto variables =
      std::count_if(terms.begin(), terms.end(), [](const AtomTerm& t) { return t.variable >= 0; });
  return static_cast<size_t>(variables) == clause.names.size();
}

// True if the head has a variable that `written` does not project: a count.
bool LosesHead(const rules::Rule& rule, const sparql::Algebra& written) {
  const std::vector<sparql::Variable> shown = sparql::InScopeVariables(written);
  const auto lost = [&](const sparql::PatternTerm& term) {
    return term.IsVariable() && std::none_of(shown.begin(), shown.end(), [&](const sparql::Variable& v) {
             return v.name == term.variable().name;
           });
  };
  return std::any_of(rule.head.begin(), rule.head.end(), [&](const sparql::TriplePattern& head) {
    return lost(head.subject) || lost(head.predicate) || lost(head.object);
  });
}

}  // namespace

absl::StatusOr<std::shared_ptr<const RuleBase>> RuleBase::Make(const std::vector<RuleText>& sets,
                                                               Dictionary& dictionary, const Limits& limits) {
  auto base = std::make_shared<RuleBase>();
  base->type_ = dictionary.InternIri(kRdfType);
  for (const RuleText& set : sets) {
    auto parsed = std::make_shared<const rules::ParsedRules>(
        rules::ParseRules(*set.text, set.name, limits, nullptr, rules::RuleTextOrigin::kAccepted));
    if (!parsed->ok()) return ToStatus(parsed->diagnostics, *set.text);
    base->sets_[set.name] = std::move(parsed);
  }
  for (const auto& [name, parsed] : base->sets_) {
    int number = 0;
    for (const rules::Rule& rule : parsed->rules) {
      if (absl::Status status = base->Add(name, rule, ++number, dictionary); !status.ok()) return status;
    }
  }
  base->MarkWhatRestsOnAbsence();
  base->FindEquality();
  return std::shared_ptr<const RuleBase>(std::move(base));
}

absl::Status RuleBase::Add(const std::string& set, const rules::Rule& rule, int number,
                           Dictionary& dictionary) {
  rules_.push_back({rules::RuleLabel(set, rule, number), set, rule.span.line});
  const sparql::AlgebraPtr written = WithoutCounts(*rule.body.algebra);
  const bool tells = written == nullptr || LosesHead(rule, *written);
  absl::Status status = AddClauses(rule, *rule.body.algebra, true, tells, dictionary);
  if (status.ok() && written != nullptr) status = AddClauses(rule, *written, false, true, dictionary);
  return status;
}

absl::Status RuleBase::AddClauses(const rules::Rule& rule, const sparql::Algebra& body, bool proves,
                                  bool tells, Dictionary& dictionary) {
  auto clauses = ToClauses(body, dictionary);
  if (!clauses.ok()) return clauses.status();
  for (Clause& clause : *clauses) {
    RuleClause& made = clauses_.emplace_back();
    made.rule = static_cast<uint32_t>(rules_.size()) - 1;
    made.proves = proves;
    made.tells = tells;
    made.equality = rules::EqualityRuleOf(rule);
    made.body = std::move(clause);
    if (rule.head.empty() && IsOnePattern(made.body)) {
      const auto& terms = made.body.atoms[0].terms;
      forbidden_.push_back({terms[0].constant, terms[1].constant, terms[2].constant, TermId()});
    }
    for (const sparql::TriplePattern& head : rule.head) {
      Atom atom;
      atom.terms[0] = HeadTerm(head.subject, made.body, dictionary);
      atom.terms[1] = HeadTerm(head.predicate, made.body, dictionary);
      atom.terms[2] = HeadTerm(head.object, made.body, dictionary);
      const bool whole = std::all_of(atom.terms.begin(), atom.terms.begin() + 3, [](const AtomTerm& t) {
        return t.variable >= 0 || !t.constant.IsNone();
      });
      if (!whole) continue;  // with a head variable unbound in this alternative there is no fact
      const Head place{static_cast<uint32_t>(clauses_.size() - 1), static_cast<uint32_t>(made.heads.size())};
      made.heads.push_back(atom);
      by_predicate_[atom.terms[1].constant].push_back(place);
    }
  }
  return absl::OkStatus();
}

void RuleBase::FindEquality() {
  std::vector<uint32_t> found;
  for (int rule = 0; rule < rules::kEqualityRules; ++rule) {
    for (uint32_t c = 0; c < clauses_.size(); ++c) {
      if (clauses_[c].equality != static_cast<rules::EqualityRule>(rule)) continue;
      found.push_back(c);
      break;
    }
  }
  if (found.size() == rules::kEqualityRules) equality_ = std::move(found);
}

std::vector<bool> RuleBase::WithUsersOf(std::vector<uint32_t> clauses) const {
  std::vector<bool> found(clauses_.size());
  for (const uint32_t c : clauses) found[c] = true;
  std::vector<uint32_t> open = std::move(clauses);
  const auto add_users = [&](const std::vector<uint32_t>& users) {
    for (const uint32_t c : users) {
      if (!found[c]) open.push_back(c);
      found[c] = true;
    }
  };
  absl::flat_hash_set<TermId> made;
  while (!open.empty()) {
    const uint32_t clause = open.back();
    open.pop_back();
    for (const Atom& head : clauses_[clause].heads) {
      const TermId predicate = head.terms[1].constant;
      if (!made.insert(predicate).second) continue;
      for (const TermId used : {predicate, TermId()}) {
        if (const auto users = users_.find(used); users != users_.end()) add_users(users->second);
      }
      if (!predicate.IsNone()) continue;
      for (const auto& [used, users] : users_) add_users(users);
    }
  }
  return found;
}

void RuleBase::MarkWhatRestsOnAbsence() {
  std::vector<uint32_t> absent;
  for (uint32_t c = 0; c < clauses_.size(); ++c) {
    absl::flat_hash_set<TermId> used;
    for (const Atom& atom : clauses_[c].body.atoms) used.insert(atom.terms[1].constant);
    for (const TermId predicate : used) users_[predicate].push_back(c);
    if (!clauses_[c].body.absences.empty()) absent.push_back(c);
  }
  const std::vector<bool> found = WithUsersOf(std::move(absent));
  for (uint32_t c = 0; c < clauses_.size(); ++c) clauses_[c].rests_on_absence = found[c];
}

std::vector<bool> RuleBase::RestingOn(TermId predicate) const {
  const auto users = users_.find(predicate);
  return WithUsersOf(users == users_.end() ? std::vector<uint32_t>() : users->second);
}

void RuleBase::ForEachHead(TermId predicate, absl::FunctionRef<void(Head)> visit) const {
  if (predicate.IsNone()) {
    for (uint32_t c = 0; c < clauses_.size(); ++c) {
      for (uint32_t h = 0; h < clauses_[c].heads.size(); ++h) visit({c, h});
    }
    return;
  }
  for (TermId key : {predicate, TermId()}) {
    const auto found = by_predicate_.find(key);
    if (found == by_predicate_.end()) continue;
    for (const Head& head : found->second) visit(head);
  }
}

bool RuleBase::IsForbidden(const QuadPattern& fact) const {
  const auto covers = [](TermId forbidden, TermId term) { return forbidden.IsNone() || forbidden == term; };
  return std::any_of(forbidden_.begin(), forbidden_.end(), [&](const QuadPattern& f) {
    return covers(f.subject, fact.subject) && covers(f.predicate, fact.predicate) &&
           covers(f.object, fact.object);
  });
}

bool RuleBase::IsMadeByName(TermId predicate, TermId object) const {
  const auto found = by_predicate_.find(predicate);
  if (found == by_predicate_.end() || predicate.IsNone()) return false;
  if (predicate != type_) return true;
  return std::any_of(found->second.begin(), found->second.end(), [&](const Head& head) {
    const AtomTerm& made = clauses_[head.clause].heads[head.head].terms[2];
    return made.variable < 0 && made.constant == object;
  });
}

}  // namespace docent::explain
