#include "kb_server/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <streambuf>
#include <utility>

#include "absl/strings/numbers.h"
#include "graph/base/text.h"
#include "kb_server/cli/display_width.h"

namespace docent::server {
namespace {

constexpr size_t kUsualColumns = 80;

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

size_t ColumnsOfOutput() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  size_t columns = 0;
  return absl::SimpleAtoi(ToAbsl(Environment("COLUMNS")), &columns) && columns > 0 ? columns : kUsualColumns;
}

// Select Graphic Rendition, ECMA-48 section 8.3.117.
std::string_view CodeOf(Style style) {
  switch (style) {
    case Style::kStrong:
      return "1";
    case Style::kGood:
      return "32";
    case Style::kBad:
      return "31";
    case Style::kBusy:
      return "33";
    case Style::kFaint:
      return "2";
    case Style::kPlain:
      break;
  }
  return "";
}

bool colours_used = false;     // by Terminal::In
bool passes_as_it_is = false;  // what is written now is for a program

// How much of the text ends with a whole character; the rest begins one.
size_t WholeCharacters(std::string_view text) {
  for (size_t back = 1; back <= std::min<size_t>(3, text.size()); ++back) {
    const auto c = static_cast<unsigned char>(text[text.size() - back]);
    if (c < 0x80) break;
    if (c < 0xC0) continue;
    const size_t length = c >= 0xF0 ? 4 : c >= 0xE0 ? 3 : 2;
    return length > back ? text.size() - back : text.size();
  }
  return text.size();
}

// The length of the code of a colour that the text begins with; 0: it begins with none.
size_t LengthOfColour(std::string_view text) {
  for (const std::string_view code : {"\x1b[0m", "\x1b[1m", "\x1b[2m", "\x1b[31m", "\x1b[32m", "\x1b[33m"}) {
    if (text.starts_with(code)) return code.size();
  }
  return 0;
}

}  // namespace

// Keeps a character back until all of its bytes are there.
class SafeOutput::Filter final : public std::streambuf {
 public:
  explicit Filter(std::ostream* stream) : stream_(stream), under_(stream->rdbuf(this)) {}
  ~Filter() override {
    Pass(pending_);
    under_->pubsync();
    stream_->rdbuf(under_);
  }

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char one = traits_type::to_char_type(c);
    return xsputn(&one, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    if (passes_as_it_is) return under_->sputn(text, size);
    const std::string all = std::exchange(pending_, "") + std::string(text, static_cast<size_t>(size));
    const size_t whole = WholeCharacters(all);
    pending_ = all.substr(whole);
    return Pass(std::string_view(all).substr(0, whole)) ? size : 0;
  }
  int sync() override { return under_->pubsync(); }

 private:
  bool Pass(std::string_view text) {
    std::string safe;
    while (!text.empty()) {
      const size_t at = colours_used ? std::min(text.find('\x1b'), text.size()) : text.size();
      safe += PrintableLines(text.substr(0, at));
      text.remove_prefix(at);
      const size_t colour = text.empty() ? 0 : LengthOfColour(text);
      safe += colour > 0 ? std::string(text.substr(0, colour)) : PrintableLines(text.substr(0, 1));
      text.remove_prefix(text.empty() ? 0 : std::max<size_t>(colour, 1));
    }
    return under_->sputn(safe.data(), static_cast<std::streamsize>(safe.size())) ==
           static_cast<std::streamsize>(safe.size());
  }

  std::ostream* const stream_;
  std::streambuf* const under_;
  std::string pending_;
};

SafeOutput::SafeOutput()
    : out_(std::make_unique<Filter>(&std::cout)), error_(std::make_unique<Filter>(&std::cerr)) {}
SafeOutput::~SafeOutput() = default;

void PrintForPrograms(std::string_view text) {
  static const bool is_terminal = isatty(STDOUT_FILENO) != 0;
  passes_as_it_is = !is_terminal;
  std::cout << text;
  passes_as_it_is = false;
}

void PrintProgress(std::string_view line) {
  passes_as_it_is = true;
  std::cerr << '\r';
  passes_as_it_is = false;
  std::cerr << line << std::flush;
}

Terminal Terminal::OfOutput(std::string_view colours) {
  Terminal terminal;
  const bool is_terminal = isatty(STDOUT_FILENO) != 0;
  if (is_terminal) terminal.columns = ColumnsOfOutput();
  const std::string_view type = Environment("TERM");
  terminal.colours =
      colours == "always" || (colours != "never" && is_terminal && Environment("NO_COLOR").empty() &&
                              !type.empty() && type != "dumb");
  colours_used = colours_used || terminal.colours;
  return terminal;
}

std::string Terminal::In(Style style, std::string_view text) const {
  if (!colours || style == Style::kPlain || text.empty()) return std::string(text);
  return Concat("\x1b[", CodeOf(style), "m", text, "\x1b[0m");
}

Style StyleOfState(std::string_view state) {
  if (state == "done" || state == "standby") return Style::kGood;
  if (state == "failed" || state == "lost" || state == "incident") return Style::kBad;
  if (state == "running" || state == "busy") return Style::kBusy;
  if (state == "cancelled" || state == "skipped" || state == "inactive" || state == "offline")
    return Style::kFaint;
  return Style::kPlain;
}

}  // namespace docent::server
