// Robot adapter: turns a few functions of a robot maker into a robot that the docent server can command.
//
//   #include "robot_adapters/sdk/robot_adapter.h"
//
//   int main() {
//     docent::robot::AdapterOptions options;
//     options.robot = "https://w3id.org/docent/expo#R07";
//     options.label = "R07, a lamp on wheels";
//     options.server = "127.0.0.1:7400";
//     options.journal_path = "/var/lib/r07/commands.journal";
//
//     docent::robot::Operation blink;
//     blink.name = "blink";
//     blink.input_parts = {{"times", "xsd:integer"}};  // or without types: blink.inputs = {"times"}
//     blink.description = "Switches the lamp on and off";
//     blink.run = [](docent::robot::OperationContext& context) -> absl::StatusOr<docent::robot::NamedTerms> {
//       absl::StatusOr<docent::Term> times = context.Argument("times");
//       if (!times.ok()) return times.status();
//       for (int i = 0, n = std::stoi(times->lexical); i < n; ++i) {
//         SwitchLamp(i % 2 == 0);
//         context.ReportProgress(double(i) / n, "blinking");
//         if (!context.SleepFor(std::chrono::seconds(1))) return absl::CancelledError("stopped");
//       }
//       return docent::robot::NamedTerms{};
//     };
//
//     auto adapter = docent::robot::RobotAdapter::Start(options, {blink});
//     if (!adapter.ok()) { std::cerr << adapter.status() << "\n"; return 2; }
//     (*adapter)->SetState("https://w3id.org/docent#battery", docent::Term::Integer(87));
//     WaitForSigterm();
//   }  // the destructor says that the robot leaves, ends running commands, tells the last facts
//
// What the sdk does for it:
//  - serves gRPC RobotAdapter (Describe, Invoke, Attach, Cancel) and keeps the robot's lease with Fleet.Join,
//  for ever,
//    whether the server is there or not, and ends it with Fleet.Leave;
//  - runs each command once: ids are in a journal on disk before their operation begins, a repeated id gets
//  the state of
//    the first, and a command that was running when the process died is reported as of unknown outcome, never
//    repeated;
//  - tells docent:status (Standby, Busy), docent:currentCommand and docent:progress;
//  - delivers facts in order, each until it is acknowledged.
//
// Thread-safe.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_ROBOT_ADAPTER_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_ROBOT_ADAPTER_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graph/base/clock.h"
#include "robot_adapters/sdk/fact_sender.h"
#include "robot_adapters/sdk/operation.h"
#include "robot_adapters/sdk/server_link.h"

namespace docent::robot {

struct AdapterOptions {
  std::string robot;                      // IRI of the robot in the graph; required
  std::string label;                      // for people
  std::string type;                       // IRI of the robot's class; empty: docent:Robot
  std::string server = "127.0.0.1:7400";  // HOST:PORT of the docent server
  std::string listen = "127.0.0.1:0";     // HOST:PORT to serve RobotAdapter at; port 0: any free one
  std::string journal_path;  // one file a robot; empty: commands are forgotten when the process ends
  // Properties of the robot, besides docent:currentCommand and docent:progress, whose values do not outlive
  // the process: what an earlier life left on the server is withdrawn unless this one has told a value when
  // it joins.
  std::vector<std::string> transient_states;
  size_t commands_running = 16;              // 1..: commands at the same time
  size_t facts_queued = 1024;                // 1..: batches of facts that wait for the server
  absl::Duration linger = absl::Seconds(2);  // how long the destructor tries to deliver the last facts
  const Clock* clock = nullptr;              // nullptr: steady time since the start
};

class RobotAdapter {
 public:
  // Serves at once; joins the fleet as soon as the server is there.
  // INVALID_ARGUMENT: no robot IRI or bad operations; UNAVAILABLE: the address to listen at is taken;
  // DATA_LOSS and others: the journal cannot be read or written.
  static absl::StatusOr<std::unique_ptr<RobotAdapter>> Start(AdapterOptions options,
                                                             std::vector<Operation> operations);

  ~RobotAdapter();  // Shutdown, if that was not done
  RobotAdapter(const RobotAdapter&) = delete;
  RobotAdapter& operator=(const RobotAdapter&) = delete;

  // Tells the server that the robot leaves (for at most a second), so that it is offline at once and gets no further command. Then
  // ends running commands as failed, waits for their functions, and delivers the last facts for at most `linger`: not the
  // robot's states, which go with it. What is told afterwards is not delivered. Not from an operation.
  void Shutdown();

  // The robot's property has this value now, until told otherwise. Sent only when it changed.
  void SetState(const std::string& predicate, Term value);
  void ClearState(const std::string& predicate);
  // The same for other subjects, other facts, sensor readings, and to wait for delivery.
  FactSender& facts();
  // Asks the server.
  ServerLink& server();

  const std::string& address() const;      // HOST:PORT where it serves, with the port taken
  const std::string& incarnation() const;  // differs from that of every other run of this program
  bool joined() const;                     // the last Fleet.Join succeeded

 private:
  class Impl;
  explicit RobotAdapter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_ROBOT_ADAPTER_H_
