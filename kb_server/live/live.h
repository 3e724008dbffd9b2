// Live connections: one WebSocket at /live for each tab of a browser, which carries all that the tab follows: streams
// (subscriptions, events of runs) and reads whose answer is told whenever it changes (robots, runs). Messages are JSON:
//
//   tab     {"id":1,"call":"docent.v1.Context/Subscribe","request":{"query":"ASK { … }"},"resume":"…"}
//           {"id":2,"call":"docent.v1.Fleet/List","everyMs":200}
//           {"id":1,"end":true}
//   server  {"hello":{"revision":"41"}}
//           {"id":1,"begun":true,"resume":"…"}
//           {"id":1,"message":{…},"resume":"…"}
//           {"id":1,"end":{}}      or {"id":1,"end":{"error":{"code":"not_found","message":"…"}}}
//
// A method can be followed if it changes nothing (NO_SIDE_EFFECTS); one that is new in proto needs no code. A tab that lost
// its connection gives the newest `resume` of each stream: nothing is lost and nothing comes twice.
//
// A read is asked again where a turn changed what its answer rests on (FollowedReads). That is known of handlers that note what
// they look at (Traced in unary_reactors.h); the others are asked again at each new revision. Of the former, an answer in which
// nothing but its `revision` is new is not told: that may be the revision of an earlier turn.
#ifndef DOCENT_KB_SERVER_LIVE_LIVE_H_
#define DOCENT_KB_SERVER_LIVE_LIVE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "graph/base/web_limits.h"
#include "kb_server/connect/rpc_call.h"
#include "kb_server/door/followed_reads.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/http/http_server.h"

namespace docent::server {

class LiveSession;

struct LivePorts {
  RpcChannel* calls = nullptr;
  WorkerPool* workers = nullptr;  // for large messages; null: none are large
  const QueryPort* queries = nullptr;
  FollowedReads* followed = nullptr;  // null: all reads are asked again at each new revision
  std::vector<std::string> services;  // full names, "docent.v1.Fleet"
  WebLimits limits;
};

// All live connections. A thread of its own asks followed reads again when there is a new revision that may change their
// answers, and probes connections on which nothing happens.
class Live {
 public:
  explicit Live(LivePorts ports);
  // After the HTTP server.
  ~Live();
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;

  // GET /live. This must outlive the server.
  void AddRoute(HttpRoutes* routes);
  // Ends the thread and what all tabs follow, and drops what they have sent: no call is begun from now on. Before the HTTP
  // server ends, whose threads would take message after message, and before `calls` ends.
  void Stop();

  size_t open();  // connections; for metrics

 private:
  void Accept(std::shared_ptr<HttpExchange> exchange);
  void Loop();
  std::vector<std::shared_ptr<LiveSession>> Sessions();

  const LivePorts ports_;
  absl::Mutex mutex_;
  std::vector<std::weak_ptr<LiveSession>> sessions_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_LIVE_LIVE_H_
