#include "bench/kb_systems.h"

#include <stdio.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>
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
  systems.push_back({"SWI-Prolog semweb", absl::StrCat("swipl ", Quoted(scripts + "/semweb.pl")), ""});
  if (!Succeeds("swipl --version")) systems.back().missing = "not installed: swi-prolog-nox";
  systems.push_back({"rdflib", absl::StrCat("/usr/bin/python3 ", Quoted(scripts + "/rdflib_peer.py")), ""});
  if (!Succeeds("/usr/bin/python3 -c 'import rdflib'"))
    systems.back().missing = "not installed: python3-rdflib";
  return systems;
}

KbRun RunKbSystem(const KbSystem& system, const std::string& job_file, int timeout_s) {
  KbRun run;
  run.reason = system.missing;
  if (!run.reason.empty()) return run;
  const std::string command = absl::StrCat("timeout -k 2 ", timeout_s, " env ", system.command, " ",
                                           Quoted(job_file), " 2>/dev/null");
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    run.reason = "cannot be started";
    return run;
  }
  char* text = nullptr;
  size_t size = 0;
  while (getline(&text, &size, pipe) > 0) {
    const nlohmann::json line = nlohmann::json::parse(text, nullptr, false);
    if (!line.is_discarded()) Take(line, &run);
  }
  free(text);
  const int code = pclose(pipe);
  if (run.load_s == 0) {
    run.reason = code == 124 << 8 ? absl::StrCat("not loaded within ", timeout_s, " s")
                                  : "ended before its data was loaded";
  }
  return run;
}

}  // namespace docent::bench
