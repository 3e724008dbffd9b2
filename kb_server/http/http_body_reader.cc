#include "kb_server/http/http_body_reader.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

constexpr size_t kSizeDigits = 16;  // more of them are counted as overhead
constexpr size_t kLineEnd = 2;

int HexValue(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

void SkipBlanks(std::string_view* text) {
  while (!text->empty() && (text->front() == ' ' || text->front() == '\t')) text->remove_prefix(1);
}

// What `*text` begins with up to one of "=; \t", cut off.
std::string_view TakeToken(std::string_view* text) {
  const size_t end = std::min(text->find_first_of("=; \t"), text->size());
  const std::string_view token = text->substr(0, end);
  text->remove_prefix(end);
  return token;
}

// A quoted string, cut off; false where it does not end.
bool TakeQuoted(std::string_view* text) {
  for (size_t i = 1; i < text->size(); ++i) {
    if ((*text)[i] == '\\') {
      ++i;
    } else if ((*text)[i] == '"') {
      text->remove_prefix(i + 1);
      return true;
    }
  }
  return false;
}

// *( BWS ";" BWS name [ BWS "=" BWS ( token / quoted-string ) ] ), RFC 9112 section 7.1.1.
bool AreExtensions(std::string_view text) {
  while (!text.empty()) {
    SkipBlanks(&text);
    if (!text.starts_with(';')) return false;
    text.remove_prefix(1);
    SkipBlanks(&text);
    if (!IsHttpToken(TakeToken(&text))) return false;
    std::string_view value = text;
    SkipBlanks(&value);
    if (!value.starts_with('=')) continue;
    value.remove_prefix(1);
    SkipBlanks(&value);
    if (value.starts_with('"') ? !TakeQuoted(&value) : !IsHttpToken(TakeToken(&value))) return false;
    text = value;
  }
  return true;
}

}  // namespace

HttpBodyReader::HttpBodyReader(const HttpHead& head, HttpBodyLimits limits)
    : limits_(limits), chunked_(head.chunked), part_(head.chunked ? Part::kSizeLine : Part::kData) {
  if (chunked_) return;
  left_ = head.length;
  if (left_ > limits_.bytes) {
    RefuseLength();
  } else if (left_ == 0) {
    state_ = State::kDone;
  }
}

HttpBodyReader::State HttpBodyReader::Refuse(int status, std::string text) {
  refusal_ = TextResponse(status, std::move(text));
  line_.clear();
  return state_ = State::kRefused;
}

HttpBodyReader::State HttpBodyReader::RefuseLength() {
  return Refuse(413,
                absl::StrCat("the request body is larger than the limit http_body_bytes = ", limits_.bytes));
}

HttpBodyReader::State HttpBodyReader::Read(std::string_view* input, std::string* body) {
  while (state_ == State::kMore && !input->empty()) {
    if (part_ == Part::kData) {
      TakeData(input, body);
    } else if (TakeLine(input)) {
      const std::string line = std::move(line_);
      line_.clear();
      EndLine(std::string_view(line).substr(0, line.size() - kLineEnd));
    }
  }
  return state_;
}

void HttpBodyReader::TakeData(std::string_view* input, std::string* body) {
  const size_t bytes = static_cast<size_t>(std::min<uint64_t>(left_, input->size()));
  body->append(input->substr(0, bytes));
  input->remove_prefix(bytes);
  left_ -= bytes;
  if (left_ > 0) return;
  if (chunked_) {
    part_ = Part::kDataEnd;
  } else {
    state_ = State::kDone;
  }
}

bool HttpBodyReader::TakeLine(std::string_view* input) {
  while (!input->empty()) {
    const char c = input->front();
    input->remove_prefix(1);
    const bool control =
        (static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\r' && c != '\n') || c == 0x7f;
    if (control || line_.ends_with('\r') != (c == '\n')) {
      Refuse(400,
             "a line between the chunks of the body has a control character, or does not end with CR LF");
      return false;
    }
    if (part_ == Part::kDataEnd && c != '\r' && c != '\n') {
      Refuse(400, "a chunk of the body is longer than it says");
      return false;
    }
    line_ += c;
    if (c == '\n') return true;
    const size_t free = part_ == Part::kSizeLine ? kSizeDigits + kLineEnd : kLineEnd;
    if (line_.size() > free && !CountOverhead(1)) return false;
  }
  return false;
}

bool HttpBodyReader::CountOverhead(size_t bytes) {
  overhead_ += bytes;
  if (overhead_ <= limits_.overhead) return true;
  const bool trailer = part_ == Part::kTrailer;
  Refuse(trailer ? 431 : 400, absl::StrCat(trailer ? "the trailer fields" : "the chunk extensions",
                                           " of the request are larger than ", limits_.overhead, " bytes"));
  return false;
}

void HttpBodyReader::EndLine(std::string_view line) {
  if (part_ == Part::kSizeLine) return TakeSize(line);
  if (part_ == Part::kDataEnd) {
    part_ = Part::kSizeLine;
    return;
  }
  std::string name;
  std::string value;
  if (line.empty()) {
    state_ = State::kDone;
  } else if (!SplitFieldLine(line, &name, &value)) {
    Refuse(400, "a trailer field after the body is not NAME: VALUE");
  }
}

// "1a2b;name=value"
void HttpBodyReader::TakeSize(std::string_view line) {
  size_t digits = 0;
  uint64_t size = 0;
  for (; digits < line.size() && HexValue(line[digits]) >= 0; ++digits) {
    size = std::min<uint64_t>(size, UINT64_MAX >> 5) * 16 + static_cast<uint64_t>(HexValue(line[digits]));
  }
  if (digits == 0 || !AreExtensions(line.substr(digits))) {
    Refuse(
        400,
        "a chunk of the body does not begin with its size in hexadecimal digits, or has a broken extension");
    return;
  }
  if (size > limits_.bytes - data_) {
    RefuseLength();
    return;
  }
  data_ += static_cast<size_t>(size);
  left_ = size;
  part_ = size == 0 ? Part::kTrailer : Part::kData;
}

}  // namespace docent::server
