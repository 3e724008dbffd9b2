#include "graph/command_line/usage_error.h"

#include <CLI/CLI.hpp>
#include <regex>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"

namespace docent {
namespace {

bool IsFlag(const CLI::Option& option) {
  return option.get_expected_min() == 0 && !option.get_positional();
}

bool TakesFreeText(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return !option.get_positional() && (type == "TEXT" || type == "TURTLE");
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

// Whether the option takes the value. Only for options that nobody uses afterwards.
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
  if (IsFlag(*option)) return absl::StrCat(name, ": give true or false, not ", value);
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
  return absl::StrCat(name, ": ", kind, wrong);
}

// "0.100000" as "0.1".
std::string ShortNumber(std::string number) {
  if (number.find('.') == std::string::npos) return number;
  while (number.back() == '0') number.pop_back();
  if (number.back() == '.') number.pop_back();
  return number;
}

std::string OfValue(const std::string& text) {
  static const std::regex* const kRange =
      new std::regex("^(.*): Value ([^]*) not in range (\\S+) to (\\S+)$", std::regex::ECMAScript);
  static const std::regex* const kMember = new std::regex("^([^:]*): ([^]*) not in \\{([^{}]*)\\}$");
  std::smatch found;
  if (std::regex_match(text, found, *kRange)) {
    return absl::StrCat(found[1].str(), ": give a number from ", ShortNumber(found[3]), " to ",
                        ShortNumber(found[4]), ", not ", found[2].str());
  }
  if (std::regex_match(text, found, *kMember)) {
    const std::vector<std::string> words = absl::StrSplit(found[3].str(), ',');
    return absl::StrCat(found[1].str(), ": give one of ", absl::StrJoin(words, ", "), ", not ",
                        found[2].str());
  }
  return text;
}

std::string OfCount(const std::string& text, const CLI::App& command) {
  static const std::regex* const kMost =
      new std::regex("^(.*): At Most (\\d+) required but received (\\d+)$");
  static const std::regex* const kLeast =
      new std::regex("^(.*): At least (\\d+) required but received (\\d+)$");
  static const std::regex* const kNone = new std::regex("^(.*): \\d+ required .* missing$");
  std::smatch found;
  if (std::regex_match(text, found, *kMost)) {
    if (found[2].str() == "1")
      return absl::StrCat(found[1].str(), " is given ", found[3].str(), " times; give it once");
    return absl::StrCat(found[1].str(), " takes at most ", found[2].str(), " values, not ", found[3].str());
  }
  if (std::regex_match(text, found, *kLeast))
    return absl::StrCat(found[1].str(), " takes at least ", found[2].str(), " values, not ", found[3].str());
  if (std::regex_match(text, found, *kNone)) {
    const CLI::Option* option = command.get_option_no_throw(found[1].str());
    return absl::StrCat(found[1].str(), " has no value",
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
    return absl::StrCat("give a whole number, ", least, " or more, not ", text);
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
