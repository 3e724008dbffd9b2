// Workflows.Watch: events of runs, read from the feed at the client's pace.
#include <utility>

#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"

namespace docent {
namespace {

void ToProto(const RunEvent& event, v1::RunEvent* out) {
  out->set_revision(event.revision.value());
  out->set_time_us(event.time_us);
  out->set_run(event.run);
  out->set_node(event.node);
  out->set_kind(event.kind);
  out->set_from(event.from);
  out->set_to(event.to);
  out->set_detail(event.detail);
}

// One client. It holds a place in the feed and no events of its own, so a slow one costs nothing; one that
// falls behind what the feed keeps is told so.
class WatchReactor final : public grpc::ServerWriteReactor<v1::RunEvent> {
 public:
  WatchReactor(RunFeed* feed, const v1::WatchRequest& request)
      : feed_(*feed), run_(request.run()), after_(request.after()) {
    subscription_ = feed_.Subscribe([this](const RunEvent&) {
      absl::MutexLock lock(&mutex_);
      Advance();
      return true;
    });
    absl::StatusOr<uint64_t> first = request.after() == 0 ? feed_.Next() : feed_.FirstAfter(after_);
    absl::MutexLock lock(&mutex_);
    if (!first.ok()) {
      End(ToGrpc(first.status()));
      return;
    }
    next_ = *first;
    StartSendInitialMetadata();  // a client that has it misses nothing from then on
    Advance();
  }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&mutex_);
    writing_ = false;
    if (ended_) return Finish(status_);
    if (!ok) return End(Gone());
    Advance();
  }
  void OnCancel() override {
    absl::MutexLock lock(&mutex_);
    End(Gone());
  }
  void OnDone() override {
    feed_.Unsubscribe(subscription_);  // waits for the committer thread if that is in Advance
    delete this;
  }

 private:
  static grpc::Status Gone() { return {grpc::StatusCode::CANCELLED, "the client went away"}; }

  // Writes the next event that the client wants, if it is there and no other is being written.
  void Advance() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (next_ == 0 || writing_ || ended_) return;
    while (true) {
      absl::StatusOr<RunEventPtr> event = feed_.Get(next_);
      if (!event.ok()) return End(ToGrpc(event.status()));
      if (*event == nullptr) return;
      ++next_;
      if ((*event)->revision <= after_ || (!run_.empty() && (*event)->run != run_)) continue;
      message_.Clear();
      ToProto(**event, &message_);
      writing_ = true;
      StartWrite(&message_);
      return;
    }
  }

  // Finishes now, or when the message that is being written is done.
  void End(grpc::Status status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (ended_) return;
    ended_ = true;
    status_ = std::move(status);
    if (!writing_) Finish(status_);
  }

  RunFeed& feed_;
  const std::string run_;  // empty: all
  const Revision after_;
  uint64_t subscription_ = 0;
  absl::Mutex mutex_;
  uint64_t next_ ABSL_GUARDED_BY(mutex_) = 0;  // number of the next event; 0: not known yet
  v1::RunEvent message_;                       // being written
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  grpc::Status status_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace

grpc::ServerWriteReactor<v1::RunEvent>* WorkflowsService::Watch(grpc::CallbackServerContext*,
                                                                const v1::WatchRequest* request) {
  return new WatchReactor(ports_.feed, *request);
}

}  // namespace docent
