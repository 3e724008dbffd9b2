#include "bench/subscribers.h"

#include <cstdio>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/constraint_world.h"
#include "docent/v1/context.grpc.pb.h"

namespace docent::bench {
namespace {

constexpr size_t kConnections = 8;

// The constraint as a client follows it: with free variables by its bindings.
std::string QueryOf(size_t constraint) {
  const StandingConstraint standing = StandingConstraintNumber(constraint);
  std::string text = standing.ask;
  if (!standing.keys.empty()) text.replace(0, 3, absl::StrCat("SELECT ?", standing.keys[0], " WHERE"));
  return absl::StrCat("PREFIX : <", kConstraintNs, "> ", text);
}

}  // namespace

class Subscribers::Stream final : public grpc::ClientReadReactor<v1::SubscribeReply> {
 public:
  Stream(Subscribers* owner, v1::Context::Stub* stub, size_t constraint) : owner_(*owner), constraint_(constraint) {
    v1::SubscribeRequest request;
    request.set_query(QueryOf(constraint));
    request_ = request;
    stub->async()->Subscribe(&context_, &request_, this);
    StartRead(&reply_);
    StartCall();
  }
  void Cancel() { context_.TryCancel(); }

  void OnReadDone(bool ok) override {
    if (!ok) return;
    if (reply_.reset()) {
      owner_.Answered();
    } else if (reply_.is_boolean()) {
      owner_.Notified(constraint_, reply_.boolean());
    } else {
      for (int i = 0; i < reply_.appeared_size(); ++i) owner_.Notified(constraint_, true);
      for (int i = 0; i < reply_.disappeared_size(); ++i) owner_.Notified(constraint_, false);
    }
    StartRead(&reply_);
  }
  void OnDone(const grpc::Status& status) override { owner_.Ended(status); }

 private:
  Subscribers& owner_;
  const size_t constraint_;
  grpc::ClientContext context_;
  v1::SubscribeRequest request_;
  v1::SubscribeReply reply_;
};

Subscribers::Subscribers(const std::string& address, size_t count) : expected_(count) {
  std::vector<std::unique_ptr<v1::Context::Stub>> stubs;
  for (size_t c = 0; c < kConnections; ++c) {
    grpc::ChannelArguments arguments;
    arguments.SetInt("docent.bench.connection", static_cast<int>(c));
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    stubs.push_back(v1::Context::NewStub(
        grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments)));
  }
  for (size_t i = 0; i < count; ++i) streams_.push_back(std::make_unique<Stream>(this, stubs[i % kConnections].get(), i));
  absl::MutexLock lock(&mutex_);
  const auto all = [this, count]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return answered_ >= count || ended_ > 0;
  };
  ready_ = mutex_.AwaitWithTimeout(absl::Condition(&all), absl::Seconds(120)) && ended_ == 0;
}

Subscribers::~Subscribers() {
  {
    absl::MutexLock lock(&mutex_);
    closing_ = true;
  }
  for (const auto& stream : streams_) stream->Cancel();
  absl::MutexLock lock(&mutex_);
  const auto all = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return ended_ == streams_.size(); };
  mutex_.Await(absl::Condition(&all));
}

void Subscribers::Answered() {
  absl::MutexLock lock(&mutex_);
  if (ready_) ++result_.wrong;  // the whole answer anew: changes were lost
  ++answered_;
}

void Subscribers::Ended(const grpc::Status& status) {
  absl::MutexLock lock(&mutex_);
  if (!closing_) std::fprintf(stderr, "a subscription ended: %s\n", status.error_message().c_str());
  ++ended_;
}

void Subscribers::Expect(size_t constraint, bool holds, SteadyClock::time_point due) {
  absl::MutexLock lock(&mutex_);
  expected_[constraint].push_back({holds, due});
  ++outstanding_;
}

void Subscribers::Notified(size_t constraint, bool holds) {
  const SteadyClock::time_point now = SteadyClock::now();
  absl::MutexLock lock(&mutex_);
  std::deque<Expected>& queue = expected_[constraint];
  if (queue.empty() || queue.front().holds != holds) {
    ++result_.wrong;
    return;
  }
  result_.latencies_us.push_back(std::chrono::duration<double, std::micro>(now - queue.front().due).count());
  result_.last = now;
  queue.pop_front();
  --outstanding_;
}

bool Subscribers::WaitForFewerThan(size_t limit, absl::Duration timeout) {
  absl::MutexLock lock(&mutex_);
  const auto few = [this, limit]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return outstanding_ < limit; };
  return mutex_.AwaitWithTimeout(absl::Condition(&few), timeout);
}

Subscribers::Result Subscribers::Take() {
  absl::MutexLock lock(&mutex_);
  Result result = std::exchange(result_, Result());
  result.lost = outstanding_;
  for (auto& queue : expected_) queue.clear();
  outstanding_ = 0;
  return result;
}

}  // namespace docent::bench
