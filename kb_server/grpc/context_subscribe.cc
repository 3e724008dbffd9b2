// Context.Subscribe: the answer of a standing query and its changes, at the client's pace.
#include <memory>
#include <utility>

#include "kb_server/grpc/answer_cursor.h"
#include "kb_server/grpc/client_of.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/write_pump.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent::server {
namespace {

using SubscribePump = WritePump<grpc::ServerWriteReactor<v1::SubscribeReply>, v1::SubscribeReply>;

class SubscribeReactor final : public SubscribePump {
 public:
  SubscribeReactor(grpc::CallbackServerContext* context, const ServicePorts& ports,
                   const v1::SubscribeRequest& request)
      : SubscribePump(context, ports.send_budget),
        asks_(ClientOf(*context, ports.clients)),
        subscriptions_(*ports.subscriptions),
        cursor_(ports.subscriptions, request),
        client_(std::make_shared<Client>(link(), this)) {
    StartSendInitialMetadata();
  }

  void Start(const SubscribedQuery& query) {
    const std::shared_ptr<Client> client = client_;  // this may be gone before Open returns
    subscriptions_.Open(
        query, client,
        [client](const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
          absl::MutexLock lock(&client->link->mutex);
          if (client->link->pump == nullptr) return false;
          client->reactor->Begin(answer);
          return true;
        },
        asks_);
  }

 private:
  // What the subscriptions hold of this client; outlives it.
  struct Client final : Subscriber {
    Client(std::shared_ptr<Link> stream, SubscribeReactor* of) : link(std::move(stream)), reactor(of) {}
    void Wake() override {
      absl::MutexLock lock(&link->mutex);
      if (link->pump != nullptr) reactor->Advance();
    }
    void Fail(const absl::Status& status) override {
      absl::MutexLock lock(&link->mutex);
      if (link->pump != nullptr) reactor->End(ToGrpc(status));
    }
    const std::shared_ptr<Link> link;
    SubscribeReactor* const reactor;
  };

  // With the mutex held.
  void Begin(const absl::StatusOr<SubscriptionAnswerPtr>& answer) {
    if (ended()) return;
    if (!answer.ok()) return End(ToGrpc(answer.status()));
    cursor_.Begin(*answer);
    Advance();
  }
  bool FillNext(v1::SubscribeReply* reply, grpc::WriteOptions*) override {
    absl::Time due;
    if (cursor_.Next(reply, &due)) return true;
    if (due != absl::InfiniteFuture()) subscriptions_.WakeAt(due, client_);
    return false;
  }
  void OnEnd() override { subscriptions_.Close(client_); }  // who opens after that finds no stream

  const ClientPtr asks_;
  Subscriptions& subscriptions_;
  AnswerCursor cursor_;
  const std::shared_ptr<Client> client_;
};

}  // namespace

grpc::ServerWriteReactor<v1::SubscribeReply>* ContextService::Subscribe(grpc::CallbackServerContext* context,
                                                                        const v1::SubscribeRequest* request) {
  auto* reactor = new SubscribeReactor(context, ports_, *request);
  reactor->Start(ToFollowed(*request));
  return reactor;
}

}  // namespace docent::server
