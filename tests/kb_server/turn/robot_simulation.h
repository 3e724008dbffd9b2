// Seeded simulation of a fleet under random workflows: adapters that are slow, deaf, die and come back; reports that are
// late, repeated and out of order; statuses, conditions and restarts at any time; and an operator who pauses, resumes, cancels,
// settles incidents, sets variables and takes robots out of service. Each seed makes the same world, the same documents and the same course.
//
// Fleet is what the robots really do; Documents what they are asked to; robot_simulation_test.cc plays turns and checks them.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_ROBOT_SIMULATION_H_
#define DOCENT_TESTS_KB_SERVER_TURN_ROBOT_SIMULATION_H_

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/kb_server/test_world.h"
#include "workflow/engine/state/ports.h"

namespace docent::server::test {

class Dice {
 public:
  explicit Dice(uint32_t seed) : random_(seed) {}
  int Below(int bound) { return static_cast<int>(random_() % static_cast<uint32_t>(bound)); }
  bool OneIn(int n) { return Below(n) == 0; }

 private:
  std::mt19937 random_;
};

struct SimulatedOperation {
  std::string name;
  engine::Occupation occupies;
  bool idempotent = false;
};
inline const std::vector<SimulatedOperation>& SimulatedOperations() {
  static const auto* all = new std::vector<SimulatedOperation>{{"drive", {"base"}, true},
                                                               {"show", {"screen"}, true},
                                                               {"say", {"voice"}, false},
                                                               {"wave", {"arm", "voice"}, false},
                                                               {"dance", {}, false}};
  return *all;
}
inline const SimulatedOperation& OperationNamed(const std::string& name) {
  for (const SimulatedOperation& operation : SimulatedOperations()) {
    if (operation.name == name) return operation;
  }
  return SimulatedOperations().back();
}

constexpr int kSimulatedRobots = 3;
constexpr int kSimulatedWords = 4;  // conditions are "a person wants N"

// Random small CAWL documents, and one of robot services.
class RandomDocuments {
 public:
  explicit RandomDocuments(Dice* dice) : dice_(*dice) {}

  WriteBatch Services() {
    std::string text = "<rsel name=\"S\" xmlns:ext=\"https://w3id.org/docent/rsel-ext#\">";
    for (int p = 0; p < 2; ++p) {
      absl::StrAppend(&text, "<process name=\"service", p, "\">");
      const int steps = 1 + dice_.Below(3);
      for (int s = 0; s < steps; ++s) {
        absl::StrAppend(&text, "<invoke operation=\"", Operation(), "\"",
                        s > 0 && dice_.OneIn(3) ? " ext:parallel=\"true\"" : "",
                        dice_.OneIn(2) ? absl::StrCat(" ext:timeout=\"", 1 + dice_.Below(6), "s\"") : "",
                        dice_.OneIn(2) ? " ext:retry=\"1\"" : "",
                        dice_.OneIn(6) ? " ext:onFailure=\"continue\"" : "", "/>");
      }
      absl::StrAppend(&text, "</process>");
    }
    return Put(Document::Kind::kRsel, "s.rsel.xml", text + "</rsel>");
  }

  // Workflow W0 … W2; a workflow may invoke those after it as sub-flows.
  WriteBatch Workflow(int number) {
    nodes_ = 1 + dice_.Below(4);
    std::string text = absl::StrCat(
        "<CAWL name=\"W", number, "\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F", number,
        "\"", Urgency(), dice_.OneIn(4) ? " ext:onFailure=\"incident\"" : "",
        "><variable name=\"target\"/><source name=\"s\"/>");
    std::string links;
    for (int n = 0; n < nodes_; ++n) {
      absl::StrAppend(&text, Node(number, n));
      const bool parallel = n == 0 || dice_.OneIn(2);
      absl::StrAppend(&links, "<link from=\"", parallel ? "s" : absl::StrCat("N", n - 1), "\" to=\"N", n,
                      "\"/>");
      absl::StrAppend(&links, "<link from=\"N", n, "\" to=\"t\"/>");
    }
    if (dice_.OneIn(3)) {
      absl::StrAppend(&text, "<node name=\"Repair\"><invoke operation=\"", Operation(), "\"/></node>");
      absl::StrAppend(&links, "<link from=\"N0\" to=\"Repair\" ext:on",
                      dice_.OneIn(2) ? "Interrupt" : "Failure",
                      "=\"true\"/><link from=\"Repair\" to=\"t\"/>");
    }
    return Put(Document::Kind::kCawl, absl::StrCat("w", number, ".cawl.xml"),
               text + "<sink name=\"t\"/>" + links + "</flow></CAWL>");
  }

  // What a node waits for: 0 … kSimulatedWords - 1; -1: nothing.
  static int WordOf(const std::map<std::string, int>& words, const std::string& flow_and_node) {
    const auto word = words.find(flow_and_node);
    return word == words.end() ? -1 : word->second;
  }
  // Flow/node → the word of its condition; → that of its ext:while-holds.
  std::map<std::string, int> words, holds;

 private:
  std::string RetryPolicy() {
    std::string text;
    if (dice_.OneIn(3)) absl::StrAppend(&text, " ext:retry-delay=\"", 1 + dice_.Below(4), "s\"");
    if (!text.empty() && dice_.OneIn(2)) text += " ext:retry-backoff=\"2\"";
    if (dice_.OneIn(3)) text += " ext:retry-other-robot=\"true\"";
    return text;
  }
  // Some runs are more urgent than others, and some of these take robots from them.
  std::string Urgency() {
    if (dice_.OneIn(3)) return "";
    return absl::StrCat(" ext:priority=\"", dice_.Below(4) - 1, "\"",
                        dice_.OneIn(3) ? "" : " ext:preempt=\"true\"");
  }
  std::string Operation() { return SimulatedOperations()[static_cast<size_t>(dice_.Below(5))].name; }
  std::string Node(int number, int n) {
    const std::string place = absl::StrCat("F", number, "/N", n);
    words.erase(place);
    holds.erase(place);
    const bool condition = dice_.OneIn(2);
    const bool each = condition && dice_.OneIn(4);
    std::string text = absl::StrCat("<node name=\"N", n, "\"");
    if (dice_.OneIn(4)) absl::StrAppend(&text, " ext:timeout=\"", 5 + dice_.Below(20), "s\"");
    if (dice_.OneIn(3)) absl::StrAppend(&text, " ext:retry=\"1\"", RetryPolicy());
    if (dice_.OneIn(5)) absl::StrAppend(&text, " ext:onFailure=\"incident\"");
    if (dice_.OneIn(3)) absl::StrAppend(&text, " ext:compensate=\"", Operation(), "\"");
    if (each)
      absl::StrAppend(&text, " ext:forEach=\"?who\"", dice_.OneIn(2) ? " ext:sequential=\"true\"" : "");
    if (dice_.OneIn(4)) {
      const int word = dice_.Below(kSimulatedWords);
      holds[place] = word;
      absl::StrAppend(&text, " ext:while-holds=\"?any &lt;urn:w:wants", word, "&gt; ?thing\"");
    } else if (condition && !each && dice_.OneIn(3)) {
      absl::StrAppend(&text, " ext:while-holds=\"true\"");
    }
    text += ">";
    if (condition) {
      const int word = dice_.Below(kSimulatedWords);
      words[place] = word;
      absl::StrAppend(&text,
                      "<condition><context name=\"c\"><rule><constraint><subject>?who</subject><verb>"
                      "&lt;urn:w:wants",
                      word, "&gt;</verb><object>", dice_.OneIn(3) ? "$target" : "?what",
                      "</object></constraint></rule></context></condition>");
    }
    const int invokes = 1 + dice_.Below(2);
    for (int i = 0; i < invokes; ++i) {
      const int kind = dice_.Below(5);
      absl::StrAppend(&text, "<invoke ");
      if (kind == 0 && number < 2)
        absl::StrAppend(&text, "subflow=\"W", number + 1, "\"");
      else
        absl::StrAppend(&text, "operation=\"",
                        kind == 1 ? absl::StrCat("service", dice_.Below(2)) : Operation(), "\"");
      if (dice_.OneIn(2)) absl::StrAppend(&text, " ext:timeout=\"", 1 + dice_.Below(10), "s\"");
      if (dice_.OneIn(3)) absl::StrAppend(&text, " ext:retry=\"", 1 + dice_.Below(2), "\"", RetryPolicy());
      text += "/>";
    }
    return text + "</node>";
  }

  Dice& dice_;
  int nodes_ = 0;
};

// What the robots really do with their commands, and what becomes known of it.
class Fleet {
 public:
  explicit Fleet(Dice* dice) : dice_(*dice) {}

  static std::string Robot(int number) { return absl::StrCat("R", number); }
  static int NumberOf(const RobotId& robot) { return robot.value().back() - '0'; }

  WriteBatch Joins() {
    WriteBatch batch = Tell({Fact("docent:status", "a", "docent:StateProperty"),
                             Fact("docent:incarnation", "a", "docent:StateProperty")});
    for (int r = 0; r < kSimulatedRobots; ++r) {
      for (const TermQuad& fact : Presence(r)) Add(&batch, fact);
      for (const SimulatedOperation& operation : SimulatedOperations()) {
        const std::string iri = absl::StrCat("urn:docent:operation:", operation.name);
        if (r == 2 && operation.name == "dance") continue;  // that one cannot
        Add(&batch, Fact(Robot(r), "docent:offers", iri));
        Add(&batch, Fact(iri, "docent:idempotent", Term::Boolean(operation.idempotent)));
        for (const std::string& resource : operation.occupies) {
          TermQuad fact = Fact(iri, "docent:occupies", Term::Literal(resource));
          fact.graph = Iri(Robot(r));
          Add(&batch, fact);
        }
      }
    }
    return batch;
  }

  void Send(const RobotCommand& command, TimeMicros now_us) {
    Command& sent = commands_[command.id];
    sent.command = command;
    sent.ends_us = now_us + Seconds(8);
    if (dice_.OneIn(8)) sent.ends_us += 40'000'000;  // hangs
    if (command.expected_incarnation != Incarnation(NumberOf(command.robot)) &&
        !command.expected_incarnation.empty())
      End(&sent, CommandReport::Outcome::kUnknown, now_us);
    else if (dice_.OneIn(12))
      End(&sent, CommandReport::Outcome::kFailed, now_us);  // turned away
  }
  void Cancel(const CommandId& id, TimeMicros now_us) {
    const auto found = commands_.find(id);
    if (found == commands_.end() || found->second.ended || dice_.OneIn(5)) return;  // ended, lost or deaf
    found->second.cancelled = true;
    found->second.ends_us = std::min(found->second.ends_us, now_us + Seconds(5));
  }
  // The adapter forgets: what it did has an unknown outcome, and the robot stands still.
  WriteBatch Die(int robot, TimeMicros now_us) {
    ++lives_[robot];
    for (auto& [id, command] : commands_) {
      if (NumberOf(command.command.robot) == robot && !command.ended)
        End(&command, CommandReport::Outcome::kUnknown, now_us);
    }
    WriteBatch batch;
    for (const TermQuad& fact : Presence(robot)) Add(&batch, fact);
    return batch;
  }

  // Reports that arrive now; some come again, some are no end.
  std::vector<CommandReport> Reports(TimeMicros now_us) {
    std::vector<CommandReport> reports;
    for (auto& [id, command] : commands_) {
      if (!command.ended && command.ends_us <= now_us) {
        const int fate = dice_.Below(10);
        End(&command,
            command.cancelled && fate > 1 ? CommandReport::Outcome::kCancelled
            : fate < 2                    ? CommandReport::Outcome::kFailed
                                          : CommandReport::Outcome::kSucceeded,
            now_us);
      }
      if (!command.ended && dice_.OneIn(6))
        reports.push_back(Of(
            id, dice_.OneIn(2) ? CommandReport::Outcome::kProgress : CommandReport::Outcome::kUnreachable));
      if (command.ended && command.arrives_us <= now_us && (!command.reported || dice_.OneIn(10))) {
        reports.push_back(Of(id, command.outcome));
        command.reported = true;
      }
    }
    std::reverse(reports.begin(), reports.begin() + dice_.Below(static_cast<int>(reports.size()) + 1));
    return reports;
  }
  // Everything ends and becomes known.
  void EndAll(TimeMicros now_us) {
    for (auto& [id, command] : commands_) {
      if (!command.ended) End(&command, CommandReport::Outcome::kCancelled, now_us);
      command.arrives_us = now_us;
    }
  }

 private:
  struct Command {
    RobotCommand command;
    TimeMicros ends_us = 0;
    bool cancelled = false;
    bool ended = false;
    bool reported = false;
    TimeMicros arrives_us = 0;
    CommandReport::Outcome outcome = CommandReport::Outcome::kSucceeded;
  };

  TimeMicros Seconds(int at_most) { return dice_.Below(at_most * 1000) * TimeMicros{1000}; }
  void End(Command* command, CommandReport::Outcome outcome, TimeMicros now_us) {
    command->ended = true;
    command->outcome = outcome;
    command->arrives_us = now_us + (dice_.OneIn(3) ? Seconds(6) : 0);
  }
  std::string Incarnation(int robot) { return absl::StrCat("life", lives_[robot]); }
  std::vector<TermQuad> Presence(int robot) {
    return {Fact(Robot(robot), "a", "docent:Robot"),
            Fact(Robot(robot), "docent:incarnation", Term::Literal(Incarnation(robot))),
            Fact(Robot(robot), "docent:status", "docent:Standby")};
  }
  static void Add(WriteBatch* batch, const TermQuad& fact) {
    batch->operations.push_back({QuadOperation::Kind::kAdd, fact});
  }
  static CommandReport Of(const CommandId& id, CommandReport::Outcome outcome) {
    return {id, outcome, "", 0.5, "i", {}};
  }

  Dice& dice_;
  std::map<CommandId, Command> commands_;
  std::map<int, int> lives_;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_ROBOT_SIMULATION_H_
