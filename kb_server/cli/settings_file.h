// Settings files: the options of a command as lines NAME = VALUE, the part of TOML (toml.io, version 1.0) that options need.
//   # comment
//   grpc = "127.0.0.1:7400"          text in "", with the escapes of TOML, or in '', as it stands
//   snapshot-records = 200_000       whole numbers
//   insecure = false
//   rules = ["owl2rl", "my.rules"]   lists, which may go over several lines
// One thread.
#ifndef DOCENT_KB_SERVER_CLI_SETTINGS_FILE_H_
#define DOCENT_KB_SERVER_CLI_SETTINGS_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "CLI/App.hpp"
#include "absl/status/status.h"
#include "graph/base/diagnostic.h"

namespace docent::server {

struct Setting {
  std::string name;
  std::vector<std::string> values;  // of a list all, else one
  std::string bare;  // the first value that is no text, but a number, true or false; empty: all are texts
  SourceSpan span;   // of the name
};

struct ParsedSettings {
  std::vector<Setting> settings;  // in order
  Diagnostics diagnostics;        // all mistakes; one a line
  bool ok() const { return !HasErrors(diagnostics); }
};
ParsedSettings ParseSettings(std::string_view text, const std::string& file);

// Gives the file's settings to the options of the command that its command line does not give. An option is named without
// its dashes. INVALID_ARGUMENT with every mistake: names that are no option (with the nearest one), a name given twice,
// values that the option refuses, numbers where a text belongs. Options named in `not_in_files` are none here.
absl::Status ApplySettings(const std::string& file, const std::vector<std::string>& not_in_files,
                           CLI::App* command);

// A settings file with every option of the command but `not_in_files`, each with its description: those that were given as
// they are, the others as comments with their defaults.
std::string SettingsText(const CLI::App& command, const std::vector<std::string>& not_in_files);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_SETTINGS_FILE_H_
