#include "workflow/engine/activations.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/engine/run_facts.h"

namespace docent::engine {

std::string KeyText(const TermBinding& key) {
  return absl::StrJoin(key, " ", [](std::string* out, const auto& pair) {
    absl::StrAppend(out, pair.first, "=", ToNTriples(pair.second));
  });
}

const Activations::Key* Activations::Find(const Place& place) const {
  const auto known = state_.keys.find(place);
  return known == state_.keys.end() ? nullptr : &known->second;
}

std::vector<std::string> Activations::KeysOf(const std::string& workflow) const {
  std::vector<std::string> keys;
  for (auto it = state_.keys.lower_bound({workflow, ""});
       it != state_.keys.end() && it->first.first == workflow; ++it)
    keys.push_back(it->first.second);
  return keys;
}

size_t Activations::Waiting(const std::string& workflow) const {
  const auto known = waiting_.find(workflow);
  return known == waiting_.end() ? 0 : known->second;
}

Activations::Key& Activations::Mutable(const Place& place) {
  const Key* before = Find(place);
  undo_keys_.try_emplace(place, before == nullptr ? std::nullopt : std::make_optional(*before));
  return state_.keys[place];
}

void Activations::Drop(const Place& place) {
  if (const auto known = state_.keys.find(place); known != state_.keys.end() && known->second.empty())
    state_.keys.erase(known);
}

void Activations::Started(const Place& place, const RunId& run) {
  Mutable(place).live.push_back(run);
  places_.emplace(run, place);
}

std::optional<Activations::Place> Activations::Ended(const RunId& run) {
  const auto known = places_.find(run);
  if (known == places_.end()) return std::nullopt;
  Place place = std::move(known->second);
  places_.erase(known);
  std::erase(Mutable(place).live, run);
  Drop(place);
  return place;
}

void Activations::Wait(const Place& place, Firing firing) {
  Mutable(place).waiting.push_back(std::move(firing));
  ++waiting_[place.first];
  changed_.insert(place.first);
}

Activations::Firing Activations::Next(const Place& place) {
  Key& key = Mutable(place);
  Firing next = std::move(key.waiting.front());
  key.waiting.erase(key.waiting.begin());
  if (--waiting_[place.first] == 0) waiting_.erase(place.first);
  changed_.insert(place.first);
  Drop(place);
  return next;
}

void Activations::Ignored(const std::string& workflow) {
  const auto known = state_.ignored.find(workflow);
  undo_ignored_.try_emplace(workflow,
                            known == state_.ignored.end() ? std::nullopt : std::make_optional(known->second));
  ++state_.ignored[workflow];
  changed_.insert(workflow);
}

size_t Activations::Forget(const std::string& workflow) {
  size_t dropped = 0;
  for (const std::string& key : KeysOf(workflow)) {
    const Place place(workflow, key);
    if (Find(place)->waiting.empty()) continue;
    dropped += Find(place)->waiting.size();
    Mutable(place).waiting.clear();
    Drop(place);
  }
  waiting_.erase(workflow);
  if (const auto known = state_.ignored.find(workflow); known != state_.ignored.end()) {
    undo_ignored_.try_emplace(workflow, known->second);
    state_.ignored.erase(known);
  }
  changed_.insert(workflow);
  return dropped;
}

Activations::Facts Activations::FactsOf(const std::string& workflow, Dictionary* dictionary) const {
  Facts facts;
  const auto add = [&](const char* property, uint64_t count) {
    if (count == 0) return;
    facts.push_back({dictionary->InternIri(WorkflowIri(workflow)), dictionary->InternIri(DocentIri(property)),
                     dictionary->Intern(Term::Integer(static_cast<int64_t>(count))),
                     dictionary->InternIri(kRunsGraph)});
  };
  const auto ignored = state_.ignored.find(workflow);
  add("ignoredFirings", ignored == state_.ignored.end() ? 0 : ignored->second);
  add("waitingFirings", Waiting(workflow));
  std::sort(facts.begin(), facts.end());
  return facts;
}

void Activations::Tell(Dictionary* dictionary, std::vector<Quad>* add, std::vector<Quad>* remove) {
  for (const std::string& workflow : std::exchange(changed_, {})) {
    Facts now = FactsOf(workflow, dictionary);
    Facts& before = told_[workflow];
    undo_told_.try_emplace(workflow, before);
    DiffFacts(before, now, add, remove);
    before = std::move(now);
    if (before.empty()) told_.erase(workflow);
  }
}

void Activations::Index() {
  places_.clear();
  waiting_.clear();
  for (const auto& [place, key] : state_.keys) {
    for (const RunId& run : key.live) places_.emplace(run, place);
    if (!key.waiting.empty()) waiting_[place.first] += key.waiting.size();
  }
}

void Activations::Restore(State state, Dictionary* dictionary) {
  state_ = std::move(state);
  Index();
  std::set<std::string> workflows;
  for (const auto& [workflow, count] : state_.ignored) workflows.insert(workflow);
  for (const auto& [workflow, count] : waiting_) workflows.insert(workflow);
  for (const std::string& workflow : workflows) told_[workflow] = FactsOf(workflow, dictionary);
}

void Activations::Commit() {
  undo_keys_.clear();
  undo_ignored_.clear();
  undo_told_.clear();
}

void Activations::Rollback() {
  for (auto& [place, before] : undo_keys_) {
    if (before)
      state_.keys[place] = *std::move(before);
    else
      state_.keys.erase(place);
  }
  for (const auto& [workflow, before] : undo_ignored_) {
    if (before)
      state_.ignored[workflow] = *before;
    else
      state_.ignored.erase(workflow);
  }
  for (auto& [workflow, before] : undo_told_) {
    if (before.empty())
      told_.erase(workflow);
    else
      told_[workflow] = std::move(before);
  }
  changed_.clear();
  Commit();
  Index();
}

}  // namespace docent::engine
