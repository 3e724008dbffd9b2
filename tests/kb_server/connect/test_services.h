// gRPC services of tests, which answer what the test says.
#ifndef DOCENT_TESTS_KB_SERVER_CONNECT_TEST_SERVICES_H_
#define DOCENT_TESTS_KB_SERVER_CONNECT_TEST_SERVICES_H_

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "docent/v1/fleet.grpc.pb.h"
#include "docent/v1/workflows.grpc.pb.h"

namespace docent::server {

// Lists one robot, whose label is what the test says.
class TestFleet final : public v1::Fleet::CallbackService {
 public:
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const v1::ListRobotsRequest*,
                                 v1::ListRobotsReply* reply) override {
    absl::MutexLock lock(&mutex_);
    reply->add_robots()->set_label(label_);
    ++listed_;
    if (on_list_) on_list_(*context);
    deadline_ = absl::FromChrono(context->deadline());
    auto* reactor = context->DefaultReactor();
    if (holds_) {
      held_.push_back(reactor);
    } else {
      reactor->Finish(grpc::Status::OK);
    }
    return reactor;
  }
  grpc::ServerUnaryReactor* Join(grpc::CallbackServerContext* context, const v1::JoinRequest* request,
                                 v1::JoinReply*) override {
    auto* reactor = context->DefaultReactor();
    reactor->Finish({grpc::StatusCode::ALREADY_EXISTS, "there is a \"" + request->address() + "\""});
    return reactor;
  }
  void SetLabel(std::string label) {
    absl::MutexLock lock(&mutex_);
    label_ = std::move(label);
  }
  // Is called with each call of List.
  void OnList(std::function<void(const grpc::CallbackServerContext&)> on_list) {
    absl::MutexLock lock(&mutex_);
    on_list_ = std::move(on_list);
  }
  // Calls of List so far.
  size_t listed() {
    absl::MutexLock lock(&mutex_);
    return listed_;
  }
  // Calls of List are not answered until they are let go.
  void Hold() {
    absl::MutexLock lock(&mutex_);
    holds_ = true;
  }
  void LetGo() {
    absl::MutexLock lock(&mutex_);
    holds_ = false;
    for (auto* reactor : held_) reactor->Finish(grpc::Status::OK);
    held_.clear();
  }
  size_t held() {
    absl::MutexLock lock(&mutex_);
    return held_.size();
  }
  // Of the newest call.
  absl::Time deadline() {
    absl::MutexLock lock(&mutex_);
    return deadline_;
  }

 private:
  absl::Mutex mutex_;
  std::string label_ = "R01";
  absl::Time deadline_;
  bool holds_ = false;
  size_t listed_ = 0;
  std::function<void(const grpc::CallbackServerContext&)> on_list_;
  std::vector<grpc::ServerUnaryReactor*> held_;
};

// Watch sends `count` events, or events without end, and counts what was taken. A run "fail" fails after the first, "hang"
// says nothing until it is cancelled.
class TestWorkflows final : public v1::Workflows::CallbackService {
 public:
  struct Reactor final : grpc::ServerWriteReactor<v1::RunEvent> {
    Reactor(TestWorkflows* of, std::string name) : owner(of), run(std::move(name)) {
      StartSendInitialMetadata();
      if (run != "hang") WriteOne();
    }
    void WriteOne() {
      if (sent == owner->count) return Finish(grpc::Status::OK);
      if (run == "fail" && sent == 1) return Finish({grpc::StatusCode::OUT_OF_RANGE, "too old"});
      event.set_revision(++sent);
      event.set_detail(owner->detail);
      StartWrite(&event);
    }
    void OnWriteDone(bool ok) override {
      owner->written = sent;
      if (ok) return WriteOne();
      Finish(grpc::Status::CANCELLED);
    }
    void OnCancel() override {
      if (run == "hang") Finish(grpc::Status::CANCELLED);
    }
    void OnDone() override {
      owner->ended = true;
      delete this;
    }
    TestWorkflows* const owner;
    const std::string run;
    uint64_t sent = 0;
    v1::RunEvent event;
  };
  grpc::ServerWriteReactor<v1::RunEvent>* Watch(grpc::CallbackServerContext*,
                                                const v1::WatchRequest* request) override {
    return new Reactor(this, request->run());
  }
  uint64_t count = 3;
  std::string detail;
  std::atomic<uint64_t> written{0};
  std::atomic<bool> ended{false};
};

}  // namespace docent::server

#endif  // DOCENT_TESTS_KB_SERVER_CONNECT_TEST_SERVICES_H_
