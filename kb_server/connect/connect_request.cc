#include "kb_server/connect/connect_request.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <grpcpp/support/status.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "graph/base/gzip.h"
#include "graph/base/network_limits.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "kb_server/connect/connect_envelope.h"
#include "kb_server/connect/connect_error.h"
#include "kb_server/door/message_sizes.h"
#include "kb_server/http/http_guard.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;

constexpr size_t kTimeoutDigits = 10;  // the protocol's

HttpResponse Invalid(std::string message) {
  return ConnectErrorResponse({grpc::StatusCode::INVALID_ARGUMENT, std::move(message)});
}

HttpResponse WrongMethod(const HttpRequest& http, const pb::MethodDescriptor& method) {
  HttpResponse response = ConnectErrorResponse(
      {grpc::StatusCode::UNIMPLEMENTED,
       absl::StrCat(method.full_name(), " is called with POST",
                    IsRead(method) ? " or GET" : ": GET is for methods that answer once and change nothing",
                    ", not ", http.method)});
  response.status = 405;
  response.headers.emplace_back("Allow", IsRead(method) ? "GET, HEAD, POST" : "POST");
  return response;
}

HttpResponse WrongType(const pb::MethodDescriptor& method, const std::string& type) {
  const bool streams = method.client_streaming() || method.server_streaming();
  const std::string types = streams ? "application/connect+json or application/connect+proto"
                                    : "application/json or application/proto";
  HttpResponse response = ConnectErrorResponse(
      {grpc::StatusCode::UNKNOWN,
       absl::StrCat(method.full_name(), " takes the Content-Type ", types, ", not \"", type, "\"")});
  response.status = 415;
  response.headers.emplace_back("Accept-Post", absl::StrReplaceAll(types, {{" or ", ", "}}));
  return response;
}

// nullopt: it is neither.
std::optional<bool> IsGzip(std::string_view coding) {
  const std::string name = absl::AsciiStrToLower(absl::StripAsciiWhitespace(ToAbsl(coding)));
  if (name.empty() || name == "identity") return false;
  if (name == "gzip") return true;
  return std::nullopt;
}

bool AcceptsGzip(std::string_view accept_encoding) {
  for (absl::string_view one : absl::StrSplit(ToAbsl(accept_encoding), ',')) {
    std::vector<absl::string_view> parts = absl::StrSplit(one, ';');
    if (!absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(parts[0]), "gzip")) continue;
    const absl::string_view quality = parts.size() > 1 ? absl::StripAsciiWhitespace(parts[1]) : "";
    double q = 1;
    if (absl::StartsWith(quality, "q=") && !absl::SimpleAtod(quality.substr(2), &q)) return false;
    return q > 0;
  }
  return false;
}

std::optional<HttpResponse> ReadCompression(const HttpRequest& http, ConnectHead* head) {
  std::string coding;
  if (head->stream) {
    coding = http.Header("connect-content-encoding");
    head->gzip_reply = AcceptsGzip(http.Header("connect-accept-encoding"));
    if (!http.Header("content-encoding").empty() && IsGzip(http.Header("content-encoding")) != false)
      return Invalid("a stream is not compressed as a whole: use Connect-Content-Encoding");
  } else {
    head->gzip_reply = AcceptsGzip(http.Header("accept-encoding"));
    coding = http.Header("content-encoding");
    for (const auto& [name, value] : http.parameters) {
      if (http.method != "POST" && name == "compression") coding = value;
    }
  }
  const std::optional<bool> gzip = IsGzip(coding);
  if (!gzip) {
    HttpResponse response = ConnectErrorResponse(
        {grpc::StatusCode::UNIMPLEMENTED,
         absl::StrCat("the compression \"", coding, "\" is not read; send it as it is, or as gzip")});
    response.headers.emplace_back(head->stream ? "Connect-Accept-Encoding" : "Accept-Encoding",
                                  "gzip, identity");
    return response;
  }
  head->gzip_request = *gzip;
  return std::nullopt;
}

std::optional<HttpResponse> ReadTimeout(const HttpRequest& http, ConnectHead* head) {
  const std::string text = http.Header("connect-timeout-ms");
  if (text.empty()) return std::nullopt;
  int64_t milliseconds = 0;
  const bool digits =
      text.size() <= kTimeoutDigits && std::all_of(text.begin(), text.end(), absl::ascii_isdigit);
  if (!digits || !absl::SimpleAtoi(text, &milliseconds)) {
    return Invalid(absl::StrCat("Connect-Timeout-Ms is \"", text, "\", not a whole number of at most ",
                                kTimeoutDigits, " digits"));
  }
  head->timeout = absl::Milliseconds(milliseconds);
  return std::nullopt;
}

std::string Parameter(const HttpRequest& http, std::string_view name) {
  for (const auto& [given, value] : http.parameters) {
    if (given == name) return value;
  }
  return "";
}

std::optional<HttpResponse> ReadGetHead(const HttpRequest& http, ConnectHead* head) {
  const std::string encoding = Parameter(http, "encoding");
  if (encoding != "json" && encoding != "proto") {
    return Invalid(absl::StrCat("the parameter encoding is \"", encoding,
                                "\"; give json or proto, such as ?encoding=json&message=%7B%7D"));
  }
  head->codec = encoding == "json" ? MessageCodec::kJson : MessageCodec::kProto;
  const std::string version = Parameter(http, "connect");
  if (!version.empty() && version != "v1")
    return Invalid(absl::StrCat("the parameter connect is \"", version, "\"; this server speaks v1"));
  const std::string base64 = Parameter(http, "base64");
  if (!base64.empty() && base64 != "1" && base64 != "0")
    return Invalid(absl::StrCat("the parameter base64 is \"", base64, "\"; give 1, or leave it out"));
  return std::nullopt;
}

std::optional<HttpResponse> ReadPostHead(const HttpRequest& http, const pb::MethodDescriptor& method,
                                         ConnectHead* head) {
  const std::string given = http.Header("content-type");
  const std::string type = MediaTypeOnly(given);
  const std::string charset = CharsetOf(given);
  head->codec = type.ends_with("json") ? MessageCodec::kJson : MessageCodec::kProto;
  const bool known = head->stream ? type == "application/connect+json" || type == "application/connect+proto"
                                  : type == "application/json" || type == "application/proto";
  if (!known || (!charset.empty() && charset != "utf-8")) return WrongType(method, given);
  return std::nullopt;
}

// One message as it was sent, in its binary form.
absl::StatusOr<std::string> ReadMessage(std::string_view bytes, bool gzip, const pb::MethodDescriptor& method,
                                        MessageCodec codec, const Limits& limits, MemoryUse* memory,
                                        Cancellation* cancellation) {
  const MessageSize largest = codec == MessageCodec::kJson
                                  ? LargestJson(method.full_name(), limits, kNetworkLimits)
                                  : LargestMessage(method.full_name(), limits, kNetworkLimits);
  const absl::Status size = CheckMessageSize(method.full_name(), bytes.size(), largest);
  if (!size.ok()) return size;
  if (!gzip) return ToBinary(*method.input_type(), codec, bytes, memory, cancellation);
  const absl::StatusOr<std::string> unpacked =
      Gunzip(bytes, largest.bytes, largest.limit, memory, cancellation);
  if (!unpacked.ok())
    return WithMessage(unpacked.status(), absl::StrCat("the message: ", unpacked.status().message()));
  absl::StatusOr<std::string> message =
      ToBinary(*method.input_type(), codec, *unpacked, memory, cancellation);
  if (memory != nullptr) memory->Release(unpacked->size());
  return message;
}

absl::StatusOr<std::string> GetMessage(const HttpRequest& http) {
  std::string message = Parameter(http, "message");
  if (Parameter(http, "base64") != "1") return message;
  std::string decoded;  // the URL's alphabet, padded or not
  while (message.ends_with('=')) message.pop_back();
  if (!absl::WebSafeBase64Unescape(message, &decoded) && !absl::Base64Unescape(message, &decoded))
    return absl::InvalidArgumentError(
        "the parameter message is not base64 in the alphabet of URLs (RFC 4648, section 5)");
  return decoded;
}

}  // namespace

std::string_view ConnectHead::ContentType() const {
  const bool json = codec == MessageCodec::kJson;
  if (stream) return json ? "application/connect+json" : "application/connect+proto";
  return json ? "application/json" : "application/proto";
}

bool IsRead(const pb::MethodDescriptor& method) {
  return !method.client_streaming() && !method.server_streaming() &&
         method.options().idempotency_level() == pb::MethodOptions::NO_SIDE_EFFECTS;
}

std::optional<HttpResponse> ReadConnectHead(const HttpRequest& http, const pb::MethodDescriptor& method,
                                            ConnectHead* head) {
  const bool post = http.method == "POST";
  head->stream = method.client_streaming() || method.server_streaming();
  if (!post && !IsRead(method)) return WrongMethod(http, method);
  if (!post && IsAskedByAnotherSite(http)) {
    return ConnectErrorResponse(
        {grpc::StatusCode::PERMISSION_DENIED, "a page of another site asks for this"});
  }
  const std::string version = http.Header("connect-protocol-version");
  if (!version.empty() && version != "1")
    return Invalid(
        absl::StrCat("Connect-Protocol-Version is \"", version, "\"; this server speaks version 1"));
  std::optional<HttpResponse> refusal = post ? ReadPostHead(http, method, head) : ReadGetHead(http, head);
  if (!refusal) refusal = ReadCompression(http, head);
  if (!refusal) refusal = ReadTimeout(http, head);
  return refusal;
}

absl::StatusOr<std::vector<std::string>> ReadConnectMessages(const HttpRequest& http,
                                                             const pb::MethodDescriptor& method,
                                                             const ConnectHead& head, const Limits& limits,
                                                             MemoryUse* memory, Cancellation* cancellation) {
  std::vector<std::string> messages;
  const auto add = [&](std::string_view bytes, bool gzip) -> absl::Status {
    absl::StatusOr<std::string> message =
        ReadMessage(bytes, gzip, method, head.codec, limits, memory, cancellation);
    if (!message.ok()) return message.status();
    messages.push_back(*std::move(message));
    return absl::OkStatus();
  };
  absl::Status status;
  if (!head.stream && http.method == "POST") {
    status = add(http.body, head.gzip_request);
  } else if (!head.stream) {
    const absl::StatusOr<std::string> message = GetMessage(http);
    status = message.ok() ? add(*message, head.gzip_request) : message.status();
  } else {
    const absl::StatusOr<std::vector<ConnectEnvelope>> envelopes =
        SplitEnvelopes(http.body, limits.stream_messages);
    if (!envelopes.ok()) return envelopes.status();
    if (envelopes->size() != 1 && !method.client_streaming()) {
      return absl::UnimplementedError(
          absl::StrCat(method.full_name(), " takes one enveloped message, not ", envelopes->size()));
    }
    size_t unpacked = 0;  // of all of them
    for (const ConnectEnvelope& envelope : *envelopes) {
      const bool gzip = (envelope.flags & kCompressedFlag) != 0;
      if (gzip && !head.gzip_request)
        return absl::InvalidArgumentError(
            "a message is marked as compressed, and there is no Connect-Content-Encoding");
      if (status.ok()) status = add(envelope.data, gzip);
      if (!status.ok()) break;
      unpacked += messages.back().size();
      if (unpacked > limits.http_body_bytes) {
        return absl::ResourceExhaustedError(
            absl::StrCat("unpacked, the messages have more bytes than the limit http_body_bytes = ",
                         limits.http_body_bytes));
      }
    }
  }
  if (!status.ok()) return status;
  return messages;
}

}  // namespace docent::server
