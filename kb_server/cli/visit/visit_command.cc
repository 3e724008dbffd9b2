#include "kb_server/cli/visit/visit_command.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/web/visit_code.h"

namespace docent::server {
namespace {

struct QrArguments {
  std::vector<std::string> booths;
  std::string url = "http://127.0.0.1:7480";
  std::string label;
  std::string folder;
};

// "expo:B05" → "expo-B05.svg".
std::string FileName(const std::string& booth) {
  std::string name;
  for (const char c : booth)
    name.push_back(absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' ? c : '-');
  return name + ".svg";
}

absl::Status WriteCode(const QrArguments& arguments, const std::string& booth) {
  const absl::StatusOr<std::string> address = VisitAddress(arguments.url, booth);
  if (!address.ok()) return address.status();
  const absl::StatusOr<std::string> svg =
      QrCodeSvg(*address, arguments.label.empty() ? booth : arguments.label);
  if (!svg.ok()) return svg.status();
  if (arguments.folder.empty()) {
    PrintForPrograms(*svg);
    return absl::OkStatus();
  }
  const std::filesystem::path file = std::filesystem::path(arguments.folder) / FileName(booth);
  std::ofstream out(file, std::ios::binary);
  out << *svg;
  out.close();
  if (!out) {
    return absl::PermissionDeniedError(
        absl::StrCat("cannot write ", file.string(), "; give a folder with --out that may be written"));
  }
  std::cout << file.string() << "\n";
  return absl::OkStatus();
}

int PrintCodes(const QrArguments& arguments) {
  if (arguments.booths.size() > 1 && arguments.folder.empty()) {
    return Fail(absl::InvalidArgumentError(
        "several booths are several files; give the folder for them with --out FOLDER"));
  }
  std::error_code error;
  if (!arguments.folder.empty()) std::filesystem::create_directories(arguments.folder, error);
  if (error) {
    return Fail(absl::PermissionDeniedError(
        absl::StrCat("cannot make the folder ", arguments.folder, ": ", error.message())));
  }
  for (const std::string& booth : arguments.booths) {
    if (absl::Status status = WriteCode(arguments, booth); !status.ok()) return Fail(status);
  }
  return kExitOk;
}

}  // namespace

void AddVisitCommand(CLI::App* app, int* exit_code) {
  CLI::App* visit =
      app->add_subcommand("visit", "Print QR codes that hang at booths and open the visitors' page");
  visit->group(kRobotsGroup);
  visit->require_subcommand(1);
  visit->footer("Example:\n  docent visit qr --booth B05 --url https://expo.example.org > B05.svg");
  auto arguments = std::make_shared<QrArguments>();
  CLI::App* qr = visit->add_subcommand(
      "qr", "Write the QR code of a booth as SVG: a phone that scans it calls a robot to the booth");
  qr->add_option("--booth", arguments->booths,
                 "The booth or region: its IRI, prefix:name, the end of its IRI, or its name")
      ->type_name("PLACE")
      ->required();
  qr->add_option("--url", arguments->url, "Address of the server as phones reach it")
      ->type_name("URL")
      ->capture_default_str();
  qr->add_option("--label", arguments->label, "What stands below the code; by default the booth")
      ->type_name("TEXT");
  qr->add_option("--out", arguments->folder, "Folder for a file a booth, BOOTH.svg; by default it is printed")
      ->type_name("FOLDER");
  qr->footer(
      "Examples:\n"
      "  docent visit qr --booth B05 --url https://expo.example.org > B05.svg\n"
      "  docent visit qr --booth B01 --booth B02 --url https://expo.example.org --out codes");
  qr->callback([arguments, exit_code] { *exit_code = PrintCodes(*arguments); });
}

}  // namespace docent::server
