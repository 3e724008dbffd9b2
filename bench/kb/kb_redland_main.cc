// docent_kb_redland JOB.json: stock librdf with its `trees` storage and Rasqal, as a measured system of
// `docent-bench kb`. For the output see bench/kb/kb_docent_main.cc. Rasqal cannot be cancelled: each case
// runs in a child process, which is killed if the case takes too long.
#include <redland.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "absl/strings/str_replace.h"
#include "bench/kb/kb_process.h"

namespace {

using docent::bench::ResidentBytes;
using docent::bench::SecondsSince;
using nlohmann::json;
using SteadyClock = std::chrono::steady_clock;

constexpr unsigned kCaseLimitS = 4;

int Quiet(void*, librdf_log_message*) {
  return 1;
}

struct Redland {
  librdf_world* world = librdf_new_world();
  librdf_storage* storage = nullptr;
  librdf_model* model = nullptr;

  Redland() {
    librdf_world_open(world);
    librdf_world_set_logger(world, nullptr, Quiet);
    storage = librdf_new_storage(world, "trees", "bench", nullptr);
    model = librdf_new_model(world, storage, nullptr);
  }

  bool Load(const std::string& file) {
    librdf_parser* parser = librdf_new_parser(world, "ntriples", nullptr, nullptr);
    librdf_uri* uri = librdf_new_uri_from_filename(world, file.c_str());
    const bool ok = librdf_parser_parse_into_model(parser, uri, uri, model) == 0;
    librdf_free_uri(uri);
    librdf_free_parser(parser);
    return ok;
  }

  // The rows (or the count, or 0 and 1); -1: refused.
  int64_t Run(const std::string& text, const std::string& form) {
    librdf_query* query = librdf_new_query(world, "sparql11-query", nullptr,
                                           reinterpret_cast<const unsigned char*>(text.c_str()), nullptr);
    librdf_query_results* results = query == nullptr ? nullptr : librdf_model_query_execute(model, query);
    int64_t answer = -1;
    if (results != nullptr && form == "ask") {
      answer = librdf_query_results_get_boolean(results) > 0 ? 1 : 0;
    } else if (results != nullptr) {
      answer = 0;
      const int columns = librdf_query_results_get_bindings_count(results);
      for (; !librdf_query_results_finished(results); librdf_query_results_next(results)) {
        ++answer;
        for (int i = 0; i < columns; ++i) {
          librdf_node* node = librdf_query_results_get_binding_value(results, i);
          if (node == nullptr) continue;
          if (form == "count")
            answer = std::atoll(reinterpret_cast<const char*>(librdf_node_get_literal_value(node)));
          librdf_free_node(node);
        }
      }
    }
    if (results != nullptr) librdf_free_query_results(results);
    if (query != nullptr) librdf_free_query(query);
    return answer;
  }
};

void Print(const json& line) {
  std::cout << line.dump() << std::endl;
}

void Measure(Redland& redland, const json& job, size_t number) {
  const json& c = job["cases"][number];
  const std::string form = c["form"];
  std::vector<std::string> texts;
  for (const std::string value : c["parameters"]) {
    texts.push_back(absl::StrReplaceAll(c["text"].get<std::string>(), {{"@P@", value}}));
  }
  const double budget_s = job["budget_ms"].get<double>() / 1000;
  json answers = json::array(), passes = json::array();
  if (redland.Run(texts[0], form) < 0) {  // also makes the memory this process's own
    Print({{"case", number}, {"mode", "cold"}, {"reason", "Rasqal refuses the query"}});
    return;
  }
  const auto begun = SteadyClock::now();
  for (int pass = 0; pass < job["passes"] && (pass == 0 || SecondsSince(begun) < budget_s); ++pass) {
    json us = json::array();
    for (size_t i = 0; i < texts.size() && (i == 0 || SecondsSince(begun) < budget_s); ++i) {
      const auto start = SteadyClock::now();
      const int64_t answer = redland.Run(texts[i], form);
      us.push_back(SecondsSince(start) * 1e6);
      if (pass == 0) answers.push_back(answer);
    }
    if (pass == 0 || us.size() == passes[0].size()) passes.push_back(std::move(us));
  }
  Print({{"case", number}, {"mode", "cold"}, {"answers", answers}, {"us", passes}});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: docent_kb_redland JOB.json\n";
    return 2;
  }
  const json job = json::parse(std::ifstream(argv[1]));
  const size_t before = ResidentBytes();
  const auto start = SteadyClock::now();
  Redland redland;
  if (!redland.Load(job["data"])) {
    std::cerr << "librdf cannot load the data\n";
    return 2;
  }
  Print({{"load_s", SecondsSince(start)}, {"bytes", ResidentBytes() - before}});
  std::string mode;
  for (size_t number = 0; std::cin >> number >> mode;) {
    const pid_t child = fork();
    if (child == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      alarm(kCaseLimitS);  // its default action ends the child
      Measure(redland, job, number);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      const bool late = WTERMSIG(status) == SIGALRM;
      Print({{"case", number},
             {"mode", "cold"},
             {"reason", late ? "longer than " + std::to_string(kCaseLimitS) + " s" : "Rasqal crashed"}});
    }
  }
  return 0;
}
