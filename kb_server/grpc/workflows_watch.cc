// Workflows.Watch: events of runs, read from the feed at the client's pace.
#include "graph/base/cut_text.h"
#include "graph/base/text_limits.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_feed_pump.h"

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
  out->set_detail(CutText(event.detail, kTextLimits.listed_text_bytes));
}

// One client.
class WatchReactor final : public RunFeedPump<v1::RunEvent> {
 public:
  WatchReactor(grpc::CallbackServerContext* context, const RunPorts& ports, const v1::WatchRequest& request)
      : RunFeedPump(context, ports), run_(request.run()), after_(request.after()) {
    const absl::StatusOr<uint64_t> first = request.after() == 0 ? feed().Next() : feed().FirstAfter(after_);
    absl::MutexLock lock(&link()->mutex);
    if (first.ok()) StartSendInitialMetadata();  // a client that has it misses nothing from then on
    BeginAt(first);
  }

 private:
  bool Tell(const RunEvent& event, v1::RunEvent* message) override {
    if (event.revision <= after_ || (!run_.empty() && event.run != run_)) return false;
    ToProto(event, message);
    return true;
  }

  const std::string run_;  // empty: all
  const Revision after_;
};

}  // namespace

grpc::ServerWriteReactor<v1::RunEvent>* WorkflowsService::Watch(grpc::CallbackServerContext* context,
                                                                const v1::WatchRequest* request) {
  return new WatchReactor(context, ports_, *request);
}

}  // namespace docent::server
