#include "bench/assert_client.h"

#include <cstdio>
#include <utility>

namespace docent::bench {

AssertClient::AssertClient(const std::shared_ptr<grpc::Channel>& channel)
    : stub_(v1::Context::NewStub(channel)) {
  stub_->async()->AssertStream(&context_, this);
  AddHold();  // Send() is called from outside the reactions
  StartRead(&reply_);
  StartCall();
}

void AssertClient::Send(v1::AssertRequest request) {
  absl::MutexLock lock(&mutex_);
  waiting_.push_back(std::move(request));
  if (waiting_.size() == 1) StartWrite(&waiting_.front());
}

void AssertClient::Finish() {
  absl::MutexLock lock(&mutex_);
  closing_ = true;
  if (waiting_.empty()) StartWritesDone();
  RemoveHold();
  mutex_.Await(absl::Condition(&done_));
}

void AssertClient::OnReadDone(bool ok) {
  if (!ok) return;
  if (reply_.has_error()) std::fprintf(stderr, "refused: %s\n", reply_.error().message().c_str());
  StartRead(&reply_);
}

void AssertClient::OnWriteDone(bool ok) {
  absl::MutexLock lock(&mutex_);
  waiting_.pop_front();
  if (!ok) return;
  if (!waiting_.empty()) {
    StartWrite(&waiting_.front());
  } else if (closing_) {
    StartWritesDone();
  }
}

void AssertClient::OnDone(const grpc::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "the stream of updates ended: %s\n", status.error_message().c_str());
  absl::MutexLock lock(&mutex_);
  done_ = true;
}

}  // namespace docent::bench
