// Random small workflows and robot services of the simulation, with all that the languages offer. Each part of a document is
// a feature that can be left out (simulation_dice.h).
#ifndef DOCENT_TESTS_KB_SERVER_TURN_RANDOM_DOCUMENTS_H_
#define DOCENT_TESTS_KB_SERVER_TURN_RANDOM_DOCUMENTS_H_

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "tests/kb_server/test_world.h"
#include "tests/kb_server/turn/robot_simulation.h"

namespace docent::server::test {

constexpr int kSimulatedWords = 4;  // conditions are "a person wants N"
constexpr int kSimulatedWorkflows = 3;

// What starts runs of a workflow by itself.
struct SimulatedActivator {
  enum class By { kNothing, kEvent, kTime, kFact } by = By::kNothing;
  bool queues = false;  // firings may wait
};

class RandomDocuments {
 public:
  explicit RandomDocuments(Dice* dice) : dice_(*dice) {}

  WriteBatch Services() {
    std::string text =
        "<rsel name=\"S\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema#\" "
        "xmlns:ext=\"https://w3id.org/docent/rsel-ext#\">"
        "<message name=\"Ask\"><part name=\"target\"/><part name=\"count\" type=\"xsd:integer\"/></message>"
        "<message name=\"Answer\"><part name=\"count\" type=\"xsd:integer\"/></message>";
    for (int p = 0; p < 2; ++p) {
      const bool typed = dice_.OneIn(2, "types");
      absl::StrAppend(&text, "<process name=\"service", p, "\"",
                      typed ? " input=\"Ask\" output=\"Answer\"" : "", ">");
      const int steps = 1 + dice_.Below(3);
      for (int s = 0; s < steps; ++s) {
        absl::StrAppend(
            &text, "<invoke operation=\"", Operation(), "\"",
            s > 0 && dice_.OneIn(3, "parallel") ? " ext:parallel=\"true\"" : "",
            dice_.OneIn(2, "timeout") ? absl::StrCat(" ext:timeout=\"", 1 + dice_.Below(6), "s\"") : "",
            dice_.OneIn(2, "retry") ? " ext:retry=\"1\"" : "",
            dice_.OneIn(6, "failure") ? " ext:onFailure=\"continue\"" : "", ">");
        if (typed) text += "<input part=\"place\" from=\"target\"/>";
        if (typed && s + 1 == steps) text += "<output part=\"level\" to=\"count\"/>";
        text += "</invoke>";
      }
      text += "</process>";
    }
    return Put(Document::Kind::kRsel, "s.rsel.xml", text + "</rsel>");
  }

  // Workflow W0 … W2; a workflow may invoke those after it as sub-flows.
  WriteBatch Workflow(int number) {
    nodes_ = 1 + dice_.Below(4);
    const std::string flow = absl::StrCat("F", number);
    priorities[flow] = 0;
    std::string text = absl::StrCat(
        "<CAWL name=\"W", number, "\" xmlns:w=\"urn:w:\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema#\" ",
        "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">", Activator(number), "<flow name=\"F", number, "\"",
        Urgency(flow), dice_.OneIn(4, "incident") ? " ext:onFailure=\"incident\"" : "",
        "><variable name=\"target\"/><variable name=\"count\" type=\"xsd:integer\"><initialize>"
        "<from expression=\"0\"/></initialize></variable><source name=\"s\"/>");
    std::string links;
    for (int n = 0; n < nodes_; ++n) {
      absl::StrAppend(&text, Node(number, n));
      const bool parallel = n == 0 || dice_.OneIn(2, "parallel");
      absl::StrAppend(&links, "<link from=\"", parallel ? "s" : absl::StrCat("N", n - 1), "\" to=\"N", n,
                      "\"/>");
      absl::StrAppend(&links, "<link from=\"N", n, "\" to=\"t\"/>");
    }
    if (dice_.OneIn(3, "repair")) {
      absl::StrAppend(&text, "<node name=\"Repair\"><invoke operation=\"", Operation(), "\"/></node>");
      absl::StrAppend(&links, "<link from=\"N0\" to=\"Repair\" ext:on",
                      dice_.OneIn(2) ? "Interrupt" : "Failure",
                      "=\"true\"/><link from=\"Repair\" to=\"t\"/>");
    }
    absl::StrAppend(&text, "<sink name=\"t\"/>", links,
                    dice_.OneIn(3, "output") ? "<ext:output variable=\"count\"/>" : "", "</flow></CAWL>");
    texts_[number] = text;
    return Again(number);
  }
  // The same text as before.
  WriteBatch Again(int number) const {
    return Put(Document::Kind::kCawl, absl::StrCat("w", number, ".cawl.xml"), texts_.at(number));
  }

  // What a node waits for: 0 … kSimulatedWords - 1; -1: nothing.
  static int WordOf(const std::map<std::string, int>& words, const std::string& flow_and_node) {
    const auto word = words.find(flow_and_node);
    return word == words.end() ? -1 : word->second;
  }
  // How often it occurs, which is another time for each workflow.
  static std::string Interval(int number) { return absl::StrCat(9 + 2 * number, "s"); }
  // Flow/node → the word of its condition; → that of its ext:while-holds.
  std::map<std::string, int> words, holds;
  std::set<std::string> holding_conditions;      // of holds: those that are the condition of the node
  std::map<int, SimulatedActivator> activators;  // by workflow
  // Flow/node → of each invoke the class that it asks for, or "".
  std::map<std::string, std::vector<std::string>> classes;
  // Those with ext:compensate that one command does.
  std::set<std::string> compensated;
  std::map<std::string, int> priorities;  // by flow: the highest that a run of it may have

 private:
  using By = SimulatedActivator::By;

  std::string RetryPolicy() {
    std::string text;
    if (dice_.OneIn(3, "delay")) absl::StrAppend(&text, " ext:retry-delay=\"", 1 + dice_.Below(4), "s\"");
    if (!text.empty() && dice_.OneIn(2)) text += " ext:retry-backoff=\"2\"";
    if (dice_.OneIn(3, "other-robot")) text += " ext:retry-other-robot=\"true\"";
    return text;
  }
  // Some runs are more urgent than others, and some of these take robots from them.
  std::string Urgency(const std::string& flow) {
    const bool urgent = dice_.OneIn(1, "priority");
    const int kind = dice_.Below(3), priority = dice_.Below(4) - 1;
    if (!urgent || kind == 0) return "";
    priorities[flow] = std::max(priorities[flow], priority);
    return absl::StrCat(" ext:priority=\"", priority, "\"", dice_.OneIn(3) ? "" : " ext:preempt=\"true\"");
  }
  // Some nodes reserve robots for their run, and some give them back.
  std::string Reservation() {
    if (dice_.OneIn(12, "reserve")) return "<ext:release/>";
    if (!dice_.OneIn(6, "reserve")) return "";
    std::string text = "<ext:reserve robots=\"";
    for (int r = 0; r < SimulatedRobots(); ++r) {
      if (r == 0 || dice_.OneIn(2))
        absl::StrAppend(&text, " &lt;urn:w:R", (r + dice_.Below(2)) % SimulatedRobots(), ">");
    }
    absl::StrAppend(&text, "\" lasting=\"", 1 + dice_.Below(15), "s\"");
    if (dice_.OneIn(2)) absl::StrAppend(&text, " priority=\"", dice_.Below(5) - 1, "\"");
    return text + (dice_.OneIn(3) ? " at=\"done\"/>" : "/>");
  }
  // An operation by its name, or any of a class.
  std::string Wanted(const std::string& place) {
    std::string wanted;
    if (dice_.OneIn(4, "class")) {
      auto one = SimulatedClasses().begin();
      std::advance(one, dice_.Below(static_cast<int>(SimulatedClasses().size())));
      wanted = one->first;
    }
    classes[place].push_back(wanted);
    return wanted.empty() ? absl::StrCat("operation=\"", Operation(), "\"")
                          : absl::StrCat("ext:capability=\"&lt;", wanted, ">\"");
  }
  std::string Operation() { return SimulatedOperations()[static_cast<size_t>(dice_.Below(5))].name; }

  static std::string Wants(const std::string& who, int word, const std::string& what) {
    return absl::StrCat("<context name=\"c\"><rule><constraint><subject>", who, "</subject><verb>w:wants",
                        word, "</verb><object>", what, "</object></constraint></rule></context>");
  }
  std::string Activator(int number) {
    activators[number] = {};
    const int kind = dice_.Below(5);
    if (!dice_.OneIn(1, "activator") || kind > 2) return "";
    SimulatedActivator& activator = activators[number];
    static constexpr const char* kModes[] = {"", "single", "queued", "restart", "parallel"};
    const std::string mode = kModes[dice_.Below(5)];
    activator.queues = mode == "queued";
    std::string text = absl::StrCat("<activator name=\"A\"", Urgency(absl::StrCat("F", number)));
    if (!mode.empty() && dice_.OneIn(1, "mode")) {
      absl::StrAppend(&text, " ext:mode=\"", mode, "\"");
      if (mode == "queued" || mode == "parallel")
        absl::StrAppend(&text, " ext:max=\"", 1 + dice_.Below(3), "\"");
    }
    absl::StrAppend(&text, "><activate flow=\"F", number, "\"/>");
    if (kind == 0) {
      activator.by = By::kEvent;
      absl::StrAppend(&text, "<condition><case><event operation=\"ring", number, "\"/></case></condition>");
    } else if (kind == 1) {
      activator.by = By::kTime;
      absl::StrAppend(&text, "<condition><context><ext:time every=\"", Interval(number),
                      "\"/></context></condition>");
    } else {
      activator.by = By::kFact;
      absl::StrAppend(&text, "<condition>", Wants("?who", dice_.Below(kSimulatedWords), "?target"),
                      "</condition>");
    }
    return text + "</activator>";
  }

  // Facts, variables and notifications of a node.
  std::string Actions() {
    std::string text;
    const auto at = [this] { return dice_.OneIn(2) ? " at=\"done\"" : ""; };
    const auto person = [this] { return absl::StrCat("w:P", dice_.Below(3)); };
    if (dice_.OneIn(5, "tell")) {
      static constexpr const char* kLifetimes[] = {"", " lifetime=\"run\"", " lifetime=\"4s\""};
      absl::StrAppend(&text, "<ext:tell", at(), kLifetimes[dice_.Below(3)], ">", person(), " w:wants",
                      dice_.Below(kSimulatedWords), " w:Thing</ext:tell>");
    }
    if (dice_.OneIn(5, "mark"))
      absl::StrAppend(&text, "<ext:tell", at(), " lifetime=\"run\">", person(), " w:mark ",
                      dice_.OneIn(3) ? "$target" : "$count", "</ext:tell>");
    if (dice_.OneIn(6, "withdraw"))
      absl::StrAppend(&text, "<ext:withdraw", at(), dice_.OneIn(2) ? " source=\"any\"" : "", ">", person(),
                      " w:wants", dice_.Below(kSimulatedWords), " ?any</ext:withdraw>");
    if (dice_.OneIn(5, "assign")) {
      const int kind = dice_.Below(3);
      if (kind == 0)
        absl::StrAppend(&text, "<ext:assign", at(), " variable=\"count\" expression=\"$count + 1\"/>");
      if (kind == 1)
        absl::StrAppend(&text, "<ext:assign", at(), dice_.OneIn(2) ? " none=\"unset\"" : "",
                        ">SELECT ?target WHERE { ?any w:wants", dice_.Below(kSimulatedWords),
                        " ?target }</ext:assign>");
      if (kind == 2)
        absl::StrAppend(&text, "<ext:assign", at(),
                        " variable=\"count\" default=\"0\">SELECT (COUNT(?any) AS ?n) WHERE { ?any w:mark "
                        "$target }</ext:assign>");
    }
    if (dice_.OneIn(6, "notify"))
      absl::StrAppend(&text, "<ext:notify to=\"http://h/x\" variables=\"target count\"",
                      dice_.OneIn(2) ? " wait=\"true\"" : "", at(), "/>");
    return text;
  }

  std::string Condition(int number, const std::string& place) {
    const int word = dice_.Below(kSimulatedWords);
    words[place] = word;
    const std::string wants = Wants("?who", word, dice_.OneIn(3) ? "$target" : "?what");
    if (dice_.OneIn(6, "event"))
      return absl::StrCat("<condition expression=\"rang and c\"><case name=\"rang\"><event operation=\"ring",
                          number, "\"/></case>", wants, "</condition>");
    if (dice_.OneIn(6, "after"))
      return absl::StrCat("<condition expression=\"late and c\"><context name=\"late\"><ext:time after=\"",
                          1 + dice_.Below(5), "s\"/></context>", wants, "</condition>");
    if (dice_.OneIn(6, "between"))
      return absl::StrCat(
          "<condition expression=\"now and c\"><context name=\"now\"><ext:time between=\"22:14-22:15\"/>"
          "</context>",
          wants, "</condition>");
    return absl::StrCat("<condition>", wants, "</condition>");
  }

  std::string Node(int number, int n) {
    const std::string place = absl::StrCat("F", number, "/N", n);
    words.erase(place);
    holds.erase(place);
    holding_conditions.erase(place);
    classes.erase(place);
    compensated.erase(place);
    const bool condition = dice_.OneIn(2, "condition");
    const bool each = condition && dice_.OneIn(4, "each");
    std::string text = absl::StrCat("<node name=\"N", n, "\"");
    if (dice_.OneIn(4, "timeout")) absl::StrAppend(&text, " ext:timeout=\"", 5 + dice_.Below(20), "s\"");
    if (dice_.OneIn(3, "retry")) absl::StrAppend(&text, " ext:retry=\"1\"", RetryPolicy());
    if (dice_.OneIn(5, "incident")) absl::StrAppend(&text, " ext:onFailure=\"incident\"");
    const bool compensates = dice_.OneIn(2, "compensate");
    if (compensates) absl::StrAppend(&text, " ext:compensate=\"", Operation(), "\"");
    if (each)
      absl::StrAppend(&text, " ext:forEach=\"?who\"", dice_.OneIn(2) ? " ext:sequential=\"true\"" : "");
    if (dice_.OneIn(4, "holds")) {
      const int word = dice_.Below(kSimulatedWords);
      holds[place] = word;
      absl::StrAppend(&text, " ext:while-holds=\"?any &lt;urn:w:wants", word, "&gt; ?thing\"");
    } else if (condition && !each && dice_.OneIn(3, "holds")) {
      absl::StrAppend(&text, " ext:while-holds=\"true\"");
    }
    text += ">";
    if (condition) absl::StrAppend(&text, Condition(number, place));
    if (text.find("while-holds=\"true\"") != std::string::npos) {
      holds[place] = words.at(place);
      holding_conditions.insert(place);
    }
    const int invokes = 1 + dice_.Below(2);
    for (int i = 0; i < invokes; ++i) {
      absl::StrAppend(&text, Invoke(number, place));
      classes[place].resize(static_cast<size_t>(i) + 1);
    }
    const bool one_command = invokes == 1 && !absl::StrContains(text, "subflow=") &&
                             !absl::StrContains(text, "operation=\"service");
    if (compensates && one_command) compensated.insert(place);
    return absl::StrCat(text, Actions(), Reservation(), "</node>");
  }

  std::string Invoke(int number, const std::string& place) {
    const int kind = dice_.Below(5);
    std::string text = "<invoke ";
    if (kind == 0 && number + 1 < kSimulatedWorkflows && dice_.OneIn(1, "subflow"))
      absl::StrAppend(&text, "subflow=\"W", number + 1, "\"");
    else if (kind == 1 && dice_.OneIn(1, "service"))
      absl::StrAppend(&text, "operation=\"service", dice_.Below(2), "\"");
    else
      absl::StrAppend(&text, Wanted(place));
    if (dice_.OneIn(2, "timeout")) absl::StrAppend(&text, " ext:timeout=\"", 1 + dice_.Below(10), "s\"");
    if (dice_.OneIn(3, "retry"))
      absl::StrAppend(&text, " ext:retry=\"", 1 + dice_.Below(2), "\"", RetryPolicy());
    return absl::StrCat(text, ">",
                        dice_.OneIn(4, "output") ? "<ext:output part=\"level\" variable=\"count\"/>" : "",
                        "</invoke>");
  }

  Dice& dice_;
  int nodes_ = 0;
  std::map<int, std::string> texts_;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_RANDOM_DOCUMENTS_H_
