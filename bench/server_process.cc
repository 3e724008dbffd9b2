#include "bench/server_process.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"

namespace docent::bench {

absl::StatusOr<std::unique_ptr<ServerProcess>> ServerProcess::Start(const std::string& parent_folder) {
  std::unique_ptr<ServerProcess> server(new ServerProcess());
  std::string pattern = absl::StrCat(parent_folder, "/docent-bench-XXXXXX");
  if (mkdtemp(pattern.data()) == nullptr) {
    return absl::UnavailableError(
        absl::StrCat("cannot make a folder below ", parent_folder, ": ", std::strerror(errno)));
  }
  server->folder_ = pattern;
  std::error_code error;
  std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "docent";
  int out[2];
  if (pipe(out) != 0) return absl::UnavailableError("pipe failed");
  server->pid_ = fork();
  if (server->pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // an interrupted benchmark leaves no server behind
    dup2(out[1], STDOUT_FILENO);
    close(out[0]);
    close(out[1]);
    execl(program.c_str(), "docent", "serve", "--data", pattern.c_str(), "--grpc", "127.0.0.1:0", "--http",
          "127.0.0.1:0", static_cast<char*>(nullptr));
    _exit(127);
  }
  close(out[1]);
  FILE* lines = fdopen(out[0], "r");
  char line[256] = "";
  char grpc_address[128] = "", http_address[128] = "";
  bool read = fgets(line, sizeof(line), lines) != nullptr &&
              sscanf(line, "listening grpc=%127s http=%127s", grpc_address, http_address) == 2;
  fclose(lines);
  if (!read)
    return absl::UnavailableError(absl::StrCat("cannot start ", program.string(), "; build it first"));
  server->grpc_address_ = grpc_address;
  server->http_address_ = http_address;
  return server;
}

double ServerProcess::CpuSeconds() const {
  // proc(5): fields 14 and 15, counted from the parenthesis that ends field 2
  std::ifstream stat(absl::StrCat("/proc/", pid_, "/stat"));
  std::string line;
  std::getline(stat, line);
  std::istringstream fields(line.substr(line.rfind(')') + 1));
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double ServerProcess::ResidentMegabytes() const {
  std::ifstream statm(absl::StrCat("/proc/", pid_, "/statm"));  // proc(5): pages
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

ServerProcess::~ServerProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGTERM);
    int status = 0;
    waitpid(pid_, &status, 0);
  }
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

}  // namespace docent::bench
