// docent backup TARGET and docent restore SOURCE: consistent, checked copies of a data folder.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "graph/log/folder_copy.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"

namespace docent::server {
namespace {

struct CopyArguments {
  std::string data;
  std::string place;  // target of a backup, source of a restore
  bool from_snapshot = false;
};

int Copy(const std::string& from, const std::string& to) {
  const absl::StatusOr<log::FolderReport> report = log::CopyFolder(from, to);
  if (!report.ok()) return Fail(report.status());
  std::cout << to << ": records " << report->first << " to " << report->last << ", "
            << report->snapshots.size() << (report->snapshots.size() == 1 ? " snapshot" : " snapshots")
            << "; all of it checked\n";
  return kExitOk;
}

int GoOnFromSnapshot(const std::string& from, const std::string& to) {
  const absl::StatusOr<log::FolderReport> report = log::CopyNewestSnapshot(from, to);
  if (!report.ok()) return Fail(report.status());
  for (const std::string& damaged : report->passed_over) std::cerr << "passed over: " << damaged << "\n";
  std::cout << to << ": goes on from the snapshot at offset " << report->last << " of " << from
            << ", without what came after it; all of it checked\n";
  return kExitOk;
}

}  // namespace

void AddBackupCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<CopyArguments>();
  arguments->data = DefaultDataFolder();
  CLI::App* command = app->add_subcommand(
      "backup", "Copy a data folder as it is now, while its server runs, and check the copy");
  command->group(kServerGroup);
  command->add_option("target", arguments->place, "Folder for the copy; it must be absent or empty")
      ->required();
  command->add_option("--data", arguments->data, "The server's data folder")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->footer("Example:\n  docent backup --data /var/lib/docent /backups/docent-monday");
  command->callback([arguments, exit_code] { *exit_code = Copy(arguments->data, arguments->place); });
}

void AddRestoreCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<CopyArguments>();
  arguments->data = DefaultDataFolder();
  CLI::App* command = app->add_subcommand("restore", "Make a data folder from a backup, and check it");
  command->group(kServerGroup);
  command->add_option("source", arguments->place, "The backup")->required();
  command
      ->add_option("--data", arguments->data,
                   "The data folder to make; it must be absent or empty, so move the old one away first")
      ->type_name("FOLDER")
      ->capture_default_str();
  command->add_flag(
      "--from-snapshot", arguments->from_snapshot,
      "The source's log is lost or damaged: restore its newest whole snapshot, without what came after");
  command->footer("Example:\n  docent restore --data /var/lib/docent /backups/docent-monday");
  command->callback([arguments, exit_code] {
    const auto restore = arguments->from_snapshot ? GoOnFromSnapshot : Copy;
    *exit_code = restore(arguments->place, arguments->data);
  });
}

}  // namespace docent::server
