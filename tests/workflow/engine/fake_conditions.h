// Replaces the conditions in tests of the engine: a test defines which of them hold, with which solutions.
#ifndef DOCENT_TESTS_WORKFLOW_ENGINE_FAKE_CONDITIONS_H_
#define DOCENT_TESTS_WORKFLOW_ENGINE_FAKE_CONDITIONS_H_

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "workflow/engine/engine.h"

namespace docent::engine {

// A condition is identified by a text that its ASK contains.
class FakeConditions final : public ConditionView {
 public:
  // From now on conditions whose ASK contains `word` hold with these solutions (empty: they do not hold).
  void Set(const std::string& word, std::vector<TermBinding> solutions) {
    for (const auto& [handle, request] : armed_) {
      if (!absl::StrContains(request.ask, word)) continue;
      AddEdge(request, Find(request.ask), solutions);
    }
    answers_[word] = std::move(solutions);
  }
  void Take(const EngineOutput& output) {
    edges_.clear();
    for (ConditionHandle handle : output.disarm) armed_.erase(handle);
    for (const ConditionRequest& request : output.arm) {
      armed_[request.handle] = request;
      if (!request.only_new) AddEdge(request, {}, Find(request.ask));
    }
  }
  size_t armed() const { return armed_.size(); }

  const std::vector<ConditionEdge>& edges() const override { return edges_; }
  bool Holds(ConditionHandle handle) const override {
    auto it = armed_.find(handle);
    return it != armed_.end() && !Find(it->second.ask).empty();
  }
  absl::StatusOr<std::vector<TermBinding>> Solutions(ConditionHandle handle, const TermBinding& fixed,
                                                     size_t limit) const override {
    std::vector<TermBinding> out;
    for (const TermBinding& solution : Find(armed_.at(handle).ask)) {
      bool agrees = true;
      for (const auto& [name, term] : fixed)
        agrees = agrees && solution.count(name) > 0 && solution.at(name) == term;
      if (agrees && out.size() < limit) out.push_back(solution);
    }
    return out;
  }
  std::string Evidence(ConditionHandle, const TermBinding&) const override {
    return "<urn:s> <urn:p> <urn:o> .\n";
  }

 private:
  std::vector<TermBinding> Find(const std::string& ask) const {
    for (const auto& [word, solutions] : answers_) {
      if (absl::StrContains(ask, word)) return solutions;
    }
    return {};
  }
  static std::vector<TermBinding> Keys(const ConditionRequest& request,
                                       const std::vector<TermBinding>& solutions) {
    std::vector<TermBinding> keys;
    for (const TermBinding& solution : solutions) {
      TermBinding key;
      for (const std::string& name : request.key_variables) key[name] = solution.at(name);
      keys.push_back(std::move(key));
    }
    return keys;
  }
  void AddEdge(const ConditionRequest& request, const std::vector<TermBinding>& before,
               const std::vector<TermBinding>& after) {
    ConditionEdge edge;
    edge.handle = request.handle;
    edge.rose = before.empty() && !after.empty();
    edge.fell = !before.empty() && after.empty();
    if (!request.key_variables.empty()) {
      std::vector<TermBinding> old = Keys(request, before), now = Keys(request, after);
      for (const TermBinding& key : now) {
        if (std::find(old.begin(), old.end(), key) == old.end()) edge.appeared.push_back(key);
      }
      for (const TermBinding& key : old) {
        if (std::find(now.begin(), now.end(), key) == now.end()) edge.disappeared.push_back(key);
      }
    }
    if (edge.rose || edge.fell || !edge.appeared.empty() || !edge.disappeared.empty())
      edges_.push_back(std::move(edge));
  }

  std::map<ConditionHandle, ConditionRequest> armed_;
  std::map<std::string, std::vector<TermBinding>> answers_;
  std::vector<ConditionEdge> edges_;
};

// Robots that offer everything, or one operation.
class FakeRobots final : public RobotDirectory {
 public:
  std::vector<RobotOffer> offers;
  std::map<std::string, Occupation> by_operation;  // what it occupies
  std::string only;                                // empty: everything
  bool news = true;                                // what changed() says
  mutable int asked = 0;                           // how often Offers was called
  const std::vector<RobotOffer>& Offers(const std::string& operation) const override {
    static const std::vector<RobotOffer> kNone;
    ++asked;
    if (!only.empty() && only != operation) return kNone;
    const auto occupies = by_operation.find(operation);
    if (occupies == by_operation.end()) return offers;
    std::vector<RobotOffer>& kept = kept_[operation];
    kept = offers;
    for (RobotOffer& offer : kept) offer.occupies = occupies->second;
    return kept;
  }
  bool changed() const override { return news; }

 private:
  mutable std::map<std::string, std::vector<RobotOffer>> kept_;
};

}  // namespace docent::engine

#endif  // DOCENT_TESTS_WORKFLOW_ENGINE_FAKE_CONDITIONS_H_
