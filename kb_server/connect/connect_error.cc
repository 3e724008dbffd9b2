#include "kb_server/connect/connect_error.h"

#include <google/protobuf/any.pb.h>
#include <google/protobuf/empty.pb.h>
#include <google/protobuf/unknown_field_set.h>

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/utf8.h"

namespace docent::server {
namespace {

struct Code {
  std::string_view name;
  int http_status;
};

// By the numbers of gRPC's codes.
constexpr std::array<Code, 17> kCodes = {{{"unknown", 200},
                                          {"canceled", 499},
                                          {"unknown", 500},
                                          {"invalid_argument", 400},
                                          {"deadline_exceeded", 504},
                                          {"not_found", 404},
                                          {"already_exists", 409},
                                          {"permission_denied", 403},
                                          {"resource_exhausted", 429},
                                          {"failed_precondition", 400},
                                          {"aborted", 409},
                                          {"out_of_range", 400},
                                          {"unimplemented", 501},
                                          {"internal", 500},
                                          {"unavailable", 503},
                                          {"data_loss", 500},
                                          {"unauthenticated", 401}}};
constexpr int kStatusDetails = 3;  // field of google.rpc.Status

const Code& CodeOf(grpc::StatusCode code) {
  const auto number = static_cast<size_t>(code);
  return kCodes[number < kCodes.size() ? number : 2];
}

// The details of a google.rpc.Status, which is read without its own class.
std::vector<google::protobuf::Any> DetailsOf(const std::string& status_bytes) {
  std::vector<google::protobuf::Any> details;
  google::protobuf::Empty status;
  if (!status.ParseFromString(status_bytes)) return details;
  const google::protobuf::UnknownFieldSet& fields = status.GetReflection()->GetUnknownFields(status);
  for (int i = 0; i < fields.field_count(); ++i) {
    const google::protobuf::UnknownField& field = fields.field(i);
    if (field.number() != kStatusDetails ||
        field.type() != google::protobuf::UnknownField::TYPE_LENGTH_DELIMITED)
      continue;
    google::protobuf::Any detail;
    if (detail.ParseFromString(field.length_delimited())) details.push_back(std::move(detail));
  }
  return details;
}

std::string UnpaddedBase64(const std::string& bytes) {
  std::string text = absl::Base64Escape(bytes);
  while (text.ends_with('=')) text.pop_back();
  return text;
}

}  // namespace

std::string_view ConnectCodeName(grpc::StatusCode code) {
  return CodeOf(code).name;
}

int ConnectHttpStatus(grpc::StatusCode code) {
  return CodeOf(code).http_status;
}

std::string JsonString(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const std::optional<size_t> invalid = FindInvalidUtf8(text);
    for (const char c : text.substr(0, invalid.value_or(text.size()))) {
      if (c == '"' || c == '\\') {
        out += '\\';
        out += c;
      } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
        absl::StrAppend(&out, "\\u", absl::Hex(static_cast<unsigned char>(c), absl::kZeroPad4));
      } else {
        out += c;
      }
    }
    if (!invalid) break;
    out += "\xEF\xBF\xBD";
    text.remove_prefix(*invalid + 1);
  }
  return out + '"';
}

std::string ConnectErrorJson(const grpc::Status& status) {
  std::string json = absl::StrCat("{\"code\":\"", ToAbsl(ConnectCodeName(status.error_code())), "\"");
  if (!status.error_message().empty())
    absl::StrAppend(&json, ",\"message\":", JsonString(status.error_message()));
  std::string details;
  for (const google::protobuf::Any& detail : DetailsOf(status.error_details())) {
    const std::string& url = detail.type_url();
    absl::StrAppend(&details, details.empty() ? "" : ",",
                    "{\"type\":", JsonString(std::string_view(url).substr(url.rfind('/') + 1)),
                    ",\"value\":\"", UnpaddedBase64(detail.value()), "\"}");
  }
  if (!details.empty()) absl::StrAppend(&json, ",\"details\":[", details, "]");
  return json + "}";
}

HttpResponse ConnectErrorResponse(const grpc::Status& status) {
  HttpResponse response;
  response.status = ConnectHttpStatus(status.error_code());
  response.content_type = "application/json";
  response.body = ConnectErrorJson(status);
  response.headers = {{"Cache-Control", "no-cache"}};
  return response;
}

}  // namespace docent::server
