// docent map import FILES: maps of other systems as a hall. No server is needed.
#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/rdf/iri.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/cli/text_file.h"
#include "maps/import/map_import.h"

namespace docent::server {
namespace {

struct ImportArguments {
  std::vector<std::string> files;
  maps::MapImportOptions options;
  std::string out;
};

// A file that is there is replaced as a whole.
absl::Status WriteFile(const std::string& path, const std::string& text) {
  if (std::filesystem::exists(path)) return ReplaceTextFile(path, text);
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (out) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrCat("cannot write ", path));
}

int Import(const ImportArguments& arguments) {
  const std::string& name_space = arguments.options.name_space;
  if (!IsAbsoluteIri(name_space) || (!absl::EndsWith(name_space, "#") && !absl::EndsWith(name_space, "/"))) {
    return Fail(absl::InvalidArgumentError(
        absl::StrCat("--namespace ", name_space, " is not an IRI that ends in # or /")));
  }
  const absl::StatusOr<maps::ImportedHall> hall = maps::ImportMaps(arguments.files, arguments.options);
  if (!hall.ok()) {  // the text of mistakes ends its last line
    return Fail(
        absl::Status(hall.status().code(), absl::StripTrailingAsciiWhitespace(hall.status().message())));
  }
  std::cerr << hall->warnings;
  if (arguments.out.empty()) {
    PrintForPrograms(hall->turtle);
    return kExitOk;
  }
  if (absl::Status written = WriteFile(arguments.out, hall->turtle); !written.ok()) return Fail(written);
  std::cout << arguments.out
            << absl::StrFormat(
                   ": a hall of %.1f m x %.1f m, its outline of %d corners, %d walls and obstacles in it, %d "
                   "places, %d connections\n",
                   hall->width_m, hall->depth_m, hall->corners, hall->walls, hall->places, hall->connections);
  return kExitOk;
}

}  // namespace

void AddMapCommand(CLI::App* app, int* exit_code) {
  CLI::App* map = app->add_subcommand("map", "Bring in maps of other systems");
  map->group(kDocumentsGroup);
  map->require_subcommand(1);
  map->footer("Example:\n  docent map import floor.yaml nodes.yaml --out hall.ttl");
  auto arguments = std::make_shared<ImportArguments>();
  arguments->options.name_space = "https://w3id.org/docent/place#";
  CLI::App* command = map->add_subcommand(
      "import",
      "Make a hall of a ROS map, with a topological map if there is one, or of an Open-RMF building");
  command
      ->add_option(
          "files", arguments->files,
          "The description of a ROS map (YAML, beside its PGM image) and a topological map (YAML), in "
          "any order; or a building (NAME.building.yaml)")
      ->required();
  command->add_option("--out", arguments->out, "File for the hall, in Turtle; by default standard output")
      ->type_name("FILE");
  command->add_option("--namespace", arguments->options.name_space, "Where the IRIs of places begin")
      ->type_name("IRI")
      ->capture_default_str();
  command
      ->add_option("--name", arguments->options.name,
                   "Name of the hall; by default that of the building or file")
      ->type_name("NAME");
  command->add_option("--level", arguments->options.level, "Level of a building that has several")
      ->type_name("NAME");
  command->add_option("--height", arguments->options.height_m, "Height of the walls, in metres")
      ->check(CLI::Range(0.1, 100.0))
      ->check([](const std::string& text) {  // a range lets NaN through
        double height = 0;
        return absl::SimpleAtod(text, &height) && std::isfinite(height) ? "" : "a number is expected";
      })
      ->type_name("M")
      ->capture_default_str();
  command->footer(
      "Places become regions with a service point, edges and lanes connections with a length. The "
      "coordinates stay "
      "those of the map.\n"
      "Example:\n"
      "  docent map import floor.yaml nodes.yaml --namespace https://example.org/home# --out hall.ttl");
  command->callback([arguments, exit_code] { *exit_code = Import(*arguments); });
}

}  // namespace docent::server
