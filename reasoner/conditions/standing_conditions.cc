#include "reasoner/conditions/standing_conditions.h"

#include <algorithm>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "reasoner/conditions/bindings.h"
#include "reasoner/conditions/standing_conditions_impl.h"

namespace docent::conditions {
namespace {

// Queries with the same fingerprint have the same answers.
std::string Fingerprint(const sparql::Query& query, const std::vector<std::string>& keys) {
  std::string text = sparql::PrintAlgebra(matching::WithoutModifiers(*query.algebra));
  for (const Term& term : query.from) absl::StrAppend(&text, "\nFROM ", term.lexical);
  for (const Term& term : query.from_named) absl::StrAppend(&text, "\nNAMED ", term.lexical);
  for (const std::string& key : keys) absl::StrAppend(&text, "\n?", key);
  return text;
}

}  // namespace

bool StandingConditions::Impl::Shared::IsFollowed() const {
  if (groups == nullptr) return !followers.empty();
  return !followers.empty() || std::any_of(groups->begin(), groups->end(),
                                           [](const auto& group) { return group && !group->empty(); });
}

StandingConditions::StandingConditions(Dictionary& dictionary, const sparql::FunctionRegistry* functions)
    : impl_(std::make_unique<Impl>(dictionary, functions)) {}
StandingConditions::~StandingConditions() = default;

namespace {

// The columns of the key variables.
absl::StatusOr<Condition::Keys> KeyColumns(const matching::Body& body,
                                           const std::vector<std::string>& names) {
  Condition::Keys keys;
  for (const std::string& name : names) {
    const int column = body.ColumnOf(name);
    if (column < 0) {
      return absl::InvalidArgumentError(
          absl::StrCat("key variable ?", name, " is not bound by the condition"));
    }
    keys.push_back(static_cast<int16_t>(column));
  }
  return keys;
}

}  // namespace

absl::StatusOr<uint32_t> StandingConditions::Impl::Make(const sparql::Query& query, const GraphVersion& now,
                                                        const RegisterOptions& options,
                                                        std::string fingerprint) {
  indexes.SetGraphSize(now.size());
  const std::optional<TemplateForm> form = SplitConstants(query);
  std::string template_name = form ? Fingerprint(form->shared, {}) : "";
  const uint32_t number = conditions.Next();
  Shared* condition = nullptr;
  if (form) {
    const absl::StatusOr<Shared*> borrower = BorrowBody(*form, template_name, options);
    if (!borrower.ok()) return borrower.status();
    condition = *borrower;
  }
  const bool borrowed = condition != nullptr;
  if (!borrowed) {
    auto body = matching::Body::Compile(query, dictionary, functions);
    if (!body.ok()) return body.status();
    auto keys = KeyColumns(**body, options.key_variables);
    if (!keys.ok()) return keys.status();
    condition = &conditions.Make(number, *std::move(body), *std::move(keys), indexes);
  }
  Shared& shared = *condition;
  Condition::Edits first;
  const sparql::RunOptions run{
      .version = &now, .cancellation = options.cancellation, .now_us = options.now_us};
  computed.Begin();
  absl::Status status = shared.Refresh(run, first);
  if (status.ok()) status = CheckMemory(run);
  if (!status.ok()) {
    conditions.Remove(number);
    return status;
  }
  if (shared.body().is_volatile()) volatile_conditions.push_back(number);
  by_fingerprint.emplace(fingerprint, number);
  shared.fingerprint = std::move(fingerprint);
  shared.template_name = std::move(template_name);
  if (form) JoinTemplate(number, *form, borrowed, now);
  shared.Arm(&now);
  return number;
}

absl::Status StandingConditions::Impl::CheckMemory(const sparql::RunOptions& run) {
  if (run.cancellation == nullptr) return absl::OkStatus();
  if (!indexes.live_exceeded) return computed.Check();
  return absl::ResourceExhaustedError(
      absl::StrCat("the conditions of workflows would keep more than ", indexes.most_live,
                   " matches together; the limit is matches_live; undeploy a workflow, or narrow what its "
                   "activator asks for"));
}

absl::StatusOr<StandingConditions::Impl::Shared*> StandingConditions::Impl::BorrowBody(
    const TemplateForm& form, const std::string& template_name, const RegisterOptions& options) {
  const auto like = alike.find(template_name);
  if (like == alike.end() || !like->second.template_number) return nullptr;
  ConditionTemplate& condition_template = *templates[*like->second.template_number];
  if (!condition_template.lends_body()) return nullptr;
  auto keys = KeyColumns(condition_template.body(), options.key_variables);
  if (!keys.ok()) return keys.status();
  ConditionTemplate::Constants constants;
  for (const Term& constant : form.constants) constants.push_back(dictionary.Intern(constant));
  return &conditions.Make(conditions.Next(), &condition_template, std::move(constants), *keys);
}

void StandingConditions::Impl::JoinTemplate(uint32_t number, const TemplateForm& form, bool borrowed,
                                            const GraphVersion& now) {
  Shared& shared = conditions[number];
  Alike& like = alike[shared.template_name];
  ++like.count;
  if (like.shares_nothing || borrowed) return;
  ConditionTemplate::Constants constants;
  for (const Term& constant : form.constants) constants.push_back(dictionary.Intern(constant));
  like.alone.emplace_back(number, std::move(constants));
  if (like.count <= kAloneAtMost) return;
  if (!like.template_number) {
    const auto free = std::find(templates.begin(), templates.end(), nullptr);
    const auto place = static_cast<uint32_t>(free - templates.begin());
    auto condition_template =
        ConditionTemplate::Make(place, form, shared.body(), indexes, dictionary, functions);
    like.shares_nothing = !condition_template.ok() || *condition_template == nullptr;
    if (free == templates.end() && !like.shares_nothing) templates.emplace_back();
    if (!like.shares_nothing) templates[place] = *std::move(condition_template);
    if (!like.shares_nothing) like.template_number = place;
  }
  for (auto& [alone, values] : std::exchange(like.alone, {})) {
    if (like.shares_nothing) continue;
    conditions[alone].SetTemplate(templates[*like.template_number].get(), std::move(values));
    if (alone == number) continue;  // its creator arms it
    conditions[alone].Arm(&now);
    journal.push_back({JournalEntry::Kind::kArmed, alone, {}});
  }
}

// Called after the condition is removed.
void StandingConditions::Impl::LeaveTemplate(const std::string& template_name, uint32_t number) {
  const auto found = alike.find(template_name);
  if (found == alike.end()) return;
  std::erase_if(found->second.alone, [number](const auto& alone) { return alone.first == number; });
  if (--found->second.count > 0) return;
  if (found->second.template_number) templates[*found->second.template_number].reset();
  alike.erase(found);
}

absl::StatusOr<uint32_t> StandingConditions::Impl::FindOrMake(const sparql::Query& query,
                                                              const GraphVersion& now,
                                                              const RegisterOptions& options) {
  std::string fingerprint = Fingerprint(query, options.key_variables);
  const auto found = by_fingerprint.find(fingerprint);
  return found != by_fingerprint.end() ? found->second : Make(query, now, options, std::move(fingerprint));
}

// nullopt: too few similar conditions, or too many values to remember.
absl::StatusOr<std::optional<uint32_t>> StandingConditions::Impl::GroupCondition(
    const ThresholdForm& form, const GraphVersion& now, const RegisterOptions& options) {
  const RegisterOptions grouped{{form.variable}, options.now_us, options.cancellation};
  std::string fingerprint = Fingerprint(form.shared, grouped.key_variables);
  const auto found = by_fingerprint.find(fingerprint);
  if (found != by_fingerprint.end()) return found->second;
  if (thresholds_alone.size() > 100000) thresholds_alone.clear();
  int64_t& alone = thresholds_alone[fingerprint];
  if (++alone <= kThresholdsAlone || alone >= kMaxGroupSolutions) return std::nullopt;
  auto body = matching::Body::Compile(form.shared, dictionary, functions);
  if (!body.ok()) return body.status();
  int64_t solutions = 0;
  const std::vector<TermId> nothing((*body)->columns().size());
  const sparql::RunOptions run{
      .version = &now, .cancellation = options.cancellation, .now_us = options.now_us};
  const absl::Status status = (*body)->Evaluate(
      run, nothing, [&](absl::Span<const TermId>) { return ++solutions <= kMaxGroupSolutions; });
  if (!status.ok()) return status;
  if (solutions > kMaxGroupSolutions) {
    alone = kMaxGroupSolutions;
    return std::nullopt;
  }
  const absl::StatusOr<uint32_t> made = Make(form.shared, now, grouped, std::move(fingerprint));
  if (!made.ok()) return made.status();
  return *made;
}

absl::StatusOr<std::optional<StandingConditions::Impl::Subscriber>> StandingConditions::Impl::JoinGroup(
    ConditionId id, const sparql::Query& query, const GraphVersion& now, const RegisterOptions& options) {
  if (!options.key_variables.empty()) return std::nullopt;
  const std::optional<ThresholdForm> form = SplitThreshold(query);
  if (!form) return std::nullopt;
  const absl::StatusOr<std::optional<uint32_t>> number = GroupCondition(*form, now, options);
  if (!number.ok()) return number.status();
  if (!*number) return std::nullopt;
  Shared& shared = conditions[**number];
  const bool above = ThresholdGroup::IsAbove(form->op);
  if (!shared.groups) shared.groups = std::make_unique<Groups>();
  shared.set_grouped();
  std::unique_ptr<ThresholdGroup>& group = (*shared.groups)[above];
  const sparql::RunOptions run{.version = &no_graph};
  if (!group) {
    group = std::make_unique<ThresholdGroup>(above, dictionary, comparer);
    for (const Condition::Key& key : shared.Present()) group->SetKey(key[0], true);
    if (absl::Status status = group->Relevel(run, [](ConditionId, bool) {}); !status.ok()) return status;
  }
  const TermId constant = dictionary.Intern(form->constant);
  if (absl::Status status = group->AddMember(id, form->op, constant, run); !status.ok()) return status;
  return Subscriber{**number, false, Threshold{above, constant}};
}

absl::StatusOr<ConditionId> StandingConditions::Register(const sparql::Query& ask, const GraphVersion& now,
                                                         const RegisterOptions& options) {
  if (ask.form != sparql::Query::Form::kAsk && ask.form != sparql::Query::Form::kSelect) {
    return absl::InvalidArgumentError("a standing condition is an ASK or SELECT query");
  }
  const ConditionId id(impl_->next_id);
  absl::StatusOr<std::optional<Impl::Subscriber>> grouped = impl_->JoinGroup(id, ask, now, options);
  if (!grouped.ok()) return grouped.status();
  Impl::Subscriber follower;
  if (*grouped) {
    follower = **grouped;
  } else {
    const absl::StatusOr<uint32_t> number = impl_->FindOrMake(ask, now, options);
    if (!number.ok()) return number.status();
    follower.condition = *number;
    impl_->conditions[*number].followers.push_back(id);
  }
  ++impl_->next_id;
  impl_->followers.emplace(id, follower);
  impl_->journal.push_back({Impl::JournalEntry::Kind::kRegistered, follower.condition, id});
  return id;
}

void StandingConditions::Remove(ConditionId id) {
  const auto found = impl_->followers.find(id);
  if (found == impl_->followers.end() || found->second.removed) return;
  found->second.removed = true;
  ++impl_->removals;
  impl_->journal.push_back({Impl::JournalEntry::Kind::kRemoved, found->second.condition, id});
}

ThresholdGroup& StandingConditions::Impl::GroupOf(const Subscriber& follower) const {
  return *(*conditions[follower.condition].groups)[follower.threshold->above];
}

void StandingConditions::Impl::Unfollow(ConditionId id) {
  const auto found = followers.find(id);
  const Subscriber follower = found->second;
  followers.erase(found);
  Shared& shared = conditions[follower.condition];
  if (follower.threshold) {
    GroupOf(follower).RemoveMember(id, follower.threshold->constant);
  } else {
    shared.followers.erase(std::find(shared.followers.begin(), shared.followers.end(), id));
  }
  if (shared.IsFollowed()) return;
  std::erase(volatile_conditions, follower.condition);
  by_fingerprint.erase(shared.fingerprint);
  const std::string template_name = std::move(shared.template_name);
  conditions.Remove(follower.condition);
  LeaveTemplate(template_name, follower.condition);
}

bool StandingConditions::Impl::Holds(ConditionId id, const Subscriber& follower) const {
  if (follower.threshold) return GroupOf(follower).Holds(id, follower.threshold->constant);
  return conditions[follower.condition].holds();
}

bool StandingConditions::Holds(ConditionId id) const {
  const auto found = impl_->followers.find(id);
  return found != impl_->followers.end() && impl_->Holds(id, found->second);
}

void StandingConditions::LimitMatches(size_t most) {
  impl_->indexes.matches_allowed = most;
}

bool StandingConditions::MayChange(ConditionId id, const Quad& quad) const {
  const auto follower = impl_->followers.find(id);
  if (follower == impl_->followers.end()) return true;
  const Impl::Shared& condition = impl_->conditions[follower->second.condition];
  return condition.MayChange(quad, impl_->dictionary.FindIri(kRdfType));
}

bool StandingConditions::Overflowed(ConditionId id) const {
  const auto found = impl_->followers.find(id);
  return found != impl_->followers.end() && impl_->conditions[found->second.condition].overflowed();
}

std::vector<Binding> StandingConditions::Keys(ConditionId id) const {
  std::vector<Binding> bindings;
  const auto found = impl_->followers.find(id);
  if (found == impl_->followers.end()) return bindings;
  if (found->second.threshold) {
    if (impl_->Holds(id, found->second)) bindings.emplace_back();
    return bindings;
  }
  const Condition& condition = impl_->conditions[found->second.condition];
  for (const Condition::Key& key : condition.Present()) bindings.push_back(impl_->BindingOf(condition, key));
  SortBindings(bindings, impl_->dictionary);
  return bindings;
}

absl::StatusOr<std::vector<Binding>> StandingConditions::Solutions(ConditionId id,
                                                                   const GraphVersion& version,
                                                                   const Binding& fixed, size_t limit,
                                                                   TimeMicros now_us,
                                                                   Cancellation* cancellation) {
  const auto found = impl_->followers.find(id);
  if (found == impl_->followers.end()) return absl::NotFoundError("no such condition");
  const Impl::Subscriber& follower = found->second;
  Condition& condition = impl_->conditions[follower.condition];
  const std::vector<matching::Body::Column>& columns = condition.body().columns();
  std::vector<TermId> seed = condition.Seed();
  std::vector<std::pair<size_t, TermId>> wanted;  // column and value
  for (const auto& [name, value] : fixed) {
    const int column = condition.body().ColumnOf(name);
    if (column < 0 || !columns[column].visible) return std::vector<Binding>();
    wanted.emplace_back(column, value);
    if (columns[column].certain) seed[column] = value;
  }
  FirstBindings first(limit, impl_->dictionary);
  absl::Status compared;
  impl_->indexes.SetGraphSize(version.size());
  size_t rows = 0;
  const sparql::RunOptions run{.version = &version, .cancellation = cancellation, .now_us = now_us};
  const absl::Status status = condition.body().Evaluate(run, seed, [&](absl::Span<const TermId> row) {
    for (const auto& [column, value] : wanted) {
      if (row[column] != value) return true;
    }
    if (follower.threshold) {
      const TermId value = row[condition.keys()[0]];
      const auto admitted = impl_->GroupOf(follower).Admits(id, follower.threshold->constant, value, run);
      compared = admitted.status();
      if (!compared.ok()) return false;
      if (!*admitted) return true;
    }
    if (++rows > impl_->indexes.most_matches) {
      compared = absl::ResourceExhaustedError(absl::StrCat("the condition has more than ",
                                                           impl_->indexes.most_matches,
                                                           " solutions; the limit is condition_matches"));
      return false;
    }
    if (cancellation != nullptr) cancellation->Spend(kStepsOfSolution);
    Binding binding;
    for (size_t i = 0; i < row.size(); ++i) {
      if (columns[i].visible && !row[i].IsNone()) binding.emplace_back(columns[i].name, row[i]);
    }
    first.Add(std::move(binding));
    return true;
  });
  if (!status.ok() || !compared.ok()) return status.ok() ? compared : status;
  return first.Take();
}

size_t StandingConditions::size() const {
  return impl_->followers.size() - impl_->removals;
}

void StandingConditions::SetStopWatch(StopWatch now_ns) {
  impl_->now_ns = now_ns;
}

const StandingConditions::Counters& StandingConditions::counters() const {
  return impl_->counters;
}

}  // namespace docent::conditions
