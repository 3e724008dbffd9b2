// docent_kb_docent JOB.json: Docent's store and SPARQL engine as one of the measured systems of
// `docent-bench kb`. Like every peer it loads the job's data, then runs the requested cases, a
// line each on standard input (the case's number, a space, "cold" or "prepared"), until the
// input ends. It prints one JSON object a line, one when the data are loaded and one for each
// request:
//   {"load_s": seconds, "bytes": growth of resident memory, "index_bytes", "dictionary_bytes"}
//   {"case": number, "mode": "cold" | "prepared", "answers": [rows of each instance],
//    "us": [[latency of each instance] a pass]}
//   {"case": number, "mode": …, "reason": why there is no figure}
// cold: text → parse → plan → run; rows are decoded to terms. Nothing is cached between runs.
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "absl/strings/match.h"
#include "absl/strings/str_replace.h"
#include "bench/kb/kb_process.h"
#include "graph/base/program_setup.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/bulk_loader.h"
#include "graph/store/graph_writer.h"

namespace docent::bench {
namespace {

using nlohmann::json;
using SteadyClock = std::chrono::steady_clock;

class Engine {
 public:
  void Load(const std::string& file) {
    const size_t before = ResidentBytes();
    const auto start = SteadyClock::now();
    {
      std::ostringstream text;
      text << std::ifstream(file).rdbuf();
      ParseRdfOptions options;
      options.limits.document_bytes = ~size_t{0};
      BulkLoader loader(dictionary_);
      loader.Add(std::move(text).str(), RdfFormat::kNTriples, options);
      GraphWriter writer(nullptr);
      loader.Build(writer);
      version_ = writer.Freeze(Revision(1));
    }
    const double load_s = SecondsSince(start);
    Print({{"load_s", load_s},
           {"bytes", SettledResidentBytes() - before},
           {"index_bytes", version_->bytes()},
           {"dictionary_bytes", dictionary_.bytes()}});
  }

  // Runs one instance from its text; the number of rows, or -1 with `reason`.
  int64_t Cold(const std::string& text, bool ask, std::string* reason) {
    sparql::ParsedQuery parsed = sparql::ParseQuery(text);
    if (!parsed.ok()) return Failed(Render(parsed.diagnostics, text), reason);
    auto query = sparql::PreparedQuery::Prepare(std::move(parsed.query), dictionary_);
    if (!query.ok()) return Failed(query.status().ToString(), reason);
    return Run(**query, {}, ask, reason);
  }

  std::unique_ptr<sparql::PreparedQuery> Prepare(const json& c) {
    const std::string text =
        absl::StrReplaceAll(c["text"].get<std::string>(), {{"<http://bench.example/@P@>", "?parameter"}});
    if (absl::StrContains(text, "@P@")) return nullptr;  // inside a longer text: not a term to bind
    const sparql::ParsedQuery parsed = sparql::ParseQuery(text);
    sparql::PrepareOptions options;
    if (text != c["text"]) options.bound = {"parameter"};
    auto query = sparql::PreparedQuery::Prepare(parsed.query, dictionary_, options);
    return query.ok() ? *std::move(query) : nullptr;
  }

  int64_t Run(sparql::PreparedQuery& query, absl::Span<const TermId> bound, bool ask, std::string* reason) {
    Cancellation cancellation(std::chrono::milliseconds(20000));
    const sparql::RunOptions run = {version_.get(), &cancellation, 0, 0};
    int64_t rows = 0;
    if (ask) {
      const auto holds = query.Ask(run, bound);
      return holds.ok() ? (*holds ? 1 : 0) : Failed(holds.status().ToString(), reason);
    }
    Term term;
    const absl::Status status = query.Select(run, bound, [&](absl::Span<const TermId> row) {
      for (const TermId id : row) {
        if (id.IsNone()) continue;
        query.DecodeTo(id, &term);
        sink_ += term.lexical.size();
        if (rows == 0 && term.datatype == kXsdInteger) last_ = std::atoll(term.lexical.c_str());
      }
      ++rows;
      return true;
    });
    return status.ok() ? rows : Failed(status.ToString(), reason);
  }
  // The integer in the first row of the last answer.
  int64_t last() const { return last_; }
  const Dictionary& dictionary() const { return dictionary_; }

  static void Print(const json& line) { std::cout << line.dump() << std::endl; }

 private:
  static int64_t Failed(std::string text, std::string* reason) {
    *reason = std::move(text);
    return -1;
  }

  Dictionary dictionary_;
  GraphVersionPtr version_;
  size_t sink_ = 0;
  int64_t last_ = 0;
};

// After one unmeasured run, passes over the instances until the budget is spent, at most the job's "passes";
// a first pass may end early.
template <typename RunOne>  // int64_t RunOne(size_t instance, std::string* reason)
void Measure(const json& job, size_t number, const char* mode, RunOne run_one) {
  const json& c = job["cases"][number];
  const size_t instances = c["parameters"].size();
  const double budget_s = job["budget_ms"].get<double>() / 1000;
  json answers = json::array(), passes = json::array();
  std::string reason;
  if (run_one(0, &reason) < 0) {
    Engine::Print({{"case", number}, {"mode", mode}, {"reason", reason}});
    return;
  }
  const auto begun = SteadyClock::now();
  for (int pass = 0; pass < job["passes"] && (pass == 0 || SecondsSince(begun) < budget_s); ++pass) {
    json us = json::array();
    for (size_t i = 0; i < instances && (i == 0 || SecondsSince(begun) < budget_s); ++i) {
      const auto start = SteadyClock::now();
      const int64_t answer = run_one(i, &reason);
      us.push_back(SecondsSince(start) * 1e6);
      if (pass == 0) answers.push_back(answer);
    }
    if (pass == 0 || us.size() == passes[0].size()) passes.push_back(std::move(us));
  }
  Engine::Print({{"case", number}, {"mode", mode}, {"answers", answers}, {"us", passes}});
}

}  // namespace
}  // namespace docent::bench

int main(int argc, char** argv) {
  using namespace docent::bench;
  if (argc != 2) {
    std::cerr << "usage: docent_kb_docent JOB.json\n";
    return 2;
  }
  const json job = json::parse(std::ifstream(argv[1]));
  Engine engine;
  engine.Load(job["data"]);
  std::string mode;
  for (size_t number = 0; std::cin >> number >> mode;) {
    const json& c = job["cases"][number];
    const bool ask = c["form"] == "ask", count = c["form"] == "count";
    std::vector<std::string> texts;
    std::vector<docent::Term> values;
    for (const std::string value : c["parameters"]) {
      texts.push_back(absl::StrReplaceAll(c["text"].get<std::string>(), {{"@P@", value}}));
      values.push_back(docent::Term::Iri("http://bench.example/" + value));
    }
    const auto answer = [&](int64_t rows) { return count && rows >= 0 ? engine.last() : rows; };
    if (mode == "cold") {
      Measure(job, number, "cold",
              [&](size_t i, std::string* reason) { return answer(engine.Cold(texts[i], ask, reason)); });
      continue;
    }
    const auto query = engine.Prepare(c);
    const bool bound = texts[0] != c["text"];
    Measure(job, number, "prepared", [&](size_t i, std::string* reason) -> int64_t {
      if (query == nullptr) {
        *reason = "its parameter is no term, or it is refused";
        return -1;
      }
      if (!bound) return answer(engine.Run(*query, {}, ask, reason));
      const docent::TermId value = query->Encode(values[i]);
      return answer(engine.Run(*query, {value}, ask, reason));
    });
  }
  return 0;
}
