#include "kb_server/live/live_request.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "absl/container/flat_hash_set.h"
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

// Looks through a text without keeping it. A parser that asks back for each value would take quadratic time.
class Reading final : public nlohmann::json_sax<json> {
 public:
  const std::string& fault() const { return fault_; }  // empty: none
  bool is_object() const { return is_object_; }
  const json& id() const { return id_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t value) override { return Value(value); }
  bool number_unsigned(number_unsigned_t value) override { return Value(value); }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t& value) override { return value.size() > kIdBytes || Value(value); }
  bool binary(binary_t&) override { return true; }
  bool key(string_t& name) override {
    is_id_ = names_.size() == 1 && name == "id";
    if (!names_.back().insert(std::move(name)).second) fault_ = "a name stands twice in one object";
    return true;
  }
  bool start_object(size_t) override {
    if (depth_ == 0) is_object_ = true;
    names_.emplace_back();
    return Open();
  }
  bool end_object() override {
    names_.pop_back();
    --depth_;
    return true;
  }
  bool start_array(size_t) override { return Open(); }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool parse_error(size_t, const std::string&, const json::exception&) override { return false; }

 private:
  template <typename T>
  bool Value(const T& value) {
    if (depth_ == 1 && is_id_) id_ = value;
    return true;
  }
  bool Open() {
    if (++depth_ <= kDepth) return true;
    fault_ = "it has more than 64 objects and lists inside each other";
    return false;
  }

  std::string fault_;
  bool is_object_ = false;
  json id_;
  bool is_id_ = false;  // the newest name
  int depth_ = 0;
  std::vector<absl::flat_hash_set<std::string>> names_;  // of each object that is open
};

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
  Reading reading;
  const bool is_json = json::sax_parse(text, &reading);
  if (!reading.is_object() || (!is_json && reading.fault().empty()))
    return Invalid("a message is no JSON object");
  if (reading.id().is_null() || reading.id().dump().size() > kIdBytes)
    return Invalid("\"id\" is missing, or no whole number or short string");
  *id = reading.id().dump();
  if (!reading.fault().empty()) return Invalid(reading.fault());
  return Read(json::parse(text), services);
}

}  // namespace docent::server
