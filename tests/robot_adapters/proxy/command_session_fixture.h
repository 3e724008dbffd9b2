// Fixture of the tests of one command's session.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_COMMAND_SESSION_FIXTURE_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_COMMAND_SESSION_FIXTURE_H_

#include <memory>
#include <string>

#include "gtest/gtest.h"
#include "robot_adapters/proxy/command_session.h"
#include "tests/robot_adapters/proxy/session_host.h"

namespace docent::proxy {

using Outcome = CommandReport::Outcome;

inline RobotCommand Drive() {
  RobotCommand command;
  command.id = CommandId("c/1");
  command.robot = RobotId("urn:r1");
  command.operation = "drive";
  command.expected_incarnation = "life1";
  return command;
}

inline v1::Feedback Says(v1::Feedback::State state, double progress = 0) {
  v1::Feedback feedback;
  feedback.set_command_id("c/1");
  feedback.set_incarnation("life1");
  feedback.set_state(state);
  feedback.set_progress(progress);
  return feedback;
}

class CommandSessionTest : public testing::Test {
 protected:
  // A session with `left` until its deadline, whose adapter is at a:1.
  CommandSession& Begin(const RobotCommand& command = Drive(), bool may_have_been_sent = false,
                        absl::Duration left = absl::Seconds(60)) {
    session_ = std::make_unique<CommandSession>(&host_, ProxySettings(), command, left, may_have_been_sent);
    session_->UseAdapter("a:1", "life1");
    return *session_;
  }
  uint64_t Serial() const { return host_.calls.size(); }  // of the newest call
  void Say(v1::Feedback::State state, double progress = 0) {
    session_->OnFeedback(Serial(), Says(state, progress));
  }
  void End(grpc::StatusCode code) { session_->OnCallEnded(Serial(), grpc::Status(code, "why")); }

  // The adapter answers the question which incarnation it is; what is reported then.
  Outcome TellLife(const std::string& life) {
    if (host_.probes.empty()) return Outcome::kAccepted;
    session_->OnProbed(host_.probes.back().second, grpc::Status::OK, life);
    return host_.reports.empty() ? Outcome::kAccepted : host_.reports.back().outcome;
  }

  // The adapter hears the Cancel, and says that it does not begin the command; then it is asked once more, and does not know it.
  Outcome RefuseToBegin() {
    session_->OnCancelAnswered(host_.cancel_attempt, true);
    host_.Go(absl::Seconds(2));
    End(grpc::StatusCode::NOT_FOUND);
    return TellLife("life1");
  }

  FakeHost host_;
  std::unique_ptr<CommandSession> session_;
};

}  // namespace docent::proxy

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_COMMAND_SESSION_FIXTURE_H_
