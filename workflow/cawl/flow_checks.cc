#include <algorithm>
#include <map>
#include <set>

#include "graph/base/text.h"
#include "workflow/cawl/link_graph.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/structure_checks.h"

namespace docent::cawl {
namespace {

class FlowChecker {
 public:
  FlowChecker(const Flow& flow, xml::ElementReader* reader) : flow_(flow), reader_(*reader) {}

  void Check() {
    if (flow_.source.empty() || flow_.sink.empty()) return;
    if (flow_.source.value == flow_.sink.value) {
      reader_.Error(flow_.sink.span, Concat("source and sink have the same name ", flow_.sink.value));
      return;
    }
    for (const Node& node : flow_.nodes) {
      nodes_.insert(node.name.value);
      if (node.holds_condition || node.hold) with_hold_.insert(node.name.value);
    }
    for (const Link& link : flow_.links) CheckLink(link);
    CheckReachable();
    CheckCycles();
    for (const Node& node : flow_.nodes) CheckJoin(node);
    for (const Node& node : flow_.nodes) CheckOnFailure(node);
  }

 private:
  // Whether they are followed in the same cases.
  static bool SameKind(const Link& a, const Link& b) {
    return a.on_failure == b.on_failure && a.on_interrupt == b.on_interrupt &&
           a.while_text.value == b.while_text.value;
  }

  void CheckLink(const Link& link) {
    if (link.from.empty() || link.to.empty()) return;
    bool good =
        End(link.from, flow_.source.value, flow_.sink.value, "from", "the sink: nothing comes after it");
    good = End(link.to, flow_.sink.value, flow_.source.value, "to", "the source: nothing comes before it") &&
           good;
    if (!good) return;
    const auto [first, is_new] = seen_.try_emplace({link.from.value, link.to.value}, &link);
    if (!is_new) {
      const bool same = SameKind(*first->second, link);
      Diagnostic& report =
          reader_.Error(link.from.span, Concat("a second link from ", link.from.value, " to ", link.to.value),
                        same ? "leave it out"
                             : Concat("give this case a node of its own, which needs no invoke: a link from ",
                                      link.from.value, " to it, and one from it to ", link.to.value));
      if (same) report.fix = {reader_.Removal(link.span)};
      return;
    }
    if (link.from.value == flow_.source.value &&
        (link.on_failure || link.on_interrupt || link.while_text.given())) {
      reader_.Error(link.from.span, "a link out of the source has neither onFailure, onInterrupt nor while",
                    "the source cannot fail and is done at once");
    } else if (link.on_interrupt && !link.on_failure && !with_hold_.contains(link.from.value)) {
      reader_.Warning(link.from.span, Concat("this link is never followed: node ", link.from.value,
                                             " has no ext:while-holds that could fall"));
    }
    all_[link.from.value].insert(link.to.value);
    back_[link.to.value].insert(link.from.value);
    if (!link.while_text.given()) forward_[link.from.value].insert(link.to.value);
  }

  void CheckOnFailure(const Node& node) {
    if (node.compensate.given() && node.invokes.empty()) {
      reader_.Warning(node.compensate.span,
                      Concat("node ", node.name.value, " invokes nothing: there is nothing to undo"),
                      "take ext:compensate away");
    }
    const bool waits_for_ever = !node.condition || !node.condition->timeout_ms;
    const bool does_nothing = node.invokes.empty() && node.actions.empty();
    if (node.on_failure != OnFailure::kIncident || !does_nothing || !waits_for_ever) return;
    reader_.Warning(
        node.on_failure_text.span,
        Concat("node ", node.name.value, " cannot fail: it does nothing, and its wait has no end"),
        "take ext:onFailure away, or give its <condition> an ext:timeout");
  }

  bool End(const Text& name, const std::string& allowed, const std::string& wrong_end,
           std::string_view attribute, std::string_view why) {
    if (nodes_.contains(name.value) || name.value == allowed) return true;
    if (name.value == wrong_end) {
      reader_.Error(name.span, Concat(attribute, "=\"", name.value, "\" is ", why));
      return false;
    }
    if (reader_.full(Diagnostic::Severity::kError)) return false;
    std::vector<std::string> known(nodes_.begin(), nodes_.end());
    known.push_back(allowed);
    reader_.Error(name.span, Concat("there is no node ", name.value, " in flow ", flow_.name.value),
                  reader_.DidYouMean(name.value, known, Concat("known here: ", xml::ListOf(known))));
    return false;
  }

  // A run that comes to it need not come to the sink: it fails there.
  static bool Fails(const Node& node) {
    return std::any_of(node.actions.begin(), node.actions.end(),
                       [](const Action& action) { return action.kind == Action::Kind::kFail; });
  }

  void CheckReachable() {
    const std::set<std::string> from_source = Reachable(all_, {flow_.source.value});
    std::vector<std::string> ends{flow_.sink.value};
    for (const Node& node : flow_.nodes) {
      if (Fails(node)) ends.push_back(node.name.value);
    }
    const std::set<std::string> to_end = Reachable(back_, std::move(ends));
    for (const Node& node : flow_.nodes) {
      if (node.name.empty()) continue;
      if (!from_source.contains(node.name.value)) {
        reader_
            .Error(
                node.name.span,
                Concat("node ", node.name.value, " cannot be reached from the source ", flow_.source.value),
                "link it, or remove it")
            .rule = kUnreachableNode;
      } else if (!to_end.contains(node.name.value)) {
        reader_
            .Error(node.name.span,
                   Concat("node ", node.name.value, " has no path to the sink ", flow_.sink.value),
                   "a run would never end; link it on")
            .rule = kNoWayToSink;
      }
    }
    if (!from_source.contains(flow_.sink.value)) {
      reader_
          .Error(flow_.sink.span, Concat("no path leads from the source ", flow_.source.value,
                                         " to the sink ", flow_.sink.value))
          .rule = kNoWayToSink;
    }
  }

  // Reported once a cycle, at the link that closes it in document order. Nodes of a reported cycle begin no other one.
  void CheckCycles() {
    constexpr size_t kMaxReported = 10;
    const LinkGraph cycles = LinksOnCycles(forward_);
    std::set<std::string> told;
    size_t reported = 0;
    for (const Node& node : flow_.nodes) {
      if (reported == kMaxReported) return;
      if (!cycles.contains(node.name.value) || told.contains(node.name.value)) continue;
      const std::vector<std::string> way = ShortestWay(cycles, node.name.value, node.name.value);
      told.insert(way.begin(), way.end());
      ++reported;
      const Text* place = &node.name;
      for (const Link& link : flow_.links) {
        if (link.from.value == way[way.size() - 2] && link.to.value == way.back()) place = &link.from;
      }
      reader_.Error(place->span, Concat("the links form a cycle without while: ", Arrows(way)),
                    "say on the link that leads back how long to repeat: ext:while=\"subject verb object\"");
    }
  }

  void CheckJoin(const Node& node) {
    if (!node.join) return;
    auto it = back_.find(node.name.value);
    std::vector<std::string> before;
    if (it != back_.end()) before.assign(it->second.begin(), it->second.end());
    for (const Expression* e : NamesIn(*node.join)) {
      if (std::find(before.begin(), before.end(), e->name) != before.end()) continue;
      if (reader_.full(Diagnostic::Severity::kError)) return;
      reader_.Error(
          e->span, Concat("joinCondition names ", e->name, ", from which no link leads to ", node.name.value),
          AdviceOnName(
              *e, before,
              before.empty() ? "no link leads here" : Concat("links lead here from ", xml::ListOf(before)),
              reader_));
    }
  }

  const Flow& flow_;
  xml::ElementReader& reader_;
  std::set<std::string> nodes_, with_hold_;  // with_hold_: those with ext:while-holds
  std::map<std::pair<std::string, std::string>, const Link*> seen_;
  LinkGraph all_, back_, forward_;  // forward_: without `while` links
};

}  // namespace

void CheckFlows(const Document& document, xml::ElementReader* reader) {
  LinkGraph contains;
  std::set<std::string> flows;
  for (const Flow& flow : document.flows) flows.insert(flow.name.value);
  for (const Flow& flow : document.flows) {
    FlowChecker(flow, reader).Check();
    for (const Node& node : flow.nodes) {
      for (const Invoke& invoke : node.invokes) {
        if (flows.contains(invoke.subflow.value)) contains[flow.name.value].insert(invoke.subflow.value);
      }
    }
  }
  const LinkGraph cycles = LinksOnCycles(contains);
  std::set<std::string> told;
  for (const Flow& flow : document.flows) {
    if (reader->full(Diagnostic::Severity::kError)) return;
    if (!cycles.contains(flow.name.value) || told.contains(flow.name.value)) continue;
    const std::vector<std::string> way = ShortestWay(cycles, flow.name.value, flow.name.value);
    told.insert(way.begin(), way.end());
    reader->Error(flow.name.span, Concat("flow ", flow.name.value, " contains itself: ", Arrows(way)),
                  "repeat with a while link instead");
  }
}

}  // namespace docent::cawl
