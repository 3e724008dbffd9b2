#include "bench/kb/kb_systems.h"

#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"

namespace docent::bench {
namespace {

bool Succeeds(const std::string& command) {
  return system(absl::StrCat(command, " >/dev/null 2>&1").c_str()) == 0;
}

std::string Quoted(const std::string& path) {
  return absl::StrCat("'", path, "'");
}

void Take(const nlohmann::json& line, KbRun* run) {
  if (!line.contains("case")) {
    run->load_s = line.value("load_s", 0.0);
    run->bytes = line.value("bytes", 0.0);
    run->index_bytes = line.value("index_bytes", 0.0);
    run->dictionary_bytes = line.value("dictionary_bytes", 0.0);
    return;
  }
  KbAnswer& answer = run->answers[{line["case"].get<size_t>(), line["mode"].get<std::string>()}];
  answer.reason = line.value("reason", "");
  if (!answer.reason.empty()) return;
  answer.answers = line["answers"].get<std::vector<int64_t>>();
  answer.us = line["us"].get<std::vector<std::vector<double>>>();
}

}  // namespace

std::vector<double> KbAnswer::Means(size_t instances) const {
  std::vector<double> means;
  if (us.empty() || instances == 0 || us[0].size() < instances) return means;
  means.assign(us.size(), 0);
  for (size_t i = 0; i < instances; ++i) {
    std::vector<double> latencies;
    for (const std::vector<double>& pass : us) latencies.push_back(pass[i]);
    std::sort(latencies.begin(), latencies.end());
    for (size_t k = 0; k < means.size(); ++k) means[k] += latencies[k] / static_cast<double>(instances);
  }
  return means;
}

std::vector<KbSystem> KbSystems(const std::string& programs, const std::string& scripts,
                                const std::string& npm) {
  std::vector<KbSystem> systems;
  systems.push_back({"docent", Quoted(programs + "/docent_kb_docent"), ""});
  systems.push_back({"Oxigraph npm (WASM)",
                     absl::StrCat("NPM=", Quoted(npm), " node ", Quoted(scripts + "/oxigraph.mjs")), ""});
  if (!Succeeds("node --version")) {
    systems.back().missing = "node is not installed";
  } else if (!std::filesystem::exists(npm + "/node_modules/oxigraph")) {
    systems.back().missing =
        absl::StrCat("not installed: npm install --no-package-lock --prefix ", npm, " oxigraph");
  }
  systems.push_back({"librdf trees + Rasqal", Quoted(programs + "/docent_kb_redland"), ""});
  if (!std::filesystem::exists(programs + "/docent_kb_redland")) {
    systems.back().missing = "not built: it needs librdf0-dev";
  }
  return systems;
}

KbProcess::KbProcess(const KbSystem& system, const std::string& job_file, int timeout_s)
    : left_(std::chrono::seconds(timeout_s)) {
  run_.reason = system.missing;
  if (!run_.reason.empty()) return;
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    run_.reason = "cannot be started";
    return;
  }
  const std::string command =
      absl::StrCat("exec env ", system.command, " ", Quoted(job_file), " 2>/dev/null");
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // an interrupted benchmark leaves no peer behind
    dup2(ends[1], STDIN_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  close(ends[1]);
  socket_ = ends[0];
  if (pid_ < 0) {
    close(socket_);
    run_.reason = "cannot be started";
    return;
  }
  if (!TakeLine()) {
    run_.reason = left_.count() <= 0 ? absl::StrCat("not loaded within ", timeout_s, " s")
                                     : "ended before its data was loaded";
    End();
  }
}

KbProcess::~KbProcess() {
  End();
}

void KbProcess::End() {
  if (pid_ <= 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  close(socket_);
  pid_ = -1;
}

void KbProcess::Measure(size_t number, const std::string& mode) {
  if (pid_ <= 0) return;
  const std::string request = absl::StrCat(number, " ", mode, "\n");
  if (send(socket_, request.data(), request.size(), MSG_NOSIGNAL) > 0 && TakeLine()) return;
  End();
}

bool KbProcess::TakeLine() {
  const auto begun = std::chrono::steady_clock::now();
  const auto limit = left_;
  for (;;) {
    for (size_t end; (end = buffer_.find('\n')) != std::string::npos;) {
      const nlohmann::json line = nlohmann::json::parse(buffer_.substr(0, end), nullptr, false);
      buffer_.erase(0, end + 1);
      if (!line.is_object()) continue;
      Take(line, &run_);
      return true;
    }
    left_ = limit - (std::chrono::steady_clock::now() - begun);
    pollfd ready = {socket_, POLLIN, 0};
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(left_).count();
    if (ms <= 0 || poll(&ready, 1, static_cast<int>(ms)) < 0) return false;
    if (ready.revents == 0) continue;
    char bytes[1 << 16];
    const ssize_t size = read(socket_, bytes, sizeof(bytes));
    if (size <= 0) return false;
    buffer_.append(bytes, static_cast<size_t>(size));
  }
}

}  // namespace docent::bench
