// What a run that ends has undone, in the simulation: of each node with ext:compensate, what a robot has said that it did.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_UNDO_MODEL_H_
#define DOCENT_TESTS_KB_SERVER_TURN_UNDO_MODEL_H_

#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/store/decisions.h"
#include "gtest/gtest.h"

namespace docent::server::test {

class UndoModel {
 public:
  // A command of the node said so in this turn. `compensated`: it does all that the node does, for one value of its forEach.
  void Succeeded(const std::string& run, const std::string& node, bool compensated) {
    if (compensated) done_.insert(absl::StrCat(run, "/", node));
  }

  void Take(const std::vector<Transition>& transitions) {
    for (const Transition& t : transitions) {
      const bool begins = t.from.empty() && t.to == "running";
      if (begins && t.cause.starts_with("undoes ")) {
        const std::vector<std::string> place = absl::StrSplit(t.cause.substr(7), '/');  // RUN/…/RUN/NODE
        undoes_[t.subject] = absl::StrCat(place[place.size() - 2], "/", place.back());
      }
      if (begins && t.cause.starts_with("subflow of ")) {
        const std::string parent = t.cause.substr(11);
        parents_[t.subject] = parent.substr(0, parent.find('/'));
      }
      if (absl::StrContains(t.cause, "an operator skips it")) done_.erase(t.subject);
      const auto undoes = undoes_.find(t.subject);
      if (undoes != undoes_.end() && t.to == "done") undone_.insert(undoes->second);
      if (!absl::StrContains(t.subject, '/') && t.from == "running") CheckEnd(t);
    }
  }
  size_t checked() const { return checked_; }

 private:
  void CheckEnd(const Transition& end) {
    if (end.to == "running") return;  // it begins to undo
    const bool says_so = absl::StrContains(end.cause, "what it did was undone");
    const std::set<std::string> left = NotUndone(end.cause);
    if (end.to != "failed" && !says_so && left.empty()) return;
    for (const std::string& done : done_) {
      const std::string run = done.substr(0, done.find('/')), node = done.substr(run.size() + 1);
      if (!IsIn(run, end.subject) || left.contains(node)) continue;
      ++checked_;
      EXPECT_TRUE(undone_.contains(done))
          << done << " was done, and is not undone at the end of " << end.subject << ": " << end.cause;
    }
  }

  // Names of the nodes that a run, or a sub-flow whose end it names, says it did not undo: "not undone: A, B/C: no
  // ext:compensate; D (drive): why" has A, C and D.
  static std::set<std::string> NotUndone(const std::string& cause) {
    std::set<std::string> names;
    const std::string not_undone = "not undone: ";
    const size_t at = cause.find(not_undone);
    if (at == std::string::npos) return names;
    const std::vector<std::string> items = absl::StrSplit(cause.substr(at), "; ");
    for (const std::string& item : items) {
      const std::string said = item.starts_with(not_undone) ? item.substr(not_undone.size()) : item;
      const std::vector<std::string> places = absl::StrSplit(said.substr(0, said.find(": ")), ", ");
      for (const std::string& place : places) {
        const std::string node = place.substr(0, place.find(" ("));
        names.insert(node.substr(node.rfind('/') + 1));
      }
    }
    return names;
  }

  bool IsIn(std::string run, const std::string& outer) const {
    while (run != outer) {
      const auto parent = parents_.find(run);
      if (parent == parents_.end()) return false;
      run = parent->second;
    }
    return true;
  }

  std::map<std::string, std::string> undoes_;   // a run, and the RUN/NODE that it undoes
  std::map<std::string, std::string> parents_;  // of sub-flows
  std::set<std::string> done_, undone_;         // RUN/NODE
  size_t checked_ = 0;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_UNDO_MODEL_H_
