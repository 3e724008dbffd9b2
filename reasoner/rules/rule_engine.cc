#include "reasoner/rules/rule_engine.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/base/step_costs.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/rules/equality_classes.h"
#include "reasoner/rules/inconsistency.h"
#include "reasoner/rules/materialiser.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent::rules {
namespace {

// `change`, after `removed` was taken out.
Delta NetChange(const std::vector<Quad>& removed, Delta change) {
  if (removed.empty()) return change;
  absl::flat_hash_set<Quad> gone(removed.begin(), removed.end());
  std::erase_if(change.added, [&](const Quad& quad) { return gone.erase(quad) != 0; });
  change.removed.assign(gone.begin(), gone.end());
  std::sort(change.removed.begin(), change.removed.end());
  return change;
}

}  // namespace

struct RuleEngine::Impl {
  // The compiled current rules, and the rules of the inferred graph.
  struct State {
    RuleSets sets;
    std::shared_ptr<RuleProgram> wanted;   // null: no rules
    std::shared_ptr<RuleProgram> applied;  // differs from wanted: the next Update applies the change
  };

  Impl(Dictionary& d, const Limits& l, const sparql::FunctionRegistry* f)
      : dictionary(d),
        limits(l),
        functions(f),
        inferred_graph(d.InternIri(kInferredGraph)),
        inconsistencies(d) {}

  absl::Status CheckTold(const Delta& told) const {
    for (const auto* quads : {&told.added, &told.removed}) {
      for (const Quad& quad : *quads) {
        if (quad.graph != inferred_graph) continue;
        return absl::InvalidArgumentError(
            absl::StrCat("the graph <", std::string(kInferredGraph),
                         "> holds facts derived by rules; write the fact to another graph (subject ",
                         ToNTriples(dictionary.Decode(quad.subject)), ")"));
      }
    }
    return absl::OkStatus();
  }

  Dictionary& dictionary;
  const Limits limits;
  const sparql::FunctionRegistry* functions;
  const TermId inferred_graph;
  InconsistencyFacts inconsistencies;
  // If no rules are applied, inferred facts are from another engine, which may have inferred otherwise: this one begins without
  // them.
  std::vector<Quad> TakeOutInferred(GraphWriter& writer) const {
    std::vector<Quad> quads;
    if (state.applied != nullptr) return quads;
    writer.current().ForEach({TermId(), TermId(), TermId(), inferred_graph}, [&](const Quad& quad) {
      quads.push_back(quad);
      return true;
    });
    writer.RemoveAll(quads);
    return quads;
  }
  // For the terms of the graph before the change `told`.
  void BuildClasses(const RuleProgram& before, const RuleProgram& program, const GraphVersion& graph,
                    const Delta& told) {
    classes.Clear();
    if (!before.equality.by_classes && !program.equality.by_classes) return;
    const TermId same_as = (before.equality.by_classes ? before : program).equality.same_as;
    absl::flat_hash_set<Quad> added;
    for (const Quad& q : told.added) {
      if (q.predicate == same_as) added.insert(q);
    }
    graph.ForEach({TermId(), same_as, TermId(), TermId()}, [&](const Quad& q) {
      if (!added.contains(q)) classes.Join(q.subject, q.object);
      return true;
    });
    for (const Quad& q : told.removed) {
      if (q.predicate == same_as) classes.Join(q.subject, q.object);
    }
    classes.Settle();
  }

  matching::ComputedTerms computed{dictionary};  // since the last Commit
  RuleProgram no_rules;
  EqualityClasses classes;                 // as schema
  SchemaIndex schema;                      // of the applied program, in the graph as of the last Update
  const RuleProgram* schema_of = nullptr;  // null: must be built
  bool changed_since_commit = false;
  State state;
  State committed;
  size_t inferred_since_commit = 0;
  Counters counters;
};

RuleEngine::RuleEngine(Dictionary& dictionary, const Limits& limits,
                       const sparql::FunctionRegistry* functions)
    : impl_(std::make_unique<Impl>(dictionary, limits, functions)) {}
RuleEngine::~RuleEngine() = default;

Diagnostics RuleEngine::PutRules(std::string_view name, std::string_view text, RuleTextOrigin origin) {
  ParsedRules parsed = ParseRules(text, name, impl_->limits, impl_->functions, origin);
  Diagnostics diagnostics = std::move(parsed.diagnostics);
  if (HasErrors(diagnostics)) return diagnostics;
  RuleSets sets = impl_->state.sets;
  sets[std::string(name)] = std::make_shared<const ParsedRules>(std::move(parsed));
  auto program = RuleProgram::Build(sets, impl_->dictionary, impl_->functions, diagnostics, origin);
  if (program == nullptr) return diagnostics;
  impl_->state.sets = std::move(sets);
  impl_->state.wanted = std::move(program);
  return diagnostics;
}

bool RuleEngine::RemoveRules(std::string_view name) {
  RuleSets sets = impl_->state.sets;
  if (sets.erase(std::string(name)) == 0) return false;
  // It cannot fail: fewer rules need no order that more rules did not need.
  Diagnostics diagnostics;
  impl_->state.wanted =
      sets.empty() ? nullptr : RuleProgram::Build(sets, impl_->dictionary, impl_->functions, diagnostics);
  impl_->state.sets = std::move(sets);
  return true;
}

absl::StatusOr<Delta> RuleEngine::Update(GraphWriter& writer, const Delta& told, Cancellation* cancellation) {
  Impl& impl = *impl_;
  ++impl.counters.updates;
  if (absl::Status status = impl.CheckTold(told); !status.ok()) return status;
  const bool other_rules = impl.state.wanted != impl.state.applied;
  if (!other_rules && impl.state.wanted == nullptr) return told;
  RuleProgram& program = impl.state.wanted != nullptr ? *impl.state.wanted : impl.no_rules;
  RuleProgram& before = impl.state.applied != nullptr ? *impl.state.applied : impl.no_rules;
  impl.inconsistencies.InternWords();
  const std::vector<Quad> of_others = impl.TakeOutInferred(writer);
  const GraphWriter::Hiding without_reports(writer, impl.inconsistencies);
  if (impl.schema_of != &program) {
    impl.schema_of = nullptr;
    if (absl::Status status = impl.schema.Build(program, writer.current(), cancellation); !status.ok())
      return status;
    impl.BuildClasses(before, program, writer.current(), told);
    impl.schema_of = &program;
    impl.changed_since_commit = true;
  }
  if (!other_rules && told.empty()) return told;  // with a schema: what Reads says goes by the graph alone
  impl.changed_since_commit = true;
  if (other_rules) ++impl.counters.rule_changes;
  Limits limits = impl.limits;  // what another engine was allowed to infer may be inferred again
  limits.inferred_per_turn += of_others.size();
  if (cancellation != nullptr) cancellation->Lend(of_others.size() * kStepsOfFact);
  Materialiser materialiser(
      program, before, told,
      {writer, impl.schema, impl.classes, impl.inconsistencies, impl.dictionary, impl.inferred_graph, limits,
       impl.inferred_since_commit, impl.counters, cancellation, impl.computed});
  impl.computed.Begin();
  if (absl::Status status = materialiser.Maintain(); !status.ok()) return status;
  if (!program.equality.by_classes) impl.classes.Clear();
  impl.state.applied = impl.state.wanted;
  Delta delta = NetChange(of_others, materialiser.InferredChange());
  impl.counters.inferred += delta.added.size();
  impl.counters.retracted += delta.removed.size();
  delta.added.insert(delta.added.begin(), told.added.begin(), told.added.end());
  delta.removed.insert(delta.removed.begin(), told.removed.begin(), told.removed.end());
  return delta;
}

void RuleEngine::Commit() {
  impl_->committed = impl_->state;
  impl_->inferred_since_commit = 0;
  impl_->computed.Reset();
  impl_->changed_since_commit = false;
}

void RuleEngine::Rollback() {
  impl_->state = impl_->committed;
  impl_->inferred_since_commit = 0;
  impl_->computed.Reset();
  impl_->inconsistencies.ForgetWords();
  if (impl_->changed_since_commit) {
    impl_->schema_of = nullptr;
    if (impl_->state.applied != nullptr) impl_->state.applied->placed_for = 0;  // by terms that may be gone
  }
  impl_->changed_since_commit = false;
}

void RuleEngine::Adopt() {
  impl_->state.applied = impl_->state.wanted;
  Commit();
}

bool RuleEngine::Reads(const Quad& quad) const {
  const RuleProgram* program = impl_->state.applied.get();
  if (program == nullptr) return false;
  if (impl_->state.wanted != impl_->state.applied || impl_->schema_of != program) return true;
  const EqualityClasses& classes = impl_->classes;
  bool reads = quad.predicate == program->equality.same_as || classes.Find(quad.subject) != nullptr ||
               classes.Find(quad.object) != nullptr || classes.Find(quad.predicate) != nullptr;
  const auto visit = [&reads](matching::PatternIndex::Reference) { reads = true; };
  if (!reads) program->triggers.ForEachMatch(quad, visit);
  if (!reads) impl_->schema.triggers().ForEachMatch(quad, visit);
  return reads;
}

size_t RuleEngine::rule_count() const {
  return impl_->state.wanted == nullptr ? 0 : impl_->state.wanted->rules.size();
}

size_t RuleEngine::rule_count(std::string_view name) const {
  auto set = impl_->state.sets.find(std::string(name));
  return set == impl_->state.sets.end() ? 0 : set->second->rules.size();
}

std::vector<std::string> RuleEngine::names() const {
  std::vector<std::string> names;
  for (const auto& [name, rules] : impl_->state.sets) names.push_back(name);
  return names;
}

const RuleEngine::Counters& RuleEngine::counters() const {
  return impl_->counters;
}

}  // namespace docent::rules
