// One client's place in a standing answer: what it is to be sent next, in order and at its pace. It holds what is being
// sent and no more; a client that falls behind what is kept of the changes is given the whole answer anew. Not
// thread-safe.
#ifndef DOCENT_KB_SERVER_GRPC_ANSWER_CURSOR_H_
#define DOCENT_KB_SERVER_GRPC_ANSWER_CURSOR_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/time/time.h"
#include "docent/v1/context.pb.h"
#include "kb_server/subscriptions/subscription_answer.h"
#include "kb_server/subscriptions/subscriptions.h"

namespace docent::server {

SubscribedQuery ToFollowed(const v1::SubscribeRequest& request);

class AnswerCursor {
 public:
  // `subscriptions` must outlive it.
  AnswerCursor(Subscriptions* subscriptions, const v1::SubscribeRequest& request)
      : subscriptions_(*subscriptions),
        interval_(absl::Milliseconds(request.min_interval_ms())),
        resume_(request.resume()) {}

  // Before it there is nothing to send.
  void Begin(SubscriptionAnswerPtr answer);
  // The next message into `reply`, which is empty. False: there is none now; `due` is infinite, or once for each pause
  // the end of it, when this is to be called again.
  bool Next(v1::SubscribeReply* reply, absl::Time* due);

 private:
  bool Resume(const std::string& token);
  // Makes what is next, if it is there and due, the current change.
  bool TakeNext(absl::Time* due);
  void Write(v1::SubscribeReply* reply);
  std::string Token(uint64_t number) const;

  Subscriptions& subscriptions_;
  const absl::Duration interval_;
  std::string resume_;
  SubscriptionAnswerPtr answer_;
  uint64_t position_ = 0;    // number of the newest change that the client has
  AnswerChangePtr current_;  // being sent; null: none
  size_t offset_ = 0;        // of its rows, those that are sent
  bool reset_ = false;       // the whole answer is next or being sent
  bool last_boolean_ = false;
  bool told_boolean_ = false;
  uint64_t sequence_ = 0;
  absl::Time last_sent_ = absl::InfinitePast();
  absl::Time told_due_ = absl::InfinitePast();
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_ANSWER_CURSOR_H_
