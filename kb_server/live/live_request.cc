#include "kb_server/live/live_request.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "kb_server/connect/message_codec.h"
#include "kb_server/work/json_cursor.h"

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

// Looks through a text once and keeps the members of its object: values as they are, lists and objects as empty ones, and
// of "request" where it stands. A parser that asks back for each value would take quadratic time.
class Reading final : public nlohmann::json_sax<json> {
 public:
  Reading(std::string_view text, Cancellation* cancellation)
      : cursor_{text.data()}, cancellation_(cancellation) {
    is_json_ = json::sax_parse(JsonIterator(text.data(), &cursor_),
                               JsonIterator(text.data() + text.size(), &cursor_), this);
  }

  // Of the cancellation.
  const absl::Status& status() const { return status_; }
  // Empty: none. All the same, the members are read where it is a JSON object.
  const std::string& fault() const { return fault_; }
  bool is_object() const { return is_object_ && (is_json_ || !fault_.empty()); }
  json& members() { return members_; }
  std::string_view request() const { return request_; }

  bool null() override { return Value(nullptr); }
  bool boolean(bool value) override { return Value(value); }
  bool number_integer(number_integer_t value) override { return Value(value); }
  bool number_unsigned(number_unsigned_t value) override { return Value(value); }
  bool number_float(number_float_t value, const string_t&) override { return Value(value); }
  bool string(string_t& value) override { return Value(std::move(value)); }
  bool binary(binary_t&) override { return true; }
  bool key(string_t& name) override {
    if (depth_ == 1) name_ = name;
    if (!names_.back().insert(std::move(name)).second) fault_ = "a name stands twice in one object";
    return true;
  }
  bool start_object(size_t) override {
    if (depth_ == 0) is_object_ = true;
    if (depth_ == 1) begun_ = cursor_.at - 1;
    names_.emplace_back();
    return Open(json::object());
  }
  bool end_object() override {
    names_.pop_back();
    --depth_;
    if (depth_ == 1 && name_ == "request") request_ = {begun_, cursor_.at};
    return true;
  }
  bool start_array(size_t) override { return Open(json::array()); }
  bool end_array() override {
    --depth_;
    return true;
  }
  bool parse_error(size_t, const std::string&, const json::exception&) override { return false; }

 private:
  template <typename T>
  bool Value(T&& value) {
    if (depth_ == 1) members_[name_] = std::forward<T>(value);
    if (cancellation_ != nullptr) status_ = cancellation_->Check();
    return status_.ok();
  }
  bool Open(json empty) {
    if (!Value(std::move(empty))) return false;
    if (++depth_ <= kDepth) return true;
    fault_ = "it has more than 64 objects and lists inside each other";
    return false;
  }

  JsonCursor cursor_;
  Cancellation* const cancellation_;
  absl::Status status_;
  bool is_json_ = false;
  bool is_object_ = false;
  std::string fault_;
  json members_ = json::object();
  std::string name_;  // the newest member's
  const char* begun_ = nullptr;
  std::string_view request_;
  int depth_ = 0;
  std::vector<absl::flat_hash_set<std::string>> names_;  // of each object that is open
};

absl::StatusOr<LiveRequest> Read(Reading* reading, const std::vector<std::string>& services) {
  json& members = reading->members();
  LiveRequest request;
  for (const auto& [name, value] : members.items()) {
    static const std::set<std::string> kNames = {"id", "call", "request", "resume", "everyMs", "end"};
    if (kNames.count(name) == 0) return Invalid(Concat("a message has no \"", name, "\""));
  }
  request.id = members["id"].dump();
  if (members.contains("end")) {
    if (members["end"] != true || members.size() != 2)
      return Invalid("to end a stream, send {\"id\":…,\"end\":true}");
    request.end = true;
    return request;
  }
  const auto call = members.find("call");
  if (call == members.end() || !call->is_string())
    return Invalid("\"call\" is missing: give the method's name");
  auto method = FindMethod(call->get<std::string>(), services);
  if (!method.ok()) return method.status();
  request.method = *method;
  if (members.contains("request") && !members["request"].is_object())
    return Invalid("\"request\" is no object");
  request.request = members.contains("request") ? reading->request() : "{}";
  if (members.contains("resume") && !members["resume"].is_string()) return Invalid("\"resume\" is no string");
  request.resume = members.value("resume", "");
  const json every = members.value("everyMs", json(0));
  if (!every.is_number_integer() || every < 0 || every > kLongestEveryMs)
    return Invalid("\"everyMs\" is no whole number of milliseconds from 0 to 3600000");
  request.every = absl::Milliseconds(every.get<int64_t>());
  return request;
}

}  // namespace

absl::StatusOr<LiveRequest> ReadLiveRequest(std::string_view text, const std::vector<std::string>& services,
                                            std::string* id, Cancellation* cancellation) {
  *id = "null";
  Reading reading(text, cancellation);
  if (!reading.status().ok()) return reading.status();
  if (!reading.is_object()) return Invalid("a message is no JSON object");
  const json named = reading.members().value("id", json());
  const bool is_id = named.is_number_integer() || named.is_string();
  if (!is_id || named.dump().size() > kIdBytes)
    return Invalid("\"id\" is missing, or no whole number or short string");
  *id = named.dump();
  if (!reading.fault().empty()) return Invalid(reading.fault());
  return Read(&reading, services);
}

}  // namespace docent::server
