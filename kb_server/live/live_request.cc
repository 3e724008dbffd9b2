#include "kb_server/live/live_request.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "kb_server/connect/message_codec.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;
using nlohmann::json;

constexpr size_t kIdBytes = 64;
constexpr int kDepth = 64;
constexpr int64_t kLongestEveryMs = 3600000;

absl::Status Invalid(std::string_view message) {
  return absl::InvalidArgumentError(ToAbsl(message));
}

// "docent.v1.Fleet/List"
absl::StatusOr<const pb::MethodDescriptor*> FindMethod(const std::string& call,
                                                       const std::vector<std::string>& services) {
  const size_t slash = call.find('/');
  const std::string service = call.substr(0, slash);
  const bool served = std::find(services.begin(), services.end(), service) != services.end();
  const pb::MethodDescriptor* method = nullptr;
  if (served && slash != std::string::npos && FindService(service) != nullptr)
    method = FindService(service)->FindMethodByName(call.substr(slash + 1));
  if (method == nullptr)
    return absl::NotFoundError(
        absl::StrCat("there is no method \"", call, "\"; give one such as docent.v1.Fleet/List"));
  if (method->client_streaming() ||
      method->options().idempotency_level() != pb::MethodOptions::NO_SIDE_EFFECTS) {
    return absl::FailedPreconditionError(absl::StrCat(
        call, " is not followed here: only methods that change nothing are, of one request; POST it to /",
        call));
  }
  return method;
}

// The JSON of `text`; discarded where it is none. `*fault`: what else is wrong with it.
json Parse(std::string_view text, std::string* fault) {
  std::vector<std::set<std::string>> seen;
  const auto look = [&](int depth, json::parse_event_t event, json& parsed) {
    if (depth > kDepth) *fault = "it has more than 64 objects and lists inside each other";
    if (event == json::parse_event_t::object_start) seen.emplace_back();
    if (event == json::parse_event_t::object_end) seen.pop_back();
    if (event == json::parse_event_t::key && !seen.back().insert(parsed.get<std::string>()).second)
      *fault = "a name stands twice in one object";
    return true;
  };
  return json::parse(text, look, /*allow_exceptions=*/false);
}

absl::StatusOr<LiveRequest> Read(const json& message, const std::vector<std::string>& services) {
  LiveRequest request;
  for (const auto& [name, value] : message.items()) {
    static const std::set<std::string> kNames = {"id", "call", "request", "resume", "everyMs", "end"};
    if (kNames.count(name) == 0) return Invalid(Concat("a message has no \"", name, "\""));
  }
  request.id = message["id"].dump();
  if (message.contains("end")) {
    if (message["end"] != true || message.size() != 2)
      return Invalid("to end a stream, send {\"id\":…,\"end\":true}");
    request.end = true;
    return request;
  }
  const auto call = message.find("call");
  if (call == message.end() || !call->is_string())
    return Invalid("\"call\" is missing: give the method's name");
  auto method = FindMethod(call->get<std::string>(), services);
  if (!method.ok()) return method.status();
  request.method = *method;
  if (message.contains("request") && !message["request"].is_object())
    return Invalid("\"request\" is no object");
  request.request = message.contains("request") ? message["request"].dump() : "{}";
  if (message.contains("resume") && !message["resume"].is_string()) return Invalid("\"resume\" is no string");
  request.resume = message.value("resume", "");
  const json every = message.contains("everyMs") ? message["everyMs"] : json(0);
  if (!every.is_number_integer() || every < 0 || every > kLongestEveryMs)
    return Invalid("\"everyMs\" is no whole number of milliseconds from 0 to 3600000");
  request.every = absl::Milliseconds(every.get<int64_t>());
  return request;
}

}  // namespace

absl::StatusOr<LiveRequest> ReadLiveRequest(std::string_view text, const std::vector<std::string>& services,
                                            std::string* id) {
  *id = "null";
  std::string fault;
  const json message = Parse(text, &fault);
  if (!message.is_object()) return Invalid("a message is no JSON object");
  const auto given = message.find("id");
  if (given == message.end() || !(given->is_string() || given->is_number_integer()) ||
      given->dump().size() > kIdBytes)
    return Invalid("\"id\" is missing, or no whole number or short string");
  *id = given->dump();
  if (!fault.empty()) return Invalid(fault);
  return Read(message, services);
}

}  // namespace docent::server
