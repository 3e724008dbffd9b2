#include "bench/subscribers.h"

#include <cstdio>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/worlds/constraint_world.h"
#include "docent/v1/context.grpc.pb.h"

namespace docent::bench {
namespace {

constexpr size_t kConnections = 8;

// The constraint as a client's query: with free variables it asks for their bindings.
std::string QueryOf(size_t constraint) {
  const StandingConstraint standing = StandingConstraintNumber(constraint);
  std::string text = standing.ask;
  if (!standing.keys.empty()) text.replace(0, 3, absl::StrCat("SELECT ?", standing.keys[0], " WHERE"));
  return absl::StrCat("PREFIX : <", kConstraintNs, "> ", text);
}

}  // namespace

class Subscribers::Stream {
 public:
  virtual ~Stream() = default;
  void Cancel() { context_.TryCancel(); }

 protected:
  explicit Stream(Subscribers* owner) : owner_(*owner) {}
  Subscribers& owner_;
  grpc::ClientContext context_;
};

class Subscribers::OneConstraint final : public Stream, public grpc::ClientReadReactor<v1::SubscribeReply> {
 public:
  OneConstraint(Subscribers* owner, v1::Context::Stub* stub, size_t constraint)
      : Stream(owner), constraint_(constraint) {
    request_.set_query(QueryOf(constraint));
    stub->async()->Subscribe(&context_, &request_, this);
    StartRead(&reply_);
    StartCall();
  }
  void OnReadDone(bool ok) override {
    if (!ok) return;
    {
      absl::MutexLock lock(&owner_.mutex_);
      owner_.Replied(constraint_, reply_);
    }
    StartRead(&reply_);
  }
  void OnDone(const grpc::Status& status) override { owner_.Ended(status); }

 private:
  const size_t constraint_;
  v1::SubscribeRequest request_;
  v1::SubscribeReply reply_;
};

// The constraints first, first + step, … below `count`; their numbers are the tags.
class Subscribers::ManyConstraints final
    : public Stream,
      public grpc::ClientBidiReactor<v1::SubscribeStreamRequest, v1::SubscribeStreamReply> {
 public:
  ManyConstraints(Subscribers* owner, v1::Context::Stub* stub, size_t first, size_t step, size_t count)
      : Stream(owner), next_(first), step_(step), count_(count) {
    stub->async()->SubscribeStream(&context_, this);
    StartRead(&reply_);
    WriteNext();
    StartCall();
  }
  void OnWriteDone(bool ok) override {
    if (ok) WriteNext();
  }
  void OnReadDone(bool ok) override {
    if (!ok) return;
    {
      absl::MutexLock lock(&owner_.mutex_);
      for (const v1::SubscribeStreamReply::Part& part : reply_.parts()) {
        if (part.has_reply()) {
          owner_.Replied(part.tag(), part.reply());
        } else {
          std::fprintf(stderr, "a subscription ended: %s\n", part.ended().message().c_str());
        }
      }
    }
    StartRead(&reply_);
  }
  void OnDone(const grpc::Status& status) override { owner_.Ended(status); }

 private:
  void WriteNext() {
    if (next_ >= count_) return StartWritesDone();
    request_.set_tag(next_);
    request_.mutable_begin()->set_query(QueryOf(next_));
    next_ += step_;
    StartWrite(&request_);
  }

  size_t next_;
  const size_t step_;
  const size_t count_;
  v1::SubscribeStreamRequest request_;
  v1::SubscribeStreamReply reply_;
};

Subscribers::Subscribers(const std::string& address, size_t count, Streams streams) : expected_(count) {
  std::vector<std::unique_ptr<v1::Context::Stub>> stubs;
  for (size_t c = 0; c < kConnections; ++c) {
    grpc::ChannelArguments arguments;
    arguments.SetInt("docent.bench.connection", static_cast<int>(c));
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    stubs.push_back(v1::Context::NewStub(
        grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments)));
  }
  if (streams == Streams::kOneAConnection) {
    for (size_t c = 0; c < kConnections; ++c)
      streams_.push_back(std::make_unique<ManyConstraints>(this, stubs[c].get(), c, kConnections, count));
  } else {
    for (size_t i = 0; i < count; ++i)
      streams_.push_back(std::make_unique<OneConstraint>(this, stubs[i % kConnections].get(), i));
  }
  absl::MutexLock lock(&mutex_);
  const auto all = [this, count]()
                       ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return answered_ >= count || ended_ > 0; };
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

void Subscribers::Replied(size_t constraint, const v1::SubscribeReply& reply) {
  const SteadyClock::time_point now = SteadyClock::now();
  if (reply.reset()) {
    if (ready_) ++result_.wrong;  // a new whole answer: changes were lost
    ++answered_;
  } else if (reply.is_boolean()) {
    Notified(constraint, reply.boolean(), now);
  } else {
    for (int i = 0; i < reply.appeared_size(); ++i) Notified(constraint, true, now);
    for (int i = 0; i < reply.disappeared_size(); ++i) Notified(constraint, false, now);
  }
}

void Subscribers::Ended(const grpc::Status& status) {
  absl::MutexLock lock(&mutex_);
  if (!closing_) std::fprintf(stderr, "a subscription ended: %s\n", status.error_message().c_str());
  ++ended_;
}

void Subscribers::Expect(const std::vector<Flip>& flips, SteadyClock::time_point due) {
  absl::MutexLock lock(&mutex_);
  for (const Flip& flip : flips) expected_[flip.constraint].push_back({flip.holds, due});
  outstanding_ += flips.size();
}

void Subscribers::Notified(size_t constraint, bool holds, SteadyClock::time_point now) {
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
