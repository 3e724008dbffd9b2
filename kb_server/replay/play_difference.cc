#include "kb_server/replay/play_difference.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace docent::server {
namespace {

std::string AtTurn(const Decision& decision) {
  return absl::StrCat(Describe(decision), " in turn ", decision.turn);
}

std::string Show(const std::map<std::string, Term>& values, const std::string& name) {
  const auto value = values.find(name);
  return value == values.end() ? "no value" : absl::StrCat(name, " = ", ToDisplay(value->second));
}

std::vector<const Decision*> OfKind(const std::vector<Decision>& decisions, Decision::Kind kind) {
  std::vector<const Decision*> all;
  for (const Decision& decision : decisions) {
    if (decision.kind == kind) all.push_back(&decision);
  }
  return all;
}

class NodeComparer {
 public:
  explicit NodeComparer(bool in_document) : in_document_(in_document) {}

  void Compare(NodeComparison* node) {
    node_ = node;
    const bool whole = States(OfKind(node->recorded, Decision::Kind::kState),
                              OfKind(node->replayed, Decision::Kind::kState));
    Commands(OfKind(node->recorded, Decision::Kind::kCommand),
             OfKind(node->replayed, Decision::Kind::kCommand), whole);
    std::stable_sort(node->differences.begin(), node->differences.end(),
                     [](const Difference& a, const Difference& b) { return a.turn < b.turn; });
  }

 private:
  void Add(std::string kind, const Decision* recorded, const Decision* replayed, std::string instead = "") {
    Difference difference;
    difference.kind = std::move(kind);
    difference.turn = std::numeric_limits<uint64_t>::max();
    for (const Decision* decision : {recorded, replayed}) {
      if (decision != nullptr) difference.turn = std::min(difference.turn, decision->turn);
    }
    if (recorded != nullptr) difference.recorded = AtTurn(*recorded);
    difference.replayed = replayed != nullptr ? AtTurn(*replayed) : std::move(instead);
    node_->differences.push_back(std::move(difference));
  }

  // False: they part, and what comes after cannot be compared.
  bool States(const std::vector<const Decision*>& recorded, const std::vector<const Decision*>& replayed) {
    for (size_t i = 0; i < std::max(recorded.size(), replayed.size()); ++i) {
      if (i >= replayed.size()) {
        if (!in_document_)
          Add("no such node", recorded[i], nullptr, "the document has no such node");
        else
          Add("not reached", recorded[i], nullptr, NotReached(replayed));
        return false;
      }
      if (i >= recorded.size()) {
        Add("further", nullptr, replayed[i]);
        return false;
      }
      if (recorded[i]->to != replayed[i]->to) {
        Add("state", recorded[i], replayed[i]);
        return false;
      }
      if (recorded[i]->turn != replayed[i]->turn) Add("turn", recorded[i], replayed[i]);
    }
    return true;
  }

  std::string NotReached(const std::vector<const Decision*>& replayed) const {
    if (replayed.empty()) return "not reached";
    return absl::StrCat("still ", replayed.back()->to);
  }

  void Commands(const std::vector<const Decision*>& recorded, const std::vector<const Decision*>& replayed,
                bool whole) {
    for (size_t i = 0; i < std::max(recorded.size(), replayed.size()); ++i) {
      if (i >= replayed.size()) {
        if (whole) Add("command", recorded[i], nullptr, "not sent");
        return;
      }
      if (i >= recorded.size()) return Add("command", nullptr, replayed[i]);
      const Decision& a = *recorded[i];
      const Decision& b = *replayed[i];
      if (a.operation != b.operation)
        Add("command", &a, &b);
      else if (a.robot != b.robot)
        Add("robot", &a, &b);
      else if (a.arguments != b.arguments)
        Add("value", &a, &b);
    }
  }

  const bool in_document_;
  NodeComparison* node_ = nullptr;
};

void CompareValues(const char* kind, const std::map<std::string, Term>& recorded,
                   const std::map<std::string, Term>& replayed, uint64_t turn, NodeComparison* run) {
  std::set<std::string> names;
  for (const auto* values : {&recorded, &replayed}) {
    for (const auto& [name, value] : *values) names.insert(name);
  }
  for (const std::string& name : names) {
    const auto a = recorded.find(name), b = replayed.find(name);
    if (a != recorded.end() && b != replayed.end() && a->second == b->second) continue;
    run->differences.push_back({kind, turn, Show(recorded, name), Show(replayed, name)});
  }
}

// Whether a node of the run itself is in the document. Nodes of sub-flows count as being there.
bool IsInDocument(const RunCase& recorded, const cawl::Document& document, const std::string& path) {
  if (path.empty() || path.find('/') != std::string::npos) return true;
  const cawl::Flow* flow = document.FindFlow(recorded.flow);
  if (flow == nullptr) return false;
  return std::any_of(flow->nodes.begin(), flow->nodes.end(),
                     [&path](const cawl::Node& node) { return node.name.value == path; });
}

}  // namespace

std::string Describe(const Decision& decision) {
  if (decision.kind == Decision::Kind::kCommand) {
    std::vector<std::string> arguments;
    for (const auto& [name, value] : decision.arguments)
      arguments.push_back(absl::StrCat(name, "=", ToDisplay(value)));
    const std::string to = decision.operation == kNotifies ? decision.robot.value()
                                                           : ToDisplay(Term::Iri(decision.robot.value()));
    return absl::StrCat("sent ", decision.operation, "(", absl::StrJoin(arguments, ", "), ") to ", to);
  }
  if (decision.kind == Decision::Kind::kCancel) return absl::StrCat("cancelled ", decision.command.value());
  if (decision.node.empty()) return decision.from.empty() ? "started" : decision.to;
  return decision.to == "running" ? "opened" : decision.to;
}

std::vector<NodeComparison> Compare(const RunCase& recorded, const cawl::Document& document,
                                    const Play& play) {
  std::vector<NodeComparison> nodes;
  std::map<std::string, size_t> at;
  const auto of = [&](const std::string& path) -> NodeComparison& {
    const auto [known, is_new] = at.try_emplace(path, nodes.size());
    if (is_new) nodes.emplace_back().node = path;
    return nodes[known->second];
  };
  for (const Decision& decision : recorded.course.decisions) {
    if (!decision.node.empty()) of(decision.node).recorded.push_back(decision);
  }
  for (const Decision& decision : play.course.decisions) {
    if (!decision.node.empty()) of(decision.node).replayed.push_back(decision);
  }
  NodeComparison run;
  for (const auto& [from, to] : {std::pair(&recorded.course.decisions, &run.recorded),
                                 std::pair(&play.course.decisions, &run.replayed)}) {
    for (const Decision& decision : *from) {
      if (decision.node.empty()) to->push_back(decision);
    }
  }
  for (const PlayedWait& wait : play.waits) {
    if (wait.node == kActivator || !at.contains(wait.node)) continue;
    AddAlternative(wait, &of(wait.node).waits_for, &of(wait.node).missing);
  }
  nodes.push_back(std::move(run));
  for (NodeComparison& node : nodes) NodeComparer(IsInDocument(recorded, document, node.node)).Compare(&node);
  if (play.stopped_node != kActivator) {
    CompareValues("variable", recorded.course.variables, play.course.variables, recorded.last_turn,
                  &nodes.back());
    CompareValues("result", recorded.course.results, play.course.results, recorded.last_turn, &nodes.back());
  } else {
    NodeComparison& activator = nodes.emplace_back();
    activator.node = kActivator;
    activator.differences.push_back(
        {kActivator, recorded.turns.front().offset, "started the run", play.stopped});
    for (const PlayedWait& wait : play.waits) {
      if (wait.node == kActivator) activator.waits_for = wait.ask, activator.missing = wait.missing;
    }
  }
  const auto place = [](const NodeComparison& node) {
    const uint64_t turn = node.same() ? std::numeric_limits<uint64_t>::max() : node.differences.front().turn;
    return std::pair(turn, node.node == kActivator ? 0 : node.node.empty() ? 2 : 1);
  };
  std::stable_sort(nodes.begin(), nodes.end(), [&place](const NodeComparison& a, const NodeComparison& b) {
    return place(a) < place(b);
  });
  return nodes;
}

bool IsSame(const std::vector<NodeComparison>& nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [](const NodeComparison& node) { return node.same(); });
}

}  // namespace docent::server
