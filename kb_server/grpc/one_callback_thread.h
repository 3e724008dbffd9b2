// gRPC's callbacks of this process on one thread. For a program, not a library: at most one in a process.
//
// gRPC 1.51 runs callbacks on half as many threads as there are processors, at least two, and these hand polling over
// to each other at every event: on two processors a message then wakes both. Ours are short (what takes longer goes to
// the workers), so one thread is enough; where there are so few processors that gRPC has just two threads, this keeps
// one of them waiting. Measured: bench/README.md, reaction.
#ifndef DOCENT_KB_SERVER_GRPC_ONE_CALLBACK_THREAD_H_
#define DOCENT_KB_SERVER_GRPC_ONE_CALLBACK_THREAD_H_

#include <memory>

namespace docent::server {

class OneCallbackThread {
 public:
  OneCallbackThread();
  // Gives the thread back. After the servers and channels are shut down, or before.
  ~OneCallbackThread();
  OneCallbackThread(const OneCallbackThread&) = delete;
  OneCallbackThread& operator=(const OneCallbackThread&) = delete;

  // To be called at least every 900 ms while nothing may be going on: after a second without an event a callback
  // thread of gRPC sleeps for 100 ms, whatever comes. The thread that made this object.
  void KeepAwake();

 private:
  struct Call;
  struct KeptThread;
  std::unique_ptr<KeptThread> kept_;  // null: gRPC has more than two
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_ONE_CALLBACK_THREAD_H_
