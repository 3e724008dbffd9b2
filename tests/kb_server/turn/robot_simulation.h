// The robots of the simulation: adapters that are slow, deaf, die and come back; reports that are late, repeated, out of order,
// and lies. Each seed makes the same course.
//
// Fleet is what the robots really do; random_documents.h what they are asked to; simulated_world.h what else is outside of the
// server; robot_simulation_test.cc plays turns and checks them.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_ROBOT_SIMULATION_H_
#define DOCENT_TESTS_KB_SERVER_TURN_ROBOT_SIMULATION_H_

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "tests/kb_server/test_world.h"
#include "tests/kb_server/turn/simulation_dice.h"
#include "workflow/engine/engine.h"

namespace docent::server::test {

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

// Classes of operations: one that stands alone, and one above another.
inline const std::map<std::string, std::set<std::string>>& SimulatedClasses() {
  static const auto* all = new std::map<std::string, std::set<std::string>>{
      {"urn:w:Moves", {"drive"}}, {"urn:w:Speaks", {"say", "wave"}}, {"urn:w:SpeaksAndWaves", {"wave"}}};
  return *all;
}

inline int SimulatedRobots() {
  static const int robots = NumberFromEnvironment("DOCENT_SIMULATION_ROBOTS", 3);
  return robots;
}

// What the robots really do with their commands, and what becomes known of it.
class Fleet {
 public:
  explicit Fleet(Dice* dice) : dice_(*dice) {}

  static std::string Robot(int number) { return absl::StrCat("R", number); }
  static int NumberOf(const RobotId& robot) { return robot.value().back() - '0'; }

  WriteBatch Joins() {
    WriteBatch batch =
        Tell({Fact("docent:status", "a", "docent:StateProperty"),
              Fact("docent:incarnation", "a", "docent:StateProperty"),
              Fact("SpeaksAndWaves", "http://www.w3.org/2000/01/rdf-schema#subClassOf", "Speaks")});
    for (int r = 0; r < SimulatedRobots(); ++r) {
      for (const TermQuad& fact : Presence(r)) Add(&batch, fact);
      for (const SimulatedOperation& operation : SimulatedOperations()) {
        const std::string iri = absl::StrCat("urn:docent:operation:", operation.name);
        if (r == 2 && operation.name == "dance") continue;  // that one cannot
        Add(&batch, Fact(Robot(r), "docent:offers", iri));
        Add(&batch, Fact(iri, "docent:idempotent", Term::Boolean(operation.idempotent)));
        // The most special class of the operation; R1 does not say of which its say is.
        std::string special;
        for (const auto& [name, operations] : SimulatedClasses()) {
          if (operations.contains(operation.name) && !(r == 1 && operation.name == "say")) special = name;
        }
        if (!special.empty()) {
          TermQuad of_class = Fact(iri, "docent:capability", special);
          of_class.graph = Iri(Robot(r));
          Add(&batch, of_class);
        }
        for (const std::string& resource : operation.occupies) {
          TermQuad fact = Fact(iri, "docent:occupies", Term::Literal(resource));
          fact.graph = Iri(Robot(r));
          Add(&batch, fact);
        }
      }
    }
    return batch;
  }

  // What the server's proxies are told. They carry it to the adapter as soon as that can be reached.
  void Send(const RobotCommand& command, TimeMicros now_us) {
    Command& sent = commands_[command.id];
    sent.command = command;
    sent.reached_us = now_us;
    if (dice_.OneIn(6, "away")) sent.reached_us += Seconds(12);
    // the next one is there already, where the one before was
    if (!IsForNewest(command) && dice_.OneIn(2, "turned away"))
      End(&sent, CommandReport::Outcome::kUnknown, now_us);
  }
  void Cancel(const CommandId& id, TimeMicros now_us) {
    const auto found = commands_.find(id);
    if (found == commands_.end()) return;
    Command& command = found->second;
    command.must_end = command.wanted_end = true;
    if (!command.ended && dice_.OneIn(4, "away"))
      command.reached_us = std::max(command.reached_us, now_us + Seconds(8));
  }
  void Recall(const CommandId& id) {
    if (const auto found = commands_.find(id); found != commands_.end()) found->second.recalled = true;
  }
  // The server begins again, and knows of its commands what it has kept of them.
  void ForgetWishes() {
    for (auto& [id, command] : commands_) command.wanted_end = command.recalled = false;
  }
  void Resume(const engine::CommandUnderWay& open) {
    const auto found = commands_.find(open.command.id);
    ASSERT_NE(found, commands_.end()) << open.command.id.value() << " was never sent";
    found->second.wanted_end = open.ending;
    found->second.recalled = open.recalled;
    found->second.resumed = true;
  }
  // Commands that robots have begun since the last time.
  std::vector<RobotCommand> TakeBegun() { return std::exchange(begun_, {}); }
  // The adapter forgets: what it did has an unknown outcome, and the robot stands still. Another one joins later.
  void Die(int robot, TimeMicros now_us) {
    ++lives_[robot];
    gone_.insert(robot);
    for (auto& [id, command] : commands_) {
      if (NumberOf(command.command.robot) == robot && command.begun && !command.ended)
        End(&command, CommandReport::Outcome::kUnknown, now_us);
    }
  }
  bool IsGone(int robot) const { return gone_.contains(robot); }
  // Commands that were meant for the adapter before it are reported as not begun, except those that the server may have sent before
  // it restarted.
  WriteBatch Join(int robot, TimeMicros now_us) {
    gone_.erase(robot);
    for (auto& [id, command] : commands_) {
      if (NumberOf(command.command.robot) != robot || command.ended || IsForNewest(command.command)) continue;
      End(&command, command.resumed ? CommandReport::Outcome::kUnknown : CommandReport::Outcome::kNotBegun,
          now_us);
    }
    WriteBatch batch;
    for (const TermQuad& fact : Presence(robot)) Add(&batch, fact);
    return batch;
  }

  // Reports that arrive now; some come again, some are no end.
  std::vector<CommandReport> Reports(TimeMicros now_us) {
    std::vector<CommandReport> reports;
    for (auto& [id, command] : commands_) {
      Reach(&command, now_us);
      if (command.begun && !command.ended && command.ends_us <= now_us) {
        const int fate = dice_.OneIn(5, "failure") ? 0 : 9;
        End(&command,
            command.cancelled && fate > 0 ? CommandReport::Outcome::kCancelled
            : fate == 0                   ? CommandReport::Outcome::kFailed
                                          : CommandReport::Outcome::kSucceeded,
            now_us);
      }
      if (!command.ended && dice_.OneIn(6))
        reports.push_back(Of(
            id, dice_.OneIn(2) ? CommandReport::Outcome::kProgress : CommandReport::Outcome::kUnreachable));
      if (command.ended && command.arrives_us <= now_us && (!command.reported || dice_.OneIn(10, "repeat"))) {
        reports.push_back(Of(id, command.outcome));
        Results(&reports.back());
        command.reported = true;
      }
      if (dice_.OneIn(30, "lie")) reports.push_back(Lie(id));
    }
    const int reversed = dice_.Below(static_cast<int>(reports.size()) + 1);
    if (!dice_.OneIn(1, "reorder")) return reports;
    std::reverse(reports.begin(), reports.begin() + reversed);
    return reports;
  }
  // Everything ends and becomes known.
  void EndAll(TimeMicros now_us) {
    for (auto& [id, command] : commands_) {
      Reach(&command, now_us);
      if (!command.ended && command.must_end && command.reached_us <= now_us) {
        EXPECT_TRUE(command.heard_end) << id.value() << " was cancelled, and its robot never heard it";
      }
      if (!command.ended) End(&command, CommandReport::Outcome::kCancelled, now_us);
      command.arrives_us = now_us;
    }
  }

 private:
  struct Command {
    RobotCommand command;
    TimeMicros reached_us = 0;  // its adapter cannot be reached before
    // As the proxies know it, and (`must_end`) as it was decided.
    bool wanted_end = false, recalled = false, must_end = false;
    bool resumed = false;  // by a server that does not know whether it was sent
    bool begun = false, heard_end = false;
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
    command->arrives_us = now_us + (dice_.OneIn(3, "late") ? Seconds(6) : 0);
  }
  // Its adapter can be reached: it begins, hears that it is to end, or never begins.
  void Reach(Command* command, TimeMicros now_us) {
    if (command->ended || command->reached_us > now_us) return;
    const bool gone = IsGone(NumberOf(command->command.robot));
    if (gone && command->resumed) return;
    if (!command->begun && (command->wanted_end || command->recalled))
      return End(command, CommandReport::Outcome::kNotBegun, now_us);
    if (gone) return;
    if (!command->begun) {
      const bool late = command->command.deadline_us != 0 && command->command.deadline_us <= now_us;
      if (late || dice_.OneIn(12, "failure"))  // or turned away
        return End(command, CommandReport::Outcome::kFailed, now_us);
      command->begun = true;
      command->ends_us = now_us + Seconds(8);
      if (dice_.OneIn(8, "hang")) command->ends_us += 40'000'000;  // hangs
      begun_.push_back(command->command);
    }
    if (!command->wanted_end || std::exchange(command->heard_end, true) || dice_.OneIn(5, "deaf")) return;
    command->cancelled = true;
    command->ends_us = std::min(command->ends_us, now_us + Seconds(5));
  }
  std::string Incarnation(int robot) const {
    const auto life = lives_.find(robot);
    return absl::StrCat("life", life == lives_.end() ? 0 : life->second);
  }
  bool IsForNewest(const RobotCommand& command) const {
    return command.expected_incarnation.empty() ||
           command.expected_incarnation == Incarnation(NumberOf(command.robot));
  }
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

  // A result is of the type that it should be, or not.
  void Results(CommandReport* report) {
    const int kind = dice_.Below(4);
    if (kind == 0 || report->outcome != CommandReport::Outcome::kSucceeded) return;
    report->results.emplace_back("level", kind == 1 ? Term::Literal("warm") : Term::Integer(dice_.Below(9)));
    if (kind == 2) report->results.emplace_back("count", Term::Literal("many"));
    if (kind == 3) report->results.emplace_back("target", Iri(dice_.OneIn(2) ? "Thing" : "Nothing"));
  }
  // An end of a command that there never was.
  CommandReport Lie(const CommandId& id) {
    return Of(CommandId(id.value() + "0"), CommandReport::Outcome::kSucceeded);
  }

  Dice& dice_;
  std::map<CommandId, Command> commands_;
  std::map<int, int> lives_;
  std::set<int> gone_;  // robots without an adapter
  std::vector<RobotCommand> begun_;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_ROBOT_SIMULATION_H_
