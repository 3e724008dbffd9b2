#include "kb_server/http/http_multipart.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

// The value of `name`, e.g. "boundary=", in a header field, without quotes.
std::string ParameterOf(std::string_view field, std::string_view name) {
  const size_t at = absl::AsciiStrToLower(ToAbsl(field)).find(name);
  if (at == std::string::npos) return "";
  std::string_view value = field.substr(at + name.size());
  if (value.starts_with('"')) return std::string(value.substr(1, value.find('"', 1) - 1));
  value = value.substr(0, value.find(';'));
  return std::string(FromAbsl(absl::StripAsciiWhitespace(ToAbsl(value))));
}

// The line that `*rest` begins with, without its end; goes past it.
std::string_view TakeLine(std::string_view* rest) {
  const size_t end = rest->find('\n');
  std::string_view line = rest->substr(0, end);
  rest->remove_prefix(end == std::string_view::npos ? rest->size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

absl::StatusOr<std::vector<HttpPart>> ParseMultipart(std::string_view content_type, std::string_view body,
                                                     size_t limit) {
  const absl::Status broken =
      absl::InvalidArgumentError("the multipart body has no boundary, or does not end with it");
  const std::string boundary = ParameterOf(content_type, "boundary=");
  if (boundary.empty()) return broken;
  const std::string delimiter = "--" + boundary;
  size_t at = body.find(delimiter);
  if (at == std::string_view::npos) return broken;
  std::vector<HttpPart> parts;
  while (true) {
    std::string_view rest = body.substr(at + delimiter.size());
    if (rest.starts_with("--")) return parts;
    TakeLine(&rest);
    if (parts.size() == limit) {
      return absl::InvalidArgumentError(
          absl::StrCat("the multipart body has more parts than the limit http_parameters = ", limit));
    }
    HttpPart part;
    while (!rest.empty()) {
      const std::string_view line = TakeLine(&rest);
      if (line.empty()) break;
      const size_t colon = line.find(':');
      const std::string name = absl::AsciiStrToLower(ToAbsl(line.substr(0, colon)));
      if (name == "content-type")
        part.content_type = FromAbsl(absl::StripAsciiWhitespace(ToAbsl(line.substr(colon + 1))));
      if (name == "content-disposition") part.file = ParameterOf(line, "filename=");
    }
    const size_t begin = static_cast<size_t>(rest.data() - body.data());
    at = body.find("\n" + delimiter, begin == 0 ? 0 : begin - 1);
    if (at == std::string_view::npos) return broken;
    part.body = at < begin ? std::string_view() : body.substr(begin, at - begin);
    if (part.body.ends_with('\r')) part.body.remove_suffix(1);
    parts.push_back(part);
    ++at;
  }
}

}  // namespace docent::server
