#include "kb_server/turn/condition_port.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/run_limits.h"
#include "graph/sparql/syntax/parser.h"

namespace docent::server {
namespace {

// What is kept of a request: texts, not queries.
engine::ConditionRequest WithoutQueries(engine::ConditionRequest request) {
  request.query.reset();
  for (engine::LastingPart& part : request.lasting) part.query.reset();
  return request;
}

}  // namespace

ConditionPort::ConditionPort(Dictionary* dictionary, conditions::StandingConditions* standing,
                             const rules::RuleEngine* rules)
    : dictionary_(dictionary), standing_(standing), rules_(rules) {
  standing_->LimitMatches(kRunLimits.condition_matches);
}

engine::TermBinding ConditionPort::Decode(const conditions::Binding& binding) const {
  engine::TermBinding terms;
  for (const auto& [name, id] : binding) {
    if (!id.IsNone()) terms.emplace(name, dictionary_->Decode(id));
  }
  return terms;
}

std::vector<engine::TermBinding> ConditionPort::Decode(
    const std::vector<conditions::Binding>& bindings) const {
  std::vector<engine::TermBinding> terms;
  for (const conditions::Binding& binding : bindings) terms.push_back(Decode(binding));
  return terms;
}

absl::StatusOr<conditions::ConditionId> ConditionPort::Register(
    const sparql::Query& query, const std::string& text, const std::vector<std::string>& key_variables,
    const GraphVersion& version, TimeMicros now_us, Cancellation* cancellation) {
  conditions::RegisterOptions options;
  options.cancellation = cancellation;
  options.key_variables = key_variables;
  options.now_us = now_us;
  auto id = standing_->Register(query, version, options);
  if (id.ok()) return id;
  return absl::Status(id.status().code(), absl::StrCat(id.status().message(), "\nin the condition\n", text));
}

absl::StatusOr<std::shared_ptr<const sparql::Query>> ConditionPort::QueryOf(
    const std::string& ask, const std::shared_ptr<const sparql::Query>& query) {
  if (query != nullptr) return query;
  sparql::ParsedQuery parsed = sparql::ParseQuery(ask);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, ask);
  return std::make_shared<const sparql::Query>(std::move(parsed.query));
}

absl::Status ConditionPort::Arm(const std::vector<engine::ConditionRequest>& requests,
                                const GraphVersion& version, TimeMicros now_us, Cancellation* cancellation) {
  for (const engine::ConditionRequest& request : requests) {
    if (cancellation != nullptr) {
      if (absl::Status status = cancellation->CheckNow(); !status.ok()) return status;
    }
    auto parsed = QueryOf(request.ask, request.query);
    if (!parsed.ok()) return parsed.status();
    const sparql::Query& query = **parsed;
    std::shared_ptr<Lasting> lasting;
    if (!request.lasting.empty()) lasting = std::make_shared<Lasting>(request.handle, request);
    auto id = Register(query, request.ask, lasting ? lasting->condition.variables() : request.key_variables,
                       version, now_us, cancellation);
    if (!id.ok()) return id.status();
    conditions_[request.handle] = {*id, std::make_shared<const ConditionEvidence>(query, dictionary_),
                                   std::make_shared<const engine::ConditionRequest>(WithoutQueries(request)),
                                   lasting};
    handles_[*id] = request.handle;
    armed_.push_back(request.handle);
    if (lasting) {
      if (absl::Status s = ArmParts(request, conditions_[request.handle], version, now_us, cancellation);
          !s.ok())
        return s;
      continue;
    }
    if (standing_->Overflowed(*id)) {
      GatherOverflow(request.handle);
      continue;
    }
    if (request.only_new || !standing_->Holds(*id)) continue;
    engine::ConditionEdge edge;
    edge.handle = request.handle;
    edge.rose = true;
    if (!request.key_variables.empty()) edge.appeared = Decode(standing_->Keys(*id));
    Gather(std::move(edge));
  }
  return absl::OkStatus();
}

absl::Status ConditionPort::Restore(const std::vector<engine::ConditionRequest>& requests,
                                    const std::vector<LastingSince>& times, const GraphVersion& version,
                                    TimeMicros now_us, Cancellation* cancellation) {
  // The graph may have become smaller since the matches that are kept came.
  standing_->LimitMatches(SIZE_MAX);
  absl::Status status = Arm(requests, version, now_us, cancellation);
  standing_->LimitMatches(kRunLimits.condition_matches);
  if (status.ok()) RestoreTimes(times);
  gathered_.clear();
  gathered_at_.clear();
  return status;
}

void ConditionPort::Disarm(const std::vector<engine::ConditionHandle>& handles) {
  for (engine::ConditionHandle handle : handles) {
    auto it = conditions_.find(handle);
    if (it == conditions_.end()) continue;
    standing_->Remove(it->second.id);
    handles_.erase(it->second.id);
    if (it->second.lasting) DisarmParts(*it->second.lasting);
    disarmed_.emplace_back(handle, std::move(it->second));
    conditions_.erase(it);
  }
}

std::vector<engine::ConditionRequest> ConditionPort::Requests() const {
  std::vector<engine::ConditionRequest> requests;
  for (const auto& [handle, condition] : conditions_) requests.push_back(*condition.request);
  std::sort(requests.begin(), requests.end(),
            [](const engine::ConditionRequest& a, const engine::ConditionRequest& b) {
              return a.handle < b.handle;
            });
  return requests;
}

void ConditionPort::Take(absl::Span<const conditions::ConditionChange> changes, TimeMicros now_us) {
  for (const conditions::ConditionChange& change : changes) {
    if (change.overflowed) {
      if (const auto it = handles_.find(change.id); it != handles_.end()) GatherOverflow(it->second);
      if (const auto part = parts_.find(change.id); part != parts_.end()) GatherOverflow(part->second.first);
      continue;
    }
    if (TakeLasting(change, now_us)) continue;
    auto it = handles_.find(change.id);
    if (it == handles_.end()) continue;
    engine::ConditionEdge edge;
    edge.handle = it->second;
    edge.rose = change.edge == conditions::ConditionChange::Edge::kRose;
    edge.fell = change.edge == conditions::ConditionChange::Edge::kFell;
    edge.appeared = Decode(change.appeared);
    edge.disappeared = Decode(change.disappeared);
    Gather(std::move(edge));
  }
}

void ConditionPort::Gather(engine::ConditionEdge edge) {
  auto [it, inserted] = gathered_at_.try_emplace(edge.handle, gathered_.size());
  if (inserted) {
    gathered_.push_back(std::move(edge));
    return;
  }
  if (edge.overflowed || gathered_[it->second].overflowed) {
    gathered_[it->second].overflowed = true;
    return;
  }
  // What appeared and went again before anybody looked was never there. What went and came back did both: an event that is
  // told again.
  engine::ConditionEdge& before = gathered_[it->second];
  engine::ConditionEdge net;
  net.handle = edge.handle;
  net.rose = edge.rose || (before.rose && !edge.fell);
  net.fell = before.fell || (edge.fell && !before.rose);
  net.moved = before.moved || edge.moved;
  auto without = [](const std::vector<engine::TermBinding>& all, const std::vector<engine::TermBinding>& gone,
                    std::vector<engine::TermBinding>* out) {
    const std::set<engine::TermBinding> left_out(gone.begin(), gone.end());
    std::copy_if(all.begin(), all.end(), std::back_inserter(*out),
                 [&left_out](const engine::TermBinding& key) { return !left_out.contains(key); });
  };
  without(before.appeared, edge.disappeared, &net.appeared);
  net.appeared.insert(net.appeared.end(), edge.appeared.begin(), edge.appeared.end());
  without(edge.disappeared, before.appeared, &net.disappeared);
  net.disappeared.insert(net.disappeared.end(), before.disappeared.begin(), before.disappeared.end());
  std::sort(net.appeared.begin(), net.appeared.end());
  std::sort(net.disappeared.begin(), net.disappeared.end());
  before = std::move(net);
}

void ConditionPort::GatherOverflow(engine::ConditionHandle handle) {
  engine::ConditionEdge edge;
  edge.handle = handle;
  edge.overflowed = true;
  Gather(std::move(edge));
}

void ConditionPort::BeginRound(const GraphVersion& version, TimeMicros now_us, Cancellation* cancellation) {
  SettleLasting(now_us);
  edges_ = std::move(gathered_);
  gathered_.clear();
  gathered_at_.clear();
  version_ = &version;
  now_us_ = now_us;
  cancellation_ = cancellation;
}

bool ConditionPort::Holds(engine::ConditionHandle handle) const {
  auto it = conditions_.find(handle);
  if (it == conditions_.end()) return false;
  if (it->second.lasting) return it->second.lasting->condition.holds();
  return standing_->Holds(it->second.id);
}

absl::StatusOr<std::vector<engine::TermBinding>> ConditionPort::Solutions(engine::ConditionHandle handle,
                                                                          const engine::TermBinding& fixed,
                                                                          size_t limit) const {
  auto it = conditions_.find(handle);
  if (it == conditions_.end()) return absl::NotFoundError("the condition is not armed");
  const Lasting* lasting = it->second.lasting.get();
  std::vector<engine::TermBinding> bindings;
  conditions::Binding wanted;
  for (const auto& [name, term] : fixed) {
    const std::optional<TermId> id = dictionary_->Find(term);
    if (!id) return bindings;
    wanted.emplace_back(name, *id);
  }
  auto solutions = standing_->Solutions(it->second.id, *version_, wanted,
                                        lasting != nullptr ? SIZE_MAX : limit, now_us_, cancellation_);
  if (!solutions.ok()) return solutions.status();
  for (const conditions::Binding& solution : *solutions) {
    if (lasting != nullptr && !lasting->condition.Admits(solution)) continue;
    bindings.push_back(Decode(solution));
    if (bindings.size() >= limit) break;
  }
  return bindings;
}

bool ConditionPort::MayChange(engine::ConditionHandle handle, const TermQuad& written) const {
  const auto it = conditions_.find(handle);
  if (it == conditions_.end() || it->second.lasting) return true;
  const Quad quad = {dictionary_->Intern(written.subject), dictionary_->Intern(written.predicate),
                     dictionary_->Intern(written.object), dictionary_->Intern(written.graph)};
  return standing_->MayChange(it->second.id, quad) || (rules_ != nullptr && rules_->Reads(quad));
}

std::string ConditionPort::Evidence(engine::ConditionHandle handle,
                                    const engine::TermBinding& binding) const {
  auto it = conditions_.find(handle);
  if (it == conditions_.end()) return "";
  return it->second.evidence->Text(*version_, binding);
}

void ConditionPort::Commit() {
  for (const std::shared_ptr<Lasting>& lasting : changed_) lasting->condition.Commit();
  changed_.clear();
  armed_.clear();
  disarmed_.clear();
}

void ConditionPort::Rollback() {
  for (engine::ConditionHandle handle : armed_) {
    auto it = conditions_.find(handle);
    if (it == conditions_.end()) continue;
    handles_.erase(it->second.id);
    if (it->second.lasting) ForgetParts(*it->second.lasting);
    conditions_.erase(it);
  }
  for (auto& [handle, condition] : disarmed_) {
    if (std::find(armed_.begin(), armed_.end(), handle) != armed_.end()) continue;
    handles_[condition.id] = handle;
    if (condition.lasting) RememberParts(*condition.lasting);
    conditions_[handle] = std::move(condition);
  }
  for (const std::shared_ptr<Lasting>& lasting : changed_) {
    lasting->condition.Rollback();
    lasting->opens_us = lasting->condition.OpensAt();
    if (conditions_.contains(lasting->handle)) List(*lasting, lasting->condition.NextDeadline());
  }
  unsettled_.clear();
  gathered_.clear();
  gathered_at_.clear();
  edges_.clear();
  Commit();
}

}  // namespace docent::server
