// The parts of `docent services`: what each does, with the exit code. One thread.
#ifndef DOCENT_KB_SERVER_CLI_SERVICES_SERVICE_COMMANDS_H_
#define DOCENT_KB_SERVER_CLI_SERVICES_SERVICE_COMMANDS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "CLI/App.hpp"
#include "kb_server/cli/client.h"

namespace docent::server {

// What the parts are given; each uses its own.
struct ServiceArguments {
  ClientOptions client;
  std::string name;                    // of a service or a document
  std::vector<std::string> names;      // of operations; what is imported
  std::vector<std::string> arguments;  // NAME=VALUE
  std::vector<std::string> prefixes;
  std::string robot;
  std::string process;
  std::vector<uint32_t> versions;
  bool text = false;
  bool force = false;
};

int ListServices(const ServiceArguments& arguments);
int ShowService(const ServiceArguments& arguments);
int InvokeService(const ServiceArguments& arguments);
int ListServiceVersions(const ServiceArguments& arguments);
int DiffServiceVersions(const ServiceArguments& arguments);
int RemoveServices(const ServiceArguments& arguments);
int GenerateServices(const ServiceArguments& arguments);
int CheckServices(const ServiceArguments& arguments);
int ImportServices(const ServiceArguments& arguments);

// `docent services` with all of them.
void AddServicesCommand(CLI::App* app, int* exit_code);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_SERVICES_SERVICE_COMMANDS_H_
