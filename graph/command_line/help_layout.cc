#include "graph/command_line/help_layout.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace docent {
namespace {

constexpr size_t kUsualColumns = 100;
constexpr size_t kLeastColumns = 40;
constexpr size_t kNameColumns = 28;

size_t Columns() {
  winsize size{};
  size_t columns = 0;
  const char* given = std::getenv("COLUMNS");
  if (isatty(STDOUT_FILENO) != 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) columns = size.ws_col;
  if (columns == 0 && given != nullptr && !absl::SimpleAtoi(given, &columns)) columns = 0;
  return columns == 0 ? kUsualColumns : std::max(columns, kLeastColumns);
}

// "{union,strict}" of "TEXT:{union,strict}"; else the text before the colon, which is CLI11's name of a
// check.
std::string ValueName(const CLI::Option* option) {
  const std::string type = option->get_type_name();
  const size_t choices = type.find(":{");
  return choices == std::string::npos ? type.substr(0, type.find(':')) : type.substr(choices + 1);
}

bool IsRepeated(const CLI::Option* option) {
  return option->get_expected_max() > 1 ||
         option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
}

}  // namespace

HelpLayout::HelpLayout() : columns_(Columns()) {
  column_width(kNameColumns);
}

std::string HelpLayout::make_usage(const CLI::App* app, std::string name) const {
  std::string out = absl::StrCat("\nUsage: ", name, " [OPTIONS]");
  for (const CLI::Option* positional :
       app->get_options([](const CLI::Option* o) { return o->get_positional(); })) {
    const std::string shown =
        absl::StrCat(make_option_name(positional, true), positional->get_expected_max() > 1 ? "..." : "");
    absl::StrAppend(&out, " ", positional->get_required() ? shown : absl::StrCat("[", shown, "]"));
  }
  if (!app->get_subcommands([](const CLI::App*) { return true; }).empty())
    out += app->get_require_subcommand_min() == 0 ? " [COMMAND]" : " COMMAND";
  return out + "\n";
}

std::string HelpLayout::make_description(const CLI::App* app) const {
  return Wrapped(app->get_description(), 0) + "\n";
}

std::string HelpLayout::make_subcommand(const CLI::App* command) const {
  return Entry(command->get_name(), Wrapped(command->get_description(), column_width_));
}

std::string HelpLayout::make_option(const CLI::Option* option, bool is_positional) const {
  return Entry(absl::StrCat(make_option_name(option, is_positional), make_option_opts(option)),
               make_option_desc(option));
}

std::string HelpLayout::make_option_name(const CLI::Option* option, bool is_positional) const {
  if (is_positional) return absl::AsciiStrToUpper(option->get_name(true, false));
  std::string name = option->get_name(false, true);
  for (size_t at = name.find(','); at != std::string::npos; at = name.find(',', at + 2))
    name.insert(at + 1, " ");
  return name;
}

std::string HelpLayout::make_option_opts(const CLI::Option* option) const {
  if (option->get_positional() && option->get_lnames().empty())
    return option->get_expected_max() > 1 ? "..." : "";
  return option->get_type_size() == 0 ? "" : absl::StrCat(" ", ValueName(option));
}

std::string HelpLayout::make_option_desc(const CLI::Option* option) const {
  std::string text = option->get_description();
  if (IsRepeated(option) && !option->get_positional()) absl::StrAppend(&text, "; may be repeated");
  if (!option->get_default_str().empty())
    absl::StrAppend(&text, " (default: ", option->get_default_str(), ")");
  if (!option->get_envname().empty()) absl::StrAppend(&text, " (environment: ", option->get_envname(), ")");
  return Wrapped(text, column_width_);
}

std::string HelpLayout::Entry(const std::string& name, const std::string& text) const {
  std::string out = absl::StrCat("  ", name);
  const std::string indent = absl::StrCat("\n", std::string(column_width_, ' '));
  if (text.empty()) return out + "\n";
  if (out.size() + 2 > column_width_) {
    out += indent;
  } else {
    out.resize(column_width_, ' ');
  }
  return absl::StrCat(out, absl::StrReplaceAll(text, {{"\n", indent}}), "\n");
}

std::string HelpLayout::Wrapped(const std::string& text, size_t indent) const {
  const size_t room = columns_ - std::min(indent, columns_ / 2);
  std::string out;
  size_t line = 0;
  std::stringstream words(text);
  for (std::string word; words >> word;) {
    const size_t width = std::count_if(word.begin(), word.end(), [](char c) { return (c & 0xC0) != 0x80; });
    if (line > 0 && line + 1 + width > room) {
      out += '\n';
      line = 0;
    }
    if (line > 0) out += ' ';
    out += word;
    line += width + (line > 0 ? 1 : 0);
  }
  return out;
}

}  // namespace docent
