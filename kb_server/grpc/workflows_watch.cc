// Workflows.Watch: events of runs, read from the feed at the client's pace.
#include <utility>

#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/write_pump.h"

namespace docent::server {
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

using WatchPump = WritePump<grpc::ServerWriteReactor<v1::RunEvent>, v1::RunEvent>;

// One client. It holds a place in the feed and no events of its own, so a slow one costs nothing; one that
// falls behind what the feed keeps is told so.
class WatchReactor final : public WatchPump {
 public:
  WatchReactor(grpc::CallbackServerContext* context, const ServicePorts& ports,
               const v1::WatchRequest& request)
      : WatchPump(context, ports.send_budget),
        feed_(*ports.feed),
        run_(request.run()),
        after_(request.after()) {
    subscription_ = feed_.Subscribe([this](const RunEvent&) {
      absl::MutexLock lock(&link()->mutex);
      Advance();
      return true;
    });
    absl::StatusOr<uint64_t> first = request.after() == 0 ? feed_.Next() : feed_.FirstAfter(after_);
    absl::MutexLock lock(&link()->mutex);
    if (!first.ok()) {
      End(ToGrpc(first.status()));
      return;
    }
    next_ = *first;
    StartSendInitialMetadata();  // a client that has it misses nothing from then on
    Advance();
  }

 private:
  // The next event that the client wants, if it is there.
  bool FillNext(v1::RunEvent* message, grpc::WriteOptions*) override {
    while (next_ != 0) {
      absl::StatusOr<RunEventPtr> event = feed_.Get(next_);
      if (!event.ok()) End(ToGrpc(event.status()));
      if (!event.ok() || *event == nullptr) return false;
      ++next_;
      if ((*event)->revision <= after_ || (!run_.empty() && (*event)->run != run_)) continue;
      ToProto(**event, message);
      return true;
    }
    return false;
  }
  void OnEnd() override {
    feed_.Unsubscribe(subscription_);  // waits for the committer's thread if that is in Advance
  }

  RunFeed& feed_;
  const std::string run_;  // empty: all
  const Revision after_;
  uint64_t subscription_ = 0;
  uint64_t next_ = 0;  // number of the next event; 0: not known yet
};

}  // namespace

grpc::ServerWriteReactor<v1::RunEvent>* WorkflowsService::Watch(grpc::CallbackServerContext* context,
                                                                const v1::WatchRequest* request) {
  return new WatchReactor(context, ports_, *request);
}

}  // namespace docent::server
