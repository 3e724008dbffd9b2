#include "kb_server/cli/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>

#include "absl/strings/numbers.h"
#include "graph/base/text.h"

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

}  // namespace

Terminal Terminal::OfOutput(std::string_view colours) {
  Terminal terminal;
  const bool is_terminal = isatty(STDOUT_FILENO) != 0;
  if (is_terminal) terminal.columns = ColumnsOfOutput();
  const std::string_view type = Environment("TERM");
  terminal.colours =
      colours == "always" || (colours != "never" && is_terminal && Environment("NO_COLOR").empty() &&
                              !type.empty() && type != "dumb");
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
