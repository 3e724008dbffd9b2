#include "kb_server/http/http_head_reader.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

constexpr size_t kShownBytes = 60;  // of what is wrong, in a message

bool IsTokenChar(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

// Control characters other than the tab. Bytes beyond ASCII may stand in values (obs-text).
bool IsForbidden(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f;
}

std::string_view TrimBlanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string Shown(std::string_view text) {
  return absl::StrCat("\"", absl::CHexEscape(ToAbsl(text.substr(0, kShownBytes))),
                      text.size() > kShownBytes ? "…" : "", "\"");
}

// Whether a field that is a list of tokens has this one.
bool ListHas(const HttpFields& fields, std::string_view name, std::string_view token) {
  for (const auto& [field, value] : fields) {
    if (field != name) continue;
    for (absl::string_view element : absl::StrSplit(value, ',')) {
      if (absl::EqualsIgnoreCase(ToAbsl(TrimBlanks(FromAbsl(element))), ToAbsl(token))) return true;
    }
  }
  return false;
}

size_t CountOf(const HttpFields& fields, std::string_view name) {
  return static_cast<size_t>(
      std::count_if(fields.begin(), fields.end(), [name](const auto& field) { return field.first == name; }));
}

}  // namespace

std::optional<std::string_view> SingleField(const HttpFields& fields, std::string_view name) {
  std::optional<std::string_view> found;
  for (const auto& [field, value] : fields) {
    if (field != name) continue;
    if (found) return std::nullopt;
    found = value;
  }
  return found;
}

bool IsHttpToken(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), IsTokenChar);
}

bool SplitFieldLine(std::string_view line, std::string* name, std::string* value) {
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos || !IsHttpToken(line.substr(0, colon))) return false;
  const std::string_view text = TrimBlanks(line.substr(colon + 1));
  if (std::any_of(text.begin(), text.end(), IsForbidden)) return false;
  *name = absl::AsciiStrToLower(ToAbsl(line.substr(0, colon)));
  *value = text;
  return true;
}

bool HttpHeadReader::Refuse(int status, std::string text) {
  refusal_ = TextResponse(status, std::move(text));
  return false;
}

HttpHeadReader::State HttpHeadReader::Read(std::string_view* input) {
  while (!done_ && !input->empty()) {
    const size_t end = input->find('\n');
    const std::string_view bytes = input->substr(0, end == std::string_view::npos ? input->size() : end + 1);
    input->remove_prefix(bytes.size());
    if (!TakeBytes(bytes)) return State::kRefused;
    if (end == std::string_view::npos) break;
    if (!TakeLine()) return State::kRefused;
  }
  return done_ ? State::kDone : State::kMore;
}

// What cannot be in a head is refused when it comes, not when the line ends.
bool HttpHeadReader::TakeBytes(std::string_view bytes) {
  if (bytes.size() > limits_.bytes - std::min(bytes_, limits_.bytes)) {
    if (!has_request_line_) {  // RFC 9112 section 3
      return Refuse(414, absl::StrCat("the request line is longer than ", limits_.bytes,
                                      " bytes; POST a long query instead"));
    }
    return Refuse(431, absl::StrCat("the request header is larger than ", limits_.bytes, " bytes"));
  }
  bytes_ += bytes.size();
  for (const char c : bytes) {
    const bool after_cr = line_.ends_with('\r');
    if (after_cr != (c == '\n') || (IsForbidden(c) && c != '\r' && c != '\n')) {
      return Refuse(400, absl::StrCat("this is not an HTTP/1.1 request: the line ", Shown(line_ + c),
                                      " has a control character, or does not end with CR LF"));
    }
    line_ += c;
  }
  return true;
}

bool HttpHeadReader::TakeLine() {
  const std::string_view line(line_.data(), line_.size() - 2);
  bool good = true;
  if (!has_request_line_) {
    if (!line.empty()) good = TakeRequestLine(line);  // empty ones before it: RFC 9112 section 2.2
  } else if (line.empty()) {
    good = Finish();
    done_ = good;
  } else {
    good = TakeField(line);
  }
  line_.clear();
  return good;
}

// "GET /sparql?query=… HTTP/1.1"
bool HttpHeadReader::TakeRequestLine(std::string_view line) {
  const size_t first = line.find(' ');
  const size_t last = line.rfind(' ');
  const std::string_view method = line.substr(0, first);
  if (first == std::string_view::npos || last == first || !IsHttpToken(method)) {
    return Refuse(400, absl::StrCat("this is not an HTTP/1.1 request: ", Shown(line)));
  }
  const std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (target.empty() || target.find_first_of(" \t#") != std::string_view::npos) {
    return Refuse(400, absl::StrCat("the request target ", Shown(target), " is empty, or has a blank or #"));
  }
  const bool is_version = version.size() == 8 && version.starts_with("HTTP/") &&
                          absl::ascii_isdigit(version[5]) && version[6] == '.' &&
                          absl::ascii_isdigit(version[7]);
  if (!is_version) {
    return Refuse(400, absl::StrCat("this is not an HTTP/1.1 request: the version is ", Shown(version)));
  }
  if (version[5] != '1') {
    return Refuse(505, absl::StrCat("this server answers HTTP/1.1, not ", ToAbsl(version)));
  }
  head_.method = method;
  head_.target = target;
  head_.minor_version = version[7] - '0';
  has_request_line_ = true;
  return true;
}

bool HttpHeadReader::TakeField(std::string_view line) {
  if (head_.fields.size() == limits_.fields) {
    return Refuse(431, absl::StrCat("the request has more header fields than the limit http_header_fields = ",
                                    limits_.fields));
  }
  if (line.front() == ' ' || line.front() == '\t') {  // RFC 9112 section 5.2
    return Refuse(400, "a header field is folded over two lines; send it in one");
  }
  auto& [name, value] = head_.fields.emplace_back();
  if (SplitFieldLine(line, &name, &value)) return true;
  return Refuse(400, absl::StrCat("the header line ", Shown(line),
                                  " is not NAME: VALUE, without a blank before the colon"));
}

bool HttpHeadReader::Finish() {
  const size_t hosts = CountOf(head_.fields, "host");
  if (hosts > 1) return Refuse(400, "the request has more than one Host header");
  if (hosts == 0 && head_.minor_version > 0) return Refuse(400, "the request has no Host header");
  const bool has_length = CountOf(head_.fields, "content-length") > 0;
  if (has_length && !FrameByLength()) return false;
  if (CountOf(head_.fields, "transfer-encoding") > 0 && !FrameByTransferEncoding(has_length)) return false;
  const bool close = ListHas(head_.fields, "connection", "close");
  head_.keep_alive = !close && (head_.minor_version > 0 || ListHas(head_.fields, "connection", "keep-alive"));
  if (head_.minor_version > 0 && CountOf(head_.fields, "expect") > 0) {
    const std::optional<std::string_view> expect = SingleField(head_.fields, "expect");
    if (!expect || !absl::EqualsIgnoreCase(ToAbsl(*expect), "100-continue")) {
      return Refuse(417, "this server meets no expectation but 100-continue");
    }
    head_.expects_continue = true;
  }
  return true;
}

// RFC 9112 section 6.3, rule 5. Several equal lengths could be taken as one; nothing that is well meant sends them.
bool HttpHeadReader::FrameByLength() {
  const std::optional<std::string_view> length = SingleField(head_.fields, "content-length");
  if (!length) return Refuse(400, "the request has more than one Content-Length");
  const bool digits = !length->empty() && std::all_of(length->begin(), length->end(),
                                                      [](char c) { return c >= '0' && c <= '9'; });
  if (!digits || !absl::SimpleAtoi(ToAbsl(*length), &head_.length)) {
    return Refuse(400, absl::StrCat("Content-Length is ", Shown(*length), ", not a number of bytes"));
  }
  return true;
}

// RFC 9112 sections 6.1 and 6.3: "chunked" is the last coding and stands once; others are not read.
bool HttpHeadReader::FrameByTransferEncoding(bool has_length) {
  if (head_.minor_version == 0) return Refuse(400, "HTTP/1.0 has no Transfer-Encoding");
  if (has_length) return Refuse(400, "the request has both Transfer-Encoding and Content-Length");
  std::vector<std::string> codings;
  for (const auto& [name, value] : head_.fields) {
    if (name != "transfer-encoding") continue;
    for (absl::string_view coding : absl::StrSplit(value, ',')) {
      codings.push_back(absl::AsciiStrToLower(ToAbsl(TrimBlanks(FromAbsl(coding)))));
    }
  }
  for (size_t i = 0; i < codings.size(); ++i) {
    const bool last = i + 1 == codings.size();
    const std::string_view name = TrimBlanks(std::string_view(codings[i]).substr(0, codings[i].find(';')));
    if (!IsHttpToken(name) || (codings[i] == "chunked") != last) {
      return Refuse(400,
                    absl::StrCat("Transfer-Encoding does not end with one \"chunked\": ", Shown(codings[i])));
    }
  }
  if (codings.size() > 1) {
    return Refuse(501, absl::StrCat("the transfer coding ", Shown(codings.front()),
                                    " is not read; send the body as it is, in chunks"));
  }
  head_.chunked = true;
  return true;
}

}  // namespace docent::server
