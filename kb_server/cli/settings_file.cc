#include "kb_server/cli/settings_file.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/command_line/usage_error.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/rdf/utf8.h"

namespace docent::server {
namespace {

class SettingsReader {
 public:
  // A byte order mark at the beginning is no part of the text.
  SettingsReader(std::string_view text, const std::string& file)
      : text_(text.substr(text.starts_with("\xEF\xBB\xBF") ? 3 : 0)), file_(file) {}

  ParsedSettings Read() {
    while (SkipBlankLines(), at_ < text_.size()) {
      const size_t begin = at_;
      if (!ReadLine()) {
        // The next line is looked at, too.
        at_ = std::max(begin, at_);
        SkipToLineEnd();
      }
    }
    return std::move(out_);
  }

 private:
  bool ReadLine() {
    Setting setting;
    setting.span = Here();
    if (Peek() == '[') return Fail("tables are not used here", "write NAME = VALUE, a line each");
    while (absl::ascii_isalnum(Peek()) || Peek() == '-' || Peek() == '_') setting.name += text_[at_++];
    if (setting.name.empty())
      return Fail("a name is expected", "write NAME = VALUE; a comment begins with #");
    SkipBlanks();
    if (Peek() != '=')
      return Fail(absl::StrCat("\"=\" is expected after ", setting.name), "write NAME = VALUE");
    ++at_;
    SkipBlanks();
    if (Peek() == '[' ? !ReadList(&setting) : !ReadValue(&setting)) return false;
    SkipBlanks();
    SkipComment();
    if (at_ < text_.size() && Peek() != '\n')
      return Fail("nothing more is expected here", "write one setting a line");
    out_.settings.push_back(std::move(setting));
    return true;
  }

  bool ReadList(Setting* setting) {
    ++at_;
    while (true) {
      SkipBlankLines();
      if (Peek() == ']') break;
      if (!ReadValue(setting)) return false;
      SkipBlankLines();
      if (Peek() == ',') {
        ++at_;
      } else if (Peek() != ']') {
        return Fail("\",\" or \"]\" is expected", "a list is [\"one\", \"two\"]");
      }
    }
    ++at_;
    return true;
  }

  bool ReadValue(Setting* setting) {
    if (Peek() == '"' || Peek() == '\'') return ReadText(&setting->values);
    std::string word;
    while (absl::ascii_isalnum(Peek()) || Peek() == '-' || Peek() == '_' || Peek() == '+')
      word += text_[at_++];
    const bool digits = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
      return absl::ascii_isdigit(c) || c == '_';
    });
    if (digits) {
      std::erase(word, '_');
    } else if (word != "true" && word != "false") {
      at_ -= word.size();
      return Fail("a value is expected", "texts stand in quotes; others are whole numbers, true and false");
    }
    if (setting->bare.empty()) setting->bare = word;
    setting->values.push_back(word);
    return true;
  }

  bool ReadText(std::vector<std::string>* values) {
    const SourceSpan begin = Here();
    const char quote = text_[at_++];
    std::string value;
    while (Peek() != quote) {
      if (at_ >= text_.size() || Peek() == '\n') return FailAt(begin, "this text has no closing quote", "");
      if (quote == '"' && Peek() == '\\') {
        if (!ReadEscape(&value)) return false;
      } else {
        value += text_[at_++];
      }
    }
    ++at_;
    values->push_back(std::move(value));
    return true;
  }

  bool ReadEscape(std::string* value) {
    constexpr std::string_view kLetters = "btnfr\"\\";
    constexpr std::string_view kMeanings = "\b\t\n\f\r\"\\";
    const char letter = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
    if (const size_t found = kLetters.find(letter); found != std::string_view::npos && letter != '\0') {
      *value += kMeanings[found];
      at_ += 2;
      return true;
    }
    const size_t digits = letter == 'u' ? 4 : letter == 'U' ? 8 : 0;
    const std::string_view hex = text_.substr(std::min(text_.size(), at_ + 2), digits);
    uint32_t c = 0;
    for (const char digit : hex) {
      if (!absl::ascii_isxdigit(digit)) return Fail("this escape has no such digits", "");
      c = c * 16 + static_cast<uint32_t>(absl::ascii_isdigit(digit) ? digit - '0'
                                                                    : absl::ascii_tolower(digit) - 'a' + 10);
    }
    if (digits == 0 || hex.size() < digits || c > 0x10FFFF || (c >= 0xD800 && c <= 0xDFFF))
      return Fail("this escape is not known", "write \\\\ for a backslash, or the text in ''");
    AppendUtf8(c, value);
    at_ += 2 + digits;
    return true;
  }

  char Peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void SkipBlanks() {
    while (Peek() == ' ' || Peek() == '\t' || Peek() == '\r') ++at_;
  }
  void SkipToLineEnd() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }
  void SkipComment() {
    if (Peek() == '#') SkipToLineEnd();
  }
  void SkipBlankLines() {
    while (SkipBlanks(), SkipComment(), Peek() == '\n') ++at_;
  }

  SourceSpan Here() const { return SpanAt(text_, at_); }
  bool FailAt(const SourceSpan& span, std::string message, std::string hint) {
    out_.diagnostics.push_back(
        {file_, span, std::move(message), std::move(hint), Diagnostic::Severity::kError});
    return false;
  }
  bool Fail(std::string message, std::string hint) {
    return FailAt(Here(), std::move(message), std::move(hint));
  }

  const std::string_view text_;
  const std::string file_;
  size_t at_ = 0;
  ParsedSettings out_;
};

std::string NameOf(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : option.get_lnames().front();
}

std::vector<CLI::Option*> OptionsInFiles(const CLI::App& command,
                                         const std::vector<std::string>& not_in_files) {
  std::vector<CLI::Option*> options;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = NameOf(*option);
    if (name.empty() || std::find(not_in_files.begin(), not_in_files.end(), name) != not_in_files.end())
      continue;
    options.push_back(const_cast<CLI::Option*>(option));  // the command's own, which ApplySettings changes
  }
  return options;
}

bool IsFlag(const CLI::Option& option) {
  return option.get_expected_min() == 0;
}

bool IsNumber(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return absl::ascii_isdigit(c); });
}

bool TakesNumbers(const CLI::Option& option) {
  return IsNumber(option.get_default_str());
}

std::string Value(const CLI::Option& option, const std::string& text) {
  if (IsNumber(text) && TakesNumbers(option)) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

// "" for an option that takes many values and has no default.
std::string Values(const CLI::Option& option, const std::vector<std::string>& given) {
  if (IsFlag(option)) return given.empty() ? "false" : "true";
  if (option.get_expected_max() == 1)
    return Value(option, given.empty() ? option.get_default_str() : given.front());
  const auto value = [&](std::string* out, const std::string& text) { out->append(Value(option, text)); };
  return absl::StrCat("[", absl::StrJoin(given, ", ", value), "]");
}

std::string Comment(const std::string& text) {
  constexpr size_t kColumns = 98;
  std::string out;
  std::string line = "#";
  for (const std::string& word : CLI::detail::split(text, ' ')) {
    if (line.size() > 1 && line.size() + 1 + word.size() > kColumns) {
      absl::StrAppend(&out, line, "\n");
      line = "#";
    }
    absl::StrAppend(&line, " ", word);
  }
  return out + line + "\n";
}

}  // namespace

ParsedSettings ParseSettings(std::string_view text, const std::string& file) {
  return SettingsReader(text, file).Read();
}

absl::Status ApplySettings(const std::string& file, const std::vector<std::string>& not_in_files,
                           CLI::App* command) {
  auto text = ReadText(file);
  if (!text.ok()) return text.status();
  ParsedSettings parsed = ParseSettings(*text, file);
  std::set<std::string> seen;
  const std::vector<CLI::Option*> options = OptionsInFiles(*command, not_in_files);
  for (const Setting& setting : parsed.settings) {
    const auto fail = [&](std::string message, std::string hint) {
      parsed.diagnostics.push_back(
          {file, setting.span, std::move(message), std::move(hint), Diagnostic::Severity::kError});
    };
    const auto found = std::find_if(options.begin(), options.end(), [&](const CLI::Option* option) {
      return NameOf(*option) == setting.name;
    });
    if (found == options.end()) {
      std::vector<std::string> names;
      for (const CLI::Option* option : options) names.push_back(NameOf(*option));
      const std::string nearest = Nearest(setting.name, names);
      fail(absl::StrCat("there is no setting ", setting.name),
           nearest.empty() ? absl::StrCat("there are ", absl::StrJoin(names, ", "))
                           : absl::StrCat("did you mean ", nearest, "?"));
      continue;
    }
    CLI::Option* option = *found;
    if (!seen.insert(setting.name).second) {
      fail(absl::StrCat(setting.name, " is given a second time"),
           "a list takes several values: [\"one\", \"two\"]");
      continue;
    }
    if ((option->get_expected_max() == 1 || IsFlag(*option)) && setting.values.size() != 1) {
      fail(absl::StrCat(setting.name, " takes one value"), "");
      continue;
    }
    if (!setting.bare.empty() && !IsFlag(*option) && !TakesNumbers(*option)) {
      fail(absl::StrCat(setting.name, " takes a text, and ", setting.bare, " is none"),
           absl::StrCat("write it in quotes: \"", setting.bare, "\""));
      continue;
    }
    // A default that is empty is what a file has that --print-config made.
    const bool is_none = setting.values == std::vector<std::string>{""} &&
                         option->get_default_str().empty() && option->get_expected_max() == 1 &&
                         !IsFlag(*option);
    if (option->count() > 0 || setting.values.empty() || is_none) continue;
    try {
      for (const std::string& value : setting.values) option->add_result(value);
      option->run_callback();
    } catch (const CLI::Error& error) {
      fail(UsageErrorText(error, command, command->get_name()), "");
    }
  }
  return ToStatus(parsed.diagnostics, *text);
}

std::string SettingsText(const CLI::App& command, const std::vector<std::string>& not_in_files) {
  std::string out;
  for (const CLI::Option* option : OptionsInFiles(command, not_in_files)) {
    std::string description = option->get_description();
    if (option->get_expected_max() > 1 && !IsFlag(*option)) description += "; a list";
    const bool given = option->count() > 0;
    absl::StrAppend(&out, out.empty() ? "" : "\n", Comment(description), given ? "" : "#", NameOf(*option),
                    " = ", Values(*option, given ? option->results() : std::vector<std::string>()), "\n");
  }
  return out;
}

}  // namespace docent::server
