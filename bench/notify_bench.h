// `docent-bench notify`: time from sending an Assert to receiving the notification, over gRPC on loopback and
// durable, with thousands of subscriptions; each update changes one of them.
#ifndef DOCENT_BENCH_NOTIFY_BENCH_H_
#define DOCENT_BENCH_NOTIFY_BENCH_H_

#include <string>
#include <vector>

namespace docent::bench {

// Exit code: 0 measured, 1 a target is missed, 2 bad usage or no server.
int RunNotifyBench(const std::vector<std::string>& args);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_NOTIFY_BENCH_H_
