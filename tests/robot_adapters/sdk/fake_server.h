// A docent server for tests of adapters: accepts facts and joins, and answers queries as the test defines.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_SDK_FAKE_SERVER_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_SDK_FAKE_SERVER_H_

#include <grpcpp/grpcpp.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/fleet.grpc.pb.h"

namespace docent::robot {

class FakeServer final : public v1::Context::Service, public v1::Fleet::Service {
 public:
  FakeServer() { Start(0); }
  ~FakeServer() override { Stop(); }

  // On the same port as before, unless `port` is another.
  void Start(int port) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort(absl::StrCat("127.0.0.1:", port), grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(static_cast<v1::Context::Service*>(this));
    builder.RegisterService(static_cast<v1::Fleet::Service*>(this));
    server_ = builder.BuildAndStart();
  }
  void Stop() {
    if (server_ != nullptr) server_->Shutdown(std::chrono::system_clock::now());
    server_.reset();
  }
  int port() const { return port_; }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }

  grpc::Status Assert(grpc::ServerContext*, const v1::AssertRequest* request,
                      v1::AssertReply* reply) override {
    absl::MutexLock lock(&mutex_);
    for (size_t i = 0; i < batches_.size(); ++i) {
      if (batches_[i].request_id() != request->request_id()) continue;
      reply->set_offset(i + 1);
      reply->set_repeated(true);
      return grpc::Status::OK;
    }
    batches_.push_back(*request);
    for (const v1::Quad& quad : request->remove())
      values_.erase({quad.subject().iri(), quad.predicate().iri()});
    for (const v1::Quad& quad : request->add()) {
      values_[{quad.subject().iri(), quad.predicate().iri()}] =
          quad.object().has_iri() ? quad.object().iri() : quad.object().literal().lexical();
    }
    reply->set_offset(batches_.size());
    return grpc::Status::OK;
  }
  grpc::Status Query(grpc::ServerContext*, const v1::QueryRequest* request,
                     grpc::ServerWriter<v1::QueryReply>* writer) override {
    absl::MutexLock lock(&mutex_);
    queries_.push_back(request->query());
    for (const auto& [words, replies] : answers_) {
      if (request->query().find(words) == std::string::npos) continue;
      for (const v1::QueryReply& reply : replies) writer->Write(reply);
      return grpc::Status::OK;
    }
    writer->Write(Header({}));
    return grpc::Status::OK;
  }
  grpc::Status Join(grpc::ServerContext*, const v1::JoinRequest* request, v1::JoinReply* reply) override {
    absl::MutexLock lock(&mutex_);
    joins_.push_back(*request);
    reply->set_lease_ms(lease_ms_);
    return grpc::Status::OK;
  }

  grpc::Status Leave(grpc::ServerContext*, const v1::LeaveRequest* request, v1::LeaveReply*) override {
    absl::MutexLock lock(&mutex_);
    leaves_.push_back({*request, batches_.size()});
    const auto may_answer = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return answers_leaves_; };
    mutex_.AwaitWithTimeout(absl::Condition(&may_answer), absl::Seconds(30));
    return grpc::Status::OK;
  }

  // Waits until `subject predicate` has this value (IRI or lexical form); false after half a minute.
  bool AwaitValue(const std::string& subject, const std::string& predicate, const std::string& value) {
    absl::MutexLock lock(&mutex_);
    auto holds = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      auto found = values_.find({subject, predicate});
      return found == values_.end() ? value.empty() : found->second == value;
    };
    return mutex_.AwaitWithTimeout(absl::Condition(&holds), absl::Seconds(30));
  }
  bool AwaitJoins(size_t n) {
    absl::MutexLock lock(&mutex_);
    auto enough = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return joins_.size() >= n; };
    return mutex_.AwaitWithTimeout(absl::Condition(&enough), absl::Seconds(30));
  }
  std::string Value(const std::string& subject, const std::string& predicate) {
    absl::MutexLock lock(&mutex_);
    auto found = values_.find({subject, predicate});
    return found == values_.end() ? "" : found->second;
  }
  std::vector<v1::AssertRequest> batches() {
    absl::MutexLock lock(&mutex_);
    return batches_;
  }
  std::vector<v1::JoinRequest> joins() {
    absl::MutexLock lock(&mutex_);
    return joins_;
  }
  struct Left {
    v1::LeaveRequest request;
    size_t batches = 0;  // that had come before
  };
  std::vector<Left> leaves() {
    absl::MutexLock lock(&mutex_);
    return leaves_;
  }
  void AnswerLeaves(bool answer) {
    absl::MutexLock lock(&mutex_);
    answers_leaves_ = answer;
  }
  std::vector<std::string> queries() {
    absl::MutexLock lock(&mutex_);
    return queries_;
  }
  // Queries that contain `words` get one row of these IRIs and strings; an empty value is unbound. Newest
  // first.
  void AnswerRow(const std::string& words, const std::vector<std::string>& values) {
    v1::QueryReply row;
    std::vector<std::string> variables;
    for (const std::string& value : values) {
      variables.push_back(absl::StrCat("v", variables.size()));
      v1::Term* term = row.mutable_row()->add_values();
      if (value.find("://") != std::string::npos) {
        term->set_iri(value);
      } else if (!value.empty()) {
        term->mutable_literal()->set_lexical(value);
      }
    }
    absl::MutexLock lock(&mutex_);
    answers_.insert(answers_.begin(), {words, {Header(variables), row}});
  }
  static v1::QueryReply Header(const std::vector<std::string>& variables) {
    v1::QueryReply reply;
    for (const std::string& variable : variables) reply.mutable_header()->add_variables(variable);
    reply.mutable_header()->set_revision(9);
    return reply;
  }
  void SetLease(uint32_t lease_ms) {
    absl::MutexLock lock(&mutex_);
    lease_ms_ = lease_ms;
  }

 private:
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
  absl::Mutex mutex_;
  uint32_t lease_ms_ = 3000;
  std::vector<v1::AssertRequest> batches_;
  std::vector<v1::JoinRequest> joins_;
  std::vector<Left> leaves_;
  bool answers_leaves_ = true;
  std::vector<std::string> queries_;
  std::vector<std::pair<std::string, std::vector<v1::QueryReply>>> answers_;
  std::map<std::pair<std::string, std::string>, std::string> values_;
};

}  // namespace docent::robot

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_SDK_FAKE_SERVER_H_
