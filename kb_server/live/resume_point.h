// Places in streams, after which a client goes on that lost its connection. By the shape of a method's messages, so that a new
// stream needs no code:
//
//   request `string resume`, reply `string resume`    the service's own places; a reply with `more` is none
//   request `uint64 after`, reply `uint64 revision`   number of events of one turn: "41:3" is after the third of turn 42
//   others                                            none: the stream begins again
#ifndef DOCENT_KB_SERVER_LIVE_RESUME_POINT_H_
#define DOCENT_KB_SERVER_LIVE_RESUME_POINT_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace google::protobuf {
class Message;
class MethodDescriptor;
}  // namespace google::protobuf

namespace docent::server {

// Of one stream. One thread.
class ResumePoint {
 public:
  explicit ResumePoint(const google::protobuf::MethodDescriptor& method);

  // Makes `request` begin after `resume`, where that is not empty; `newest` is the newest revision that the caller has seen, from
  // which on a stream by turns tells. INVALID_ARGUMENT: there is no such place.
  absl::Status Begin(std::string_view resume, uint64_t newest, google::protobuf::Message* request);
  // The place before the first message; nullopt: none.
  std::optional<std::string> first() const;
  // False: the client has this message already.
  bool IsNew(const google::protobuf::Message& reply);
  // The place after the newest message; nullopt: none.
  std::optional<std::string> Next(const google::protobuf::Message& reply) const;

 private:
  enum class Kind { kNone, kText, kTurns };
  std::string Turns() const;

  Kind kind_ = Kind::kNone;
  uint64_t after_ = 0;     // turns up to this one are whole
  uint64_t revision_ = 0;  // of the newest event
  uint64_t events_ = 0;    // of turn revision_ that have come
  uint64_t known_ = 0;     // events of the first turn that the client has
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_LIVE_RESUME_POINT_H_
