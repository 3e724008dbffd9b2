#include "kb_server/cli/consistency_check.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <tuple>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "reasoner/explain/explainer.h"
#include "reasoner/explain/explanation_text.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_parser.h"
#include "reasoner/rules/rule_sets.h"
#include "reasoner/rules/schema_words.h"

namespace docent::server {
namespace {

constexpr char kRuleSet[] = "owl2rl";
constexpr size_t kConditionBytes = 300;  // dt-diff has one that fills a screen
constexpr char kMend[] = "correct or remove one of the facts that are told, or the rule";

// Of what words mean, rather than of things: an inconsistency is told at a fact about a thing, if there is one.
bool IsAxiom(const TermQuad& q) {
  return rules::IsSchemaPattern(q.predicate.lexical, q.object.IsIri() ? q.object.lexical : "");
}

bool Before(const SourceSpan& a, const SourceSpan& b) {
  return std::pair(a.line, a.column) < std::pair(b.line, b.column);
}

// What the limits of a check are called, where rules and explanations name those of a server.
std::string Reason(const absl::Status& status, const CheckLimits& limits) {
  if (absl::IsDeadlineExceeded(status))
    return absl::StrCat("it takes longer than the limit check_consistency_ms = ",
                        limits.check_consistency_ms);
  if (absl::IsResourceExhausted(status)) {
    return absl::StrCat("more follows than the limit check_facts = ", limits.check_facts, " (",
                        std::string(status.message()), ")");
  }
  return std::string(status.message());
}

}  // namespace

void ConsistencyCheck::AddDocument(const std::string& file, const LocatedRdf& document, bool findings) {
  const size_t source = sources_.size();
  sources_.push_back({file, findings});
  prefixes_.insert(prefixes_.end(), document.rdf.prefixes.begin(), document.rdf.prefixes.end());
  const TermId graph = dictionary_.InternIri(kDefaultGraph);
  for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
    if (told_.size() > limits_.check_facts) return;  // Run says so
    const TermQuad& q = document.rdf.quads[i];
    const Quad quad{dictionary_.Intern(q.subject), dictionary_.Intern(q.predicate),
                    dictionary_.Intern(q.object), graph};
    const auto [known, is_new] =
        places_.try_emplace(WithoutGraph(quad), Place{source, document.places[i], IsAxiom(q)});
    if (is_new) {
      told_.push_back(quad);
    } else if (findings && !sources_[known->second.file].findings) {
      known->second = {source, document.places[i], known->second.schema};
    }
  }
}

void ConsistencyCheck::AddRules(const std::string& file, const std::string& text, bool findings) {
  const size_t source = sources_.size();
  sources_.push_back({file, findings});
  rules_.push_back({source, {file, std::make_shared<const std::string>(text)}});
  const rules::ParsedRules parsed = rules::ParseRules(text, file, {}, functions_);
  for (size_t i = 0; i < parsed.rules.size(); ++i) {
    rule_places_[rules::RuleLabel(file, parsed.rules[i], static_cast<int>(i) + 1)] = {source,
                                                                                      parsed.rules[i].span};
  }
}

size_t ConsistencyCheck::WithFindings(size_t file) const {
  if (sources_[file].findings) return file;
  const auto first =
      std::find_if(sources_.begin(), sources_.end(), [](const Source& source) { return source.findings; });
  return first == sources_.end() ? file : static_cast<size_t>(first - sources_.begin());
}

void ConsistencyCheck::Warn(size_t file, std::string message, std::string hint) {
  const std::string& name = sources_[WithFindings(file)].file;
  results_[name].push_back(
      {{"consistency", {name, {}, std::move(message), std::move(hint), Diagnostic::Severity::kWarning}, ""},
       "",
       {}});
}

absl::Status ConsistencyCheck::Materialise(Cancellation* cancellation, GraphVersionPtr* version) {
  Limits limits;
  limits.inferred_per_turn = limits_.check_facts;
  rules::RuleEngine engine(dictionary_, limits, functions_);
  followed_ = {{kRuleSet, std::make_shared<const std::string>(rules::BuiltInRuleSet(kRuleSet))}};
  if (absl::Status status = ToStatus(engine.PutRules(kRuleSet, *followed_[0].text), ""); !status.ok())
    return status;
  for (size_t i = 0; i < rules_.size(); ++i) {
    if (left_out_.contains(i)) continue;
    const auto& [source, rules] = rules_[i];
    const Diagnostics diagnostics = engine.PutRules(rules.name, *rules.text);
    if (HasErrors(diagnostics)) {
      const auto error = std::find_if(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& d) {
        return d.severity == Diagnostic::Severity::kError;
      });
      Warn(source,
           absl::StrCat("consistency was checked without these rules: beside ", kRuleSet, ", ",
                        error->message),
           error->hint);
      left_out_.insert(i);
      continue;
    }
    followed_.push_back(rules);
  }
  GraphWriter writer(nullptr);
  Delta told;
  told.added = writer.AddAll(told_);
  if (auto delta = engine.Update(writer, told, cancellation); !delta.ok()) return delta.status();
  *version = writer.Freeze(Revision(1));
  return absl::OkStatus();
}

// The rules that an error names, else all.
void ConsistencyCheck::LeaveOut(std::string why) {
  why = why.substr(0, why.find("; the batch was not applied"));
  std::set<size_t> named, followed;
  for (size_t i = 0; i < rules_.size(); ++i) {
    if (left_out_.contains(i)) continue;
    followed.insert(i);
    const std::string name = absl::StrCat(rules_[i].second.name, " ");
    if (absl::StartsWith(why, name) || why.find(absl::StrCat(" ", name)) != std::string::npos)
      named.insert(i);
  }
  for (const size_t i : named.empty() ? followed : named) {
    Warn(rules_[i].first,
         absl::StrCat("consistency was checked without these rules: beside ", kRuleSet, ", ", why), "");
    left_out_.insert(i);
  }
}

ConsistencyCheck::Conflict ConsistencyCheck::ToConflict(explain::Proof proof) const {
  Conflict conflict;
  const explain::ProofStep root = proof.steps[proof.roots[0]];
  conflict.rule = root.rule;
  for (explain::ProofStep& step : proof.steps) {
    if (step.told.empty()) continue;
    const Quad quad{dictionary_.Find(step.fact.subject).value_or(TermId()),
                    dictionary_.Find(step.fact.predicate).value_or(TermId()),
                    dictionary_.Find(step.fact.object).value_or(TermId()), TermId()};
    conflict.leaves.push_back(quad);
    const auto place = places_.find(quad);
    if (place == places_.end()) continue;
    const SourceSpan& at = place->second.at.object;
    step.told = {
        {Term(), 0, 0, absl::StrCat("in ", sources_[place->second.file].file, ":", at.line, ":", at.column)}};
  }
  std::sort(conflict.leaves.begin(), conflict.leaves.end());
  // that it is reported is what the finding says; its proof begins with what the report is made of
  proof.roots = root.premises;
  proof.bindings = root.bindings;
  proof.conditions = root.conditions;
  for (std::string& condition : proof.conditions) {
    if (condition.size() > kConditionBytes) condition = "a filter of the rule, which is too long to be shown";
  }
  conflict.proof = explain::ToText(proof, prefixes_);
  return conflict;
}

void ConsistencyCheck::Prove(const GraphVersionPtr& version, Cancellation* cancellation) {
  const auto type = dictionary_.FindIri(kRdfType),
             inconsistency = dictionary_.FindIri(DocentIri("Inconsistency"));
  const auto inferred = dictionary_.FindIri(kInferredGraph), rule = dictionary_.FindIri(DocentIri("rule"));
  if (!type || !inconsistency || !inferred) return;
  if (!version->ContainsMatch({{}, *type, *inconsistency, *inferred})) return;
  explain::Explainer::Settings settings;
  settings.version = version;
  settings.dictionary = &dictionary_;
  settings.rules = followed_;
  settings.functions = functions_;
  settings.cancellation = cancellation;
  settings.prefixes = prefixes_;
  auto explainer = explain::Explainer::Make(settings);
  if (!explainer.ok()) return Warn(0, Reason(explainer.status(), limits_), "");
  std::vector<Conflict> conflicts;
  size_t reports = 0;
  absl::Status stopped;
  for (QuadCursor found = version->Scan({TermId(), *type, *inconsistency, *inferred}); found.Valid();
       found.Next()) {
    if (++reports > limits_.check_inconsistencies || !stopped.ok()) continue;
    const Term report = dictionary_.Decode(found.quad().subject);
    auto proof = (*explainer)
                     ->WhyFact({report, Term::Iri(std::string(kRdfType)),
                                Term::Iri(DocentIri("Inconsistency")), Term()});
    QuadCursor named = version->Scan({found.quad().subject, rule.value_or(TermId()), TermId(), *inferred});
    const std::string check = named.Valid() ? dictionary_.Decode(named.quad().object).lexical : "";
    if (proof.ok() && *proof) {
      conflicts.push_back(ToConflict(**std::move(proof)));
    } else {
      if (absl::IsDeadlineExceeded(proof.status())) stopped = proof.status();
      conflicts.push_back(
          {"", check, absl::StrCat("no proof was found: ", std::string(proof.status().message()), "\n"), {}});
    }
    conflicts.back().check = check;
  }
  // Of several that rest on the same facts the one with the shortest proof.
  std::stable_sort(conflicts.begin(), conflicts.end(), [](const Conflict& a, const Conflict& b) {
    return std::pair(a.leaves.size(), a.proof.size()) < std::pair(b.leaves.size(), b.proof.size());
  });
  std::vector<const Conflict*> kept;
  for (const Conflict& conflict : conflicts) {
    const bool known =
        !conflict.leaves.empty() && std::any_of(kept.begin(), kept.end(), [&](const Conflict* other) {
          return !other->leaves.empty() && std::includes(conflict.leaves.begin(), conflict.leaves.end(),
                                                         other->leaves.begin(), other->leaves.end());
        });
    if (known) continue;
    kept.push_back(&conflict);
    Tell(conflict);
  }
  if (!stopped.ok()) {
    Warn(0,
         absl::StrCat(reports,
                      " inconsistencies are reported; not all were proved: ", Reason(stopped, limits_)),
         "correct these first");
  } else if (reports > limits_.check_inconsistencies) {
    Warn(0,
         absl::StrCat(reports - limits_.check_inconsistencies,
                      " more inconsistencies are reported; the limit check_inconsistencies is ",
                      limits_.check_inconsistencies),
         "correct these first");
  }
}

// At the last told fact about a thing in a file that is checked, else at an axiom, else at the rule that says so.
void ConsistencyCheck::Tell(const Conflict& conflict) {
  Result result;
  const Place* best = nullptr;
  const auto rank = [this](const Place& place) {
    return std::pair(sources_[place.file].findings, !place.schema);
  };
  for (const Quad& leaf : conflict.leaves) {
    const auto found = places_.find(leaf);
    if (found == places_.end()) continue;
    const Place& place = found->second;
    result.told.emplace_back(sources_[place.file].file, place.at);
    const bool later =
        best != nullptr && rank(place) == rank(*best) &&
        (place.file != best->file ? place.file > best->file : Before(best->at.object, place.at.object));
    if (best == nullptr || rank(place) > rank(*best) || later) best = &place;
  }
  size_t file = 0;
  SourceSpan span;
  if (best != nullptr && sources_[best->file].findings) {
    file = best->file;
    span = best->at.object;
  } else if (const auto rule = rule_places_.find(conflict.rule);
             rule != rule_places_.end() && sources_[rule->second.first].findings) {
    std::tie(file, span) = rule->second;
  } else {
    file = WithFindings(0);
  }
  result.check = conflict.check;
  result.finding = {
      "inconsistency",
      {sources_[file].file, span, absl::StrCat("the facts contradict each other, by ", conflict.rule), kMend,
       Diagnostic::Severity::kError},
      conflict.proof};
  results_[sources_[file].file].push_back(std::move(result));
}

std::map<std::string, std::vector<ConsistencyCheck::Result>> ConsistencyCheck::Run() {
  results_.clear();
  if (sources_.empty()) return {};
  prefixes_.insert(prefixes_.end(), kWellKnownPrefixes.begin(), kWellKnownPrefixes.end());
  constexpr char kFewer[] = "name fewer files at a time, or load them into a server that follows owl2rl";
  if (told_.size() > limits_.check_facts) {
    Warn(0,
         absl::StrCat("consistency was not checked: there are more facts than the limit check_facts = ",
                      limits_.check_facts),
         kFewer);
    return std::move(results_);
  }
  Cancellation cancellation{std::chrono::milliseconds(limits_.check_consistency_ms)};
  GraphVersionPtr version;
  absl::Status status = Materialise(&cancellation, &version);
  while (!status.ok() && !absl::IsDeadlineExceeded(status) && !absl::IsResourceExhausted(status) &&
         left_out_.size() < rules_.size()) {
    LeaveOut(std::string(status.message()));
    status = Materialise(&cancellation, &version);
  }
  if (!status.ok()) {
    Warn(0, absl::StrCat("consistency was not checked: ", Reason(status, limits_)), kFewer);
    return std::move(results_);
  }
  Prove(version, &cancellation);
  return std::move(results_);
}

}  // namespace docent::server
