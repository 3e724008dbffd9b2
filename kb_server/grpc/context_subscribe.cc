// Context.Subscribe: the answer of a standing query and its changes, at the client's pace.
#include <memory>
#include <utility>

#include "kb_server/grpc/answer_cursor.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent {
namespace {

class SubscribeReactor final : public grpc::ServerWriteReactor<v1::SubscribeReply> {
 public:
  SubscribeReactor(Subscriptions* subscriptions, const v1::SubscribeRequest& request)
      : subscriptions_(*subscriptions), cursor_(subscriptions, request), link_(std::make_shared<Link>()) {
    link_->reactor = this;
    StartSendInitialMetadata();
  }

  void Start(const SubscribedQuery& query) {
    const std::shared_ptr<Link> link = link_;  // this may be gone before Open returns
    subscriptions_.Open(query, link, [link](const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
      absl::MutexLock lock(&link->mutex);
      if (link->reactor == nullptr) return false;
      link->reactor->Begin(answer);
      return true;
    });
  }

  void OnWriteDone(bool ok) override {
    absl::MutexLock lock(&link_->mutex);
    writing_ = false;
    if (ended_) return Finish(status_);
    if (!ok) return End(Gone());
    Advance();
  }
  void OnCancel() override {
    absl::MutexLock lock(&link_->mutex);
    End(Gone());
  }
  void OnDone() override {
    {
      absl::MutexLock lock(&link_->mutex);
      link_->reactor = nullptr;  // before Close: who opens after that finds nobody there
    }
    subscriptions_.Close(link_);
    delete this;
  }

 private:
  // What the subscriptions hold of this client; outlives it.
  struct Link final : Subscriber {
    void Wake() override {
      absl::MutexLock lock(&mutex);
      if (reactor != nullptr) reactor->Advance();
    }
    void Fail(const absl::Status& status) override {
      absl::MutexLock lock(&mutex);
      if (reactor != nullptr) reactor->End(ToGrpc(status));
    }
    absl::Mutex mutex;
    SubscribeReactor* reactor = nullptr;
  };

  static grpc::Status Gone() { return {grpc::StatusCode::CANCELLED, "the client went away"}; }

  // Everything below: with link_->mutex held.
  void Begin(const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
    if (ended_) return;
    if (!answer.ok()) return End(ToGrpc(answer.status()));
    cursor_.Begin(*answer);
    Advance();
  }

  void Advance() {
    if (writing_ || ended_) return;
    message_.Clear();
    absl::Time due;
    if (cursor_.Next(&message_, &due)) {
      writing_ = true;
      StartWrite(&message_);
    } else if (due != absl::InfiniteFuture()) {
      subscriptions_.WakeAt(due, link_);
    }
  }

  // Finishes now, or when the message that is being written is done.
  void End(grpc::Status status) {
    if (ended_) return;
    ended_ = true;
    status_ = std::move(status);
    if (!writing_) Finish(status_);
  }

  Subscriptions& subscriptions_;
  AnswerCursor cursor_;
  const std::shared_ptr<Link> link_;
  v1::SubscribeReply message_;
  bool writing_ = false;
  bool ended_ = false;
  grpc::Status status_;
};

}  // namespace

grpc::ServerWriteReactor<v1::SubscribeReply>* ContextService::Subscribe(grpc::CallbackServerContext*,
                                                                        const v1::SubscribeRequest* request) {
  auto* reactor = new SubscribeReactor(ports_.subscriptions, *request);
  reactor->Start(ToFollowed(*request));
  return reactor;
}

}  // namespace docent
