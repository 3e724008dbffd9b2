#include "kb_server/work/http_message.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string_view Trim(std::string_view text) {
  return FromAbsl(absl::StripAsciiWhitespace(ToAbsl(text)));
}

// The text up to `separator`, which is cut off `*rest` together with it.
std::string_view CutAt(std::string_view* rest, char separator) {
  const size_t end = rest->find(separator);
  const std::string_view piece = rest->substr(0, end);
  rest->remove_prefix(end == std::string_view::npos ? rest->size() : end + 1);
  return piece;
}

// One element of an Accept header: "text/*;q=0.5".
struct MediaRange {
  std::string type;
  double quality = 1;
};

std::vector<MediaRange> ParseAccept(std::string_view accept) {
  std::vector<MediaRange> ranges;
  while (!accept.empty()) {
    std::string_view element = CutAt(&accept, ',');
    MediaRange range;
    range.type = absl::AsciiStrToLower(ToAbsl(Trim(CutAt(&element, ';'))));
    while (!element.empty()) {
      std::string_view parameter = Trim(CutAt(&element, ';'));
      const std::string name = absl::AsciiStrToLower(ToAbsl(Trim(CutAt(&parameter, '='))));
      if (name == "q" && !absl::SimpleAtod(ToAbsl(Trim(parameter)), &range.quality)) range.quality = 0;
    }
    if (!range.type.empty()) ranges.push_back(std::move(range));
  }
  return ranges;
}

// 3: the type itself, 2: "type/*", 1: "*/*", 0: no match.
int Specificity(const std::string& range, std::string_view type) {
  if (range == type) return 3;
  if (range == "*/*") return 1;
  const size_t slash = type.find('/');
  return range.size() == slash + 2 && range.ends_with("/*") &&
                 range.compare(0, slash, type.substr(0, slash)) == 0
             ? 2
             : 0;
}

}  // namespace

std::string HttpRequest::Header(std::string_view name) const {
  std::string value;
  for (const auto& [key, text] : headers) {
    if (key == name) value.append(value.empty() ? "" : ", ").append(text);
  }
  return value;
}

HttpResponse TextResponse(int status, std::string text) {
  HttpResponse response;
  response.status = status;
  response.body = std::move(text);
  if (!response.body.ends_with('\n')) response.body += '\n';
  return response;
}

std::optional<HttpResponse> MisspeltParameter(const std::string& name,
                                              const std::vector<std::string>& known) {
  const std::string nearest = Nearest(name, known);
  if (nearest.empty()) return std::nullopt;
  return TextResponse(400, absl::StrCat("there is no parameter ", name, "; did you mean ", nearest, "?"));
}

HttpResponse ErrorResponse(const absl::Status& status) {
  int code = 500;
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kFailedPrecondition:
      code = 400;
      break;
    case absl::StatusCode::kUnauthenticated:
      code = 401;
      break;
    case absl::StatusCode::kPermissionDenied:
      code = 403;
      break;
    case absl::StatusCode::kNotFound:
      code = 404;
      break;
    case absl::StatusCode::kAlreadyExists:
    case absl::StatusCode::kAborted:
      code = 409;
      break;
    case absl::StatusCode::kUnimplemented:
      code = 501;
      break;
    case absl::StatusCode::kResourceExhausted:  // what the request is or wants, unless others are in its way
      code = IsOverload(status) ? 503 : 413;
      break;
    case absl::StatusCode::kUnavailable:
      code = 503;
      break;
    case absl::StatusCode::kUnknown:  // what another server did
      code = 502;
      break;
    case absl::StatusCode::kDeadlineExceeded:
      code = 504;
      break;
    default:
      break;
  }
  HttpResponse response = TextResponse(code, std::string(status.message()));
  if (IsOverload(status)) response.headers.emplace_back("Retry-After", "1");
  return response;
}

std::optional<std::string> PercentDecode(std::string_view text, bool plus_is_space) {
  std::string out;
  out.reserve(text.size());
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '+' && plus_is_space) {
      out += ' ';
    } else if (text[i] == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = HexDigit(text[i + 1]);
      const int low = HexDigit(text[i + 2]);
      if (high < 0 || low < 0 || high + low == 0) return std::nullopt;
      out += static_cast<char>(high * 16 + low);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

absl::StatusOr<HttpFields> ParseForm(std::string_view text, size_t limit) {
  HttpFields fields;
  while (!text.empty()) {
    std::string_view value = CutAt(&text, '&');
    if (value.empty()) continue;
    const std::string_view name = CutAt(&value, '=');
    std::optional<std::string> decoded_name = PercentDecode(name, true);
    std::optional<std::string> decoded_value = PercentDecode(value, true);
    if (!decoded_name || !decoded_value) return absl::InvalidArgumentError("there is a broken %-escape");
    if (fields.size() == limit) {
      return absl::InvalidArgumentError(
          absl::StrCat("there are more parameters than the limit http_parameters = ", limit));
    }
    fields.emplace_back(*std::move(decoded_name), *std::move(decoded_value));
  }
  return fields;
}

std::string MediaTypeOnly(std::string_view content_type) {
  return absl::AsciiStrToLower(ToAbsl(Trim(content_type.substr(0, content_type.find(';')))));
}

std::string CharsetOf(std::string_view content_type) {
  std::string type = absl::AsciiStrToLower(ToAbsl(content_type));
  type.erase(std::remove_if(type.begin(), type.end(), [](char c) { return c == ' ' || c == '"'; }),
             type.end());
  const size_t at = type.find("charset=");
  return at == std::string::npos ? std::string() : type.substr(at + 8, type.find(';', at) - at - 8);
}

std::optional<HttpResponse> RefuseCharset(std::string_view content_type) {
  const std::string charset = CharsetOf(content_type);
  if (charset.empty() || charset == "utf-8" || charset == "utf8" || charset == "us-ascii")
    return std::nullopt;
  return TextResponse(415, "send UTF-8; this is " + std::string(content_type));
}

std::optional<size_t> ChooseMediaType(std::string_view accept, const std::vector<std::string_view>& offered) {
  if (Trim(accept).empty()) return offered.empty() ? std::nullopt : std::optional<size_t>(0);
  const std::vector<MediaRange> ranges = ParseAccept(accept);
  std::optional<size_t> best;
  double best_quality = 0;
  for (size_t i = 0; i < offered.size(); ++i) {
    int specificity = 0;
    double quality = 0;
    for (const MediaRange& range : ranges) {
      const int fits = Specificity(range.type, offered[i]);
      if (fits <= specificity) continue;
      specificity = fits;
      quality = range.quality;
    }
    if (quality > best_quality) {
      best = i;
      best_quality = quality;
    }
  }
  return best;
}

std::optional<HostAndPort> SplitHostAndPort(std::string_view text) {
  HostAndPort result;
  std::string_view host = text;
  std::string_view port;
  bool has_port = false;
  if (text.starts_with('[')) {
    const size_t end = text.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    host = text.substr(1, end - 1);
    port = text.substr(end + 1);
    has_port = port.starts_with(':');
    if (!has_port && !port.empty()) return std::nullopt;
    if (has_port) port.remove_prefix(1);
  } else if (const size_t colon = text.find(':'); colon != std::string_view::npos) {
    if (text.find(':', colon + 1) != std::string_view::npos) return std::nullopt;  // IPv6 needs brackets
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
    has_port = true;
  }
  if (host.empty() || host.find_first_of(" \t/@?#") != std::string_view::npos) return std::nullopt;
  if (has_port) {
    uint32_t number = 0;
    const bool digits =
        !port.empty() && port.size() <= 5 && std::all_of(port.begin(), port.end(), absl::ascii_isdigit);
    if (!digits || !absl::SimpleAtoi(ToAbsl(port), &number) || number > 65535) return std::nullopt;
    result.port = static_cast<uint16_t>(number);
  }
  result.host = absl::AsciiStrToLower(ToAbsl(host));
  return result;
}

}  // namespace docent::server
