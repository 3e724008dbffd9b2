// The commands of `docent`, one file each. Every function adds its command to the command line; when it is
// given, it runs and stores the exit code (client.h).
#ifndef DOCENT_KB_SERVER_CLI_COMMANDS_H_
#define DOCENT_KB_SERVER_CLI_COMMANDS_H_

#include <string>
#include <vector>

#include "CLI/App.hpp"

namespace docent::server {

// Headings of `docent --help`.
inline constexpr char kServerGroup[] = "Server";
inline constexpr char kDocumentsGroup[] = "Documents";
inline constexpr char kGraphGroup[] = "Facts and queries";
inline constexpr char kRobotsGroup[] = "Workflows and robots";

void AddServeCommand(CLI::App* app, int* exit_code);
void AddStatusCommand(CLI::App* app, int* exit_code);
void AddLoadCommand(CLI::App* app, int* exit_code);
void AddExportCommand(CLI::App* app, int* exit_code);
void AddRulesCommand(CLI::App* app, int* exit_code);
void AddTellCommand(CLI::App* app, int* exit_code);
void AddQueryCommand(CLI::App* app, int* exit_code);
void AddWatchCommand(CLI::App* app, int* exit_code);
void AddWhyCommand(CLI::App* app, int* exit_code);
void AddWhyNotCommand(CLI::App* app, int* exit_code);
void AddWhatIfCommand(CLI::App* app, int* exit_code);
void AddUpdateCommand(CLI::App* app, int* exit_code);
void AddCheckCommand(CLI::App* app, int* exit_code);
void AddFmtCommand(CLI::App* app, int* exit_code);
void AddMapCommand(CLI::App* app, int* exit_code);
void AddValidateCommand(CLI::App* app, int* exit_code);
void AddOntologyCommand(CLI::App* app, int* exit_code);
void AddRunCommand(CLI::App* app, int* exit_code);
void AddWorkflowsCommand(CLI::App* app, int* exit_code);
void AddRunsCommand(CLI::App* app, int* exit_code);
void AddReplayCommand(CLI::App* app, int* exit_code);
void AddTestCommand(CLI::App* app, int* exit_code);
void AddRobotsCommand(CLI::App* app, int* exit_code);
void AddVerifyCommand(CLI::App* app, int* exit_code);
void AddBackupCommand(CLI::App* app, int* exit_code);
void AddRestoreCommand(CLI::App* app, int* exit_code);
void AddReferenceCommand(CLI::App* app, int* exit_code);

// $XDG_STATE_HOME/docent, else ~/.local/state/docent.
std::string DefaultDataFolder();

// The command line with "+S P O" and "-S P O" of `docent whatif` as --with and --without: what begins with a minus would
// be taken for an option.
std::vector<std::string> WithSignedFacts(std::vector<std::string> arguments);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_COMMANDS_H_
