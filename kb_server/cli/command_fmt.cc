// docent fmt FILES: lays CAWL and RSEL documents out. No server is needed.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/cli/text_file.h"
#include "workflow/xml/formatter.h"

namespace docent::server {
namespace {

struct FmtArguments {
  std::vector<std::string> files;
  bool check = false;
};

constexpr char kStandardInput[] = "-";

class FileFormatter {
 public:
  explicit FileFormatter(const FmtArguments& arguments) : arguments_(arguments) {}

  int Run() {
    for (const std::string& file : arguments_.files) {
      if (absl::Status status = Format(file); !status.ok()) exit_code_ = Fail(status);
    }
    return exit_code_ == kExitOk && differs_ ? kExitNegative : exit_code_;
  }

 private:
  absl::Status Format(const std::string& file) {
    if (IsPacked(file)) return absl::InvalidArgumentError(absl::StrCat(file, " is packed; unpack it first"));
    const absl::StatusOr<std::string> text = ReadBytes(file);
    if (!text.ok()) return text.status();
    const bool standard_input = file == kStandardInput;
    const std::string name = standard_input ? "stdin" : file;
    const xml::FormattedXml formatted = xml::FormatXml(*text, name);
    if (!formatted.ok()) {
      if (!standard_input && !HasXmlName(file)) {
        return absl::InvalidArgumentError(absl::StrCat(
            name, " is no XML document; fmt lays out CAWL and RSEL documents alone (.cawl.xml, .rsel.xml)"));
      }
      std::cerr << Render(formatted.diagnostics, *text);
      exit_code_ = kExitBad;
      return absl::OkStatus();
    }
    if (!absl::EqualsIgnoreCase(formatted.root, "cawl") && !absl::EqualsIgnoreCase(formatted.root, "rsel")) {
      return absl::InvalidArgumentError(absl::StrCat(name, ": <", formatted.root,
                                                     "> is neither a CAWL nor an RSEL document; their root "
                                                     "elements are <CAWL> and <rsel>"));
    }
    const bool same = formatted.text == *text;
    if (arguments_.check) {
      if (same) return absl::OkStatus();
      differs_ = true;
      std::cout << name << "\n";
      return absl::OkStatus();
    }
    if (standard_input) {
      PrintForPrograms(formatted.text);
      return absl::OkStatus();
    }
    if (same) return absl::OkStatus();
    if (absl::Status status = ReplaceTextFile(file, formatted.text); !status.ok()) return status;
    std::cout << name << "\n";
    return absl::OkStatus();
  }

  static bool HasXmlName(const std::string& file) {
    return absl::EndsWith(file, ".xml") || absl::EndsWith(file, ".cawl") || absl::EndsWith(file, ".rsel");
  }
  static bool IsPacked(const std::string& file) { return absl::EndsWith(file, ".gz"); }

  const FmtArguments& arguments_;
  int exit_code_ = kExitOk;
  bool differs_ = false;
};

}  // namespace

void AddFmtCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<FmtArguments>();
  CLI::App* command = app->add_subcommand(
      "fmt",
      "Lay CAWL and RSEL files out: indentation, blanks and line ends, nothing else, without a server");
  command->group(kDocumentsGroup);
  command
      ->add_option("files", arguments->files,
                   "Files to write again where their layout differs; their names are printed. - reads "
                   "standard input and prints the document")
      ->required();
  command->add_flag("--check", arguments->check,
                    "Write nothing, and print the names of files that would change");
  command->footer(
      "Exit code 1: with --check, a file would change.\n"
      "Example:\n"
      "  docent fmt booth_guide.cawl.xml booth_guide.rsel.xml");
  command->callback([arguments, exit_code] { *exit_code = FileFormatter(*arguments).Run(); });
}

}  // namespace docent::server
