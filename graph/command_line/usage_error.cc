#include "graph/command_line/usage_error.h"

#include <CLI/CLI.hpp>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "graph/base/cut_text.h"

namespace docent {
namespace {

bool IsFlag(const CLI::Option& option) {
  return option.get_expected_min() == 0 && !option.get_positional();
}

bool TakesFreeText(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return !option.get_positional() && (type == "TEXT" || type == "TURTLE");
}

// A value in a message.
std::string Shown(std::string_view value) {
  return CutText(value, 200);
}

// "FILES...", "--run ID"
std::string Written(const CLI::Option& option) {
  const std::string type = option.get_type_name();  // of words to choose from: "TEXT:{union,strict}"
  const size_t words = type.find(":{");
  if (!option.get_positional())
    return absl::StrCat(option.get_name(), " ", words == std::string::npos ? type : type.substr(words + 1));
  return absl::StrCat(absl::AsciiStrToUpper(option.get_name(true)),
                      option.get_expected_max() > 1 ? "..." : "");
}

// Whether the option takes the value. It is left with that value, so its command must not run afterwards.
bool Takes(CLI::Option* option, const std::string& value) {
  try {
    option->clear();
    option->add_result(value);
    option->run_callback();
  } catch (const CLI::Error&) {
    return false;
  }
  return true;
}

std::string OfConversion(CLI::Option* option) {
  const std::vector<std::string> given = option->results();
  const std::string value = given.empty() ? "" : given.front();
  const std::string name = option->get_name();
  if (IsFlag(*option)) return absl::StrCat(name, ": give true or false, not ", Shown(value));
  std::string wrong = value;
  for (const std::string& each : given) {
    if (!Takes(option, each)) {
      wrong = each;
      break;
    }
  }
  const char* kind = Takes(option, "0.5")  ? "give a number, not "
                     : Takes(option, "-1") ? "give a whole number, not "
                     : Takes(option, "0")  ? "give a whole number, 0 or more, not "
                                           : "it cannot be ";
  return absl::StrCat(name, ": ", kind, Shown(wrong));
}

// "0.100000" as "0.1".
std::string ShortNumber(std::string number) {
  if (number.find('.') == std::string::npos) return number;
  while (number.back() == '0') number.pop_back();
  if (number.back() == '.') number.pop_back();
  return number;
}

// CLI11's "NAME: Value VALUE not in range A to B" and "NAME: VALUE not in {A,B}". Texts of any length: the parts are found, not
// matched by a pattern.
std::string OfValue(const std::string& text) {
  constexpr std::string_view kValue = ": Value ", kRange = " not in range ", kTo = " to ",
                             kWords = " not in {";
  const size_t value = text.find(kValue), range = text.rfind(kRange), to = text.rfind(kTo);
  if (value < range && range < to && to != std::string::npos) {
    const size_t begin = value + kValue.size(), least = range + kRange.size();
    return absl::StrCat(
        text.substr(0, value), ": give a number from ", ShortNumber(text.substr(least, to - least)), " to ",
        ShortNumber(text.substr(to + kTo.size())), ", not ", Shown(text.substr(begin, range - begin)));
  }
  const size_t colon = text.find(": "), words = text.rfind(kWords);
  if (colon < words && words != std::string::npos && text.ends_with('}')) {
    const size_t first = words + kWords.size();
    const std::vector<std::string> known = absl::StrSplit(text.substr(first, text.size() - 1 - first), ',');
    return absl::StrCat(text.substr(0, colon), ": give one of ", absl::StrJoin(known, ", "), ", not ",
                        Shown(text.substr(colon + 2, words - colon - 2)));
  }
  return text;
}

// CLI11's "NAME: At Most N required but received M", "NAME: At least N …" and "NAME: N required TYPE missing".
std::string OfCount(const std::string& text, const CLI::App& command) {
  const size_t colon = text.find(": ");
  if (colon == std::string::npos) return text;
  const std::string name = text.substr(0, colon);
  const std::vector<std::string> words = absl::StrSplit(text.substr(colon + 2), ' ');
  if (words.size() == 7 && words[0] == "At") {
    const std::string &bound = words[2], &given = words[6];
    if (words[1] == "Most" && bound == "1")
      return absl::StrCat(name, " is given ", given, " times; give it once");
    return absl::StrCat(name, " takes at ", words[1] == "Most" ? "most " : "least ", bound, " values, not ",
                        given);
  }
  if (words.size() > 2 && words[1] == "required" && words.back() == "missing") {
    const CLI::Option* option = command.get_option_no_throw(name);
    return absl::StrCat(name, " has no value",
                        option == nullptr ? "" : absl::StrCat("; write ", Written(*option)));
  }
  return text;
}

std::string OfMissing(const std::string& text, const CLI::App& command, const std::string& name) {
  if (text == "A subcommand is required") {
    std::vector<std::string> names;
    for (const CLI::App* each : command.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(each->get_name());
    return absl::StrCat("a command is missing; there are ", absl::StrJoin(names, ", "));
  }
  constexpr std::string_view kEnd = " is required";
  const std::string missing = text.ends_with(kEnd) ? text.substr(0, text.size() - kEnd.size()) : "";
  const CLI::Option* option = command.get_option_no_throw(missing);
  if (option == nullptr) return text;
  std::string usage = name;
  for (const CLI::Option* each : command.get_options()) {
    if (each->get_required()) absl::StrAppend(&usage, " ", Written(*each));
  }
  return absl::StrCat(Written(*option), " is missing; write `", usage, "`");
}

}  // namespace

void RefuseEmptyValues(CLI::App* app) {
  const CLI::Validator not_empty(
      [](const std::string& value) {
        return value.empty() ? std::string("it is empty; give its value, or leave it out") : std::string();
      },
      "");
  for (CLI::Option* option : app->get_options([](const CLI::Option*) { return true; })) {
    if (!IsFlag(*option) && !TakesFreeText(*option)) option->check(not_empty);
  }
  for (CLI::App* command : app->get_subcommands([](CLI::App*) { return true; })) RefuseEmptyValues(command);
}

CLI::Validator AtLeast(uint64_t least) {
  const auto check = [least](const std::string& text) {
    uint64_t number = 0;
    if (absl::SimpleAtoi(text, &number) && number >= least) return std::string();
    return absl::StrCat("give a whole number, ", least, " or more, not ", Shown(text));
  };
  return CLI::Validator(check, "");
}

std::string UsageErrorText(const CLI::Error& error, CLI::App* command, const std::string& name) {
  const std::string text = error.what();
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {
    const std::string_view start = "Could not convert: ";
    const std::string given = text.starts_with(start) ? text.substr(start.size()) : "";
    CLI::Option* option = command->get_option_no_throw(given.substr(0, given.find(" = ")));
    return option == nullptr ? text : OfConversion(option);
  }
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) return OfValue(text);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) return OfCount(text, *command);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) return OfMissing(text, *command, name);
  if (dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr)
    return absl::StrCat(text, ": give one of them");
  if (dynamic_cast<const CLI::RequiresError*>(&error) != nullptr) return absl::StrCat(text, ": give both");
  return text;
}

}  // namespace docent
