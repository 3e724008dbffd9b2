#include "bench/load_bench.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "bench/command_line.h"
#include "bench/kb/kb_data.h"
#include "bench/kb/kb_process.h"
#include "bench/measurement.h"
#include "bench/server_process.h"
#include "kb_server/cli/part_loader.h"

namespace docent::bench {
namespace {

struct Arguments {
  bool json = false;
  std::vector<size_t> triples = {100000, 1000000};
  int runs = 3;
  std::string folder = ".";
  uint64_t seed = 1;
};

struct Figures {
  std::vector<double> check, load, server_cpu;
};

bool LoadOnce(const std::string& text, const std::string& folder, Figures* figures) {
  auto server = ServerProcess::Start(folder);
  if (!server.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", std::string(server.status().message()).c_str());
    return false;
  }
  auto channel = grpc::CreateChannel((*server)->grpc_address(), grpc::InsecureChannelCredentials());
  if (!channel->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(10))) return false;
  const double cpu_before = (*server)->CpuSeconds();
  const auto start = std::chrono::steady_clock::now();
  const auto document = server::CutDocument(text, RdfFormat::kNTriples, "data.nt");
  const double checked_s = SecondsSince(start);
  v1::LoadRequest request;
  request.set_name("data.nt");
  const server::PartsOutcome outcome = server::LoadParts(channel, *document, request, [](size_t) {});
  if (!outcome.status.ok() || outcome.parts != document->parts.size()) {
    std::fprintf(stderr, "docent-bench: %s (%zu of %zu parts)\n", outcome.status.error_message().c_str(),
                 outcome.parts, document->parts.size());
    return false;
  }
  const double statements = static_cast<double>(document->statements);
  figures->check.push_back(statements / checked_s);
  figures->load.push_back(statements / SecondsSince(start));
  figures->server_cpu.push_back(((*server)->CpuSeconds() - cpu_before) / statements * 1e6);
  return true;
}

}  // namespace

int RunLoadBench(const std::vector<std::string>& args) {
  CLI::App app{"N-Triples into a running server, durable, as `docent load` does it", "docent-bench load"};
  Arguments arguments;
  app.add_flag("--json", arguments.json, "One JSON object a line");
  app.add_option("--triples", arguments.triples, "Sizes of the file")->capture_default_str()->delimiter(',');
  app.add_option("--runs", arguments.runs, "Runs, each into an empty server; the median is reported")
      ->capture_default_str();
  app.add_option("--folder", arguments.folder, "Where the durable log is made")->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the data")->capture_default_str();
  if (std::optional<int> code = Parse(&app, args)) return *code;
  std::vector<Measurement> out;
  for (const size_t triples : arguments.triples) {
    const std::string file =
        std::filesystem::temp_directory_path() / absl::StrCat("docent-load-", getpid(), ".nt");
    const absl::StatusOr<KbCounts> counts = WriteKbData(file, triples, arguments.seed);
    if (!counts.ok()) {
      std::fprintf(stderr, "docent-bench: %s\n", std::string(counts.status().message()).c_str());
      return 2;
    }
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::filesystem::remove(file);
    Figures figures;
    for (int run = 0; run < arguments.runs; ++run) {
      if (!LoadOnce(text.str(), arguments.folder, &figures)) return 2;
    }
    const std::string name = absl::StrCat(counts->triples, " triples");
    out.push_back({"load", name, "docent", "check and load, durable", "triples/s", figures.load, ""});
    out.push_back(
        {"load", name, "docent", "of it the check before anything is sent", "triples/s", figures.check, ""});
    out.push_back({"load", name, "docent", "CPU time of the server", "us/triple", figures.server_cpu, ""});
  }
  Print(out, arguments.json);
  return 0;
}

}  // namespace docent::bench
