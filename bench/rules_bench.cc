#include "bench/rules_bench.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/command_line.h"
#include "bench/measurement.h"
#include "bench/rules_peers.h"
#include "bench/worlds/university_data.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/bulk_loader.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"

namespace docent::bench {
namespace {

using Clock = std::chrono::steady_clock;

// The rules that the peers compute as well: ten rules of the tables, with the ontology as data.
constexpr char kTenRules[] = R"rules(
RULE { ?c1 rdfs:subClassOf ?c3 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?c2 rdfs:subClassOf ?c3 }
RULE { ?x a ?c2 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?x a ?c1 }
RULE { ?p1 rdfs:subPropertyOf ?p3 } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?p2 rdfs:subPropertyOf ?p3 }
RULE { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y }
RULE { ?x a ?c } WHERE { ?p rdfs:domain ?c . ?x ?p ?y }
RULE { ?y a ?c } WHERE { ?p rdfs:range ?c . ?x ?p ?y }
RULE { ?x ?p ?z } WHERE { ?p a owl:TransitiveProperty . ?x ?p ?y . ?y ?p ?z }
RULE { ?y ?p ?x } WHERE { ?p a owl:SymmetricProperty . ?x ?p ?y }
RULE { ?y ?p2 ?x } WHERE { ?p1 owl:inverseOf ?p2 . ?x ?p1 ?y }
RULE { ?y ?p1 ?x } WHERE { ?p1 owl:inverseOf ?p2 . ?x ?p2 ?y }
)rules";

double Micros(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

std::string IriOf(const std::string& name) {
  if (name == "type") return std::string(kRdfType);
  for (const char* word : {"subClassOf", "subPropertyOf", "domain", "range"}) {
    if (name == word) return absl::StrCat(std::string(kRdfsNs), name);
  }
  if (name == "inverseOf" || name == "TransitiveProperty") return absl::StrCat(std::string(kOwlNs), name);
  return absl::StrCat(kUniversityNs, name);
}

class University {
 public:
  explicit University(size_t facts) {
    const TripleSink sink = [this](const std::string& s, const std::string& p, const std::string& o) {
      quads_.push_back(QuadOf(s, p, o));
    };
    UniversityOntology(sink);
    UniversityFacts(facts, sink);
  }

  Quad QuadOf(const std::string& s, const std::string& p, const std::string& o) {
    return {Named(s), Named(p), Named(o), graph_};
  }
  const std::vector<Quad>& quads() const { return quads_; }
  Dictionary& dictionary() { return dictionary_; }

 private:
  TermId Named(const std::string& name) { return dictionary_.InternIri(IriOf(name)); }

  Dictionary dictionary_;
  const TermId graph_ = dictionary_.InternIri(kDefaultGraph);
  std::vector<Quad> quads_;
};

class RulesBench {
 public:
  RulesBench(std::vector<size_t> sizes, bool peers) : sizes_(std::move(sizes)), peers_(peers) {}

  int Run() {
    for (const size_t size : sizes_) {
      for (const bool all : {false, true}) Measure(size, all);
      if (!peers_) continue;
      MeasureWhole(size);
      for (Measurement& m : MeasureRulePeers(size)) measurements.push_back(std::move(m));
    }
    return missed_ ? 1 : 0;
  }

  std::vector<Measurement> measurements;

 private:
  void Note(const std::string& name, const std::string& metric, const std::string& unit,
            std::vector<double> runs) {
    measurements.push_back({"rules", name, "docent", metric, unit, std::move(runs), ""});
  }
  void Require(bool met) { missed_ = missed_ || !met; }

  // From N-Triples in memory to the closure.
  void MeasureWhole(size_t size) {
    std::string text;
    const TripleSink sink = [&](const std::string& s, const std::string& p, const std::string& o) {
      absl::StrAppend(&text, "<", IriOf(s), "> <", IriOf(p), "> <", IriOf(o), "> .\n");
    };
    UniversityOntology(sink);
    UniversityFacts(size, sink);
    const Clock::time_point start = Clock::now();
    Dictionary dictionary;
    BulkLoader loader(dictionary);
    ParseRdfOptions options;
    options.limits.document_bytes = text.size();
    const Diagnostics mistakes = loader.Add(text, RdfFormat::kNTriples, options);
    GraphWriter writer(nullptr);
    loader.Build(writer);
    rules::RuleEngine engine(dictionary);
    const Diagnostics diagnostics = engine.PutRules("bench", kTenRules);
    const absl::StatusOr<Delta> delta = engine.Update(writer, {});
    const double us = Micros(start);
    if (HasErrors(mistakes) || HasErrors(diagnostics) || !delta.ok()) std::exit(1);
    Note(absl::StrCat(size, " facts, 10 rules"), "file to closure", "facts/s",
         {static_cast<double>(delta->size()) / us * 1e6});
  }

  void Measure(size_t size, bool all_rules) {
    University data(size);
    GraphWriter writer(nullptr);
    writer.AddAll(data.quads());
    rules::RuleEngine engine(data.dictionary());
    const std::string name = absl::StrCat(size, " facts, ", all_rules ? "owl2rl" : "10 rules");
    const Diagnostics diagnostics =
        engine.PutRules("bench", all_rules ? rules::BuiltInRuleSet("owl2rl") : std::string(kTenRules));
    if (HasErrors(diagnostics)) {
      std::fprintf(stderr, "%s", Render(diagnostics, "").c_str());
      std::exit(1);
    }
    writer.Freeze(Revision(1));
    const Clock::time_point start = Clock::now();
    const absl::StatusOr<Delta> delta = engine.Update(writer, {});
    if (!delta.ok()) {
      std::fprintf(stderr, "%s\n", delta.status().ToString().c_str());
      std::exit(1);
    }
    engine.Commit();
    writer.Freeze(Revision(2));
    const double closure_us = Micros(start);
    const double rate = static_cast<double>(delta->size()) / closure_us * 1e6;
    Note(name, "inferred", "facts", {static_cast<double>(delta->size())});
    Note(name, "closure", "ms", {closure_us / 1000});
    Note(name, "closure rate", "facts/s", {rate});
    Require(size < 1000000 || rate >= 500000);
    OneFact(name, size, data, writer, engine);
    Axiom(name, "AssistantProfessor", "Professor", size, data, writer, engine);
    Axiom(name, "GraduateStudent", "Student", size, data, writer, engine);  // each is one by its courses, too
  }

  // A whole turn in memory: store, rules, a version.
  double Turn(GraphWriter& writer, rules::RuleEngine& engine, const std::vector<Quad>& add,
              const std::vector<Quad>& remove) {
    const Clock::time_point start = Clock::now();
    const Delta told = writer.Apply(add, remove);
    const absl::StatusOr<Delta> delta = engine.Update(writer, told);
    engine.Commit();
    version_ = writer.Freeze(Revision(++revision_));
    changed_ = delta.ok() ? delta->size() - told.size() : 0;
    return Micros(start);
  }

  void OneFact(const std::string& name, size_t size, University& data, GraphWriter& writer,
               rules::RuleEngine& engine) {
    constexpr int kFacts = 2000;
    std::vector<double> in, out;
    size_t inferred = 0;
    const uint64_t before = writer.current().size();
    for (int i = 0; i < kFacts; ++i) {
      const Quad fact = data.QuadOf(absl::StrCat("new", i), "headOf", absl::StrCat("u0d", i % 15));
      in.push_back(Turn(writer, engine, {fact}, {}));
      inferred = changed_;
      out.push_back(Turn(writer, engine, {}, {fact}));
    }
    if (writer.current().size() != before) {
      std::fprintf(stderr, "%s: %zu quads before, %zu after adding and retracting\n", name.c_str(),
                   static_cast<size_t>(before), static_cast<size_t>(writer.current().size()));
      missed_ = true;
    }
    Note(name, absl::StrCat("fact in, ", inferred, " inferred"), "us", {Median(in)});
    Note(name, absl::StrCat("fact out, ", inferred, " inferred"), "us", {Median(out)});
    Require(size != 1000000 || (Median(in) < 60 && Median(out) < 60));
    // at most 2.5 times its cost among a hundredth of the facts
    if (size == 10000) small_[name.substr(name.find(','))] = {Median(in), Median(out)};
    const auto small = small_.find(name.substr(name.find(',')));
    if (size != 1000000 || small == small_.end()) return;
    Require(Median(in) <= 2.5 * small->second.first && Median(out) <= 2.5 * small->second.second);
  }

  void Axiom(const std::string& name, const char* subclass, const char* of, size_t size, University& data,
             GraphWriter& writer, rules::RuleEngine& engine) {
    const Quad axiom = data.QuadOf(subclass, "subClassOf", of);
    std::vector<double> in, out;
    size_t gone = 0;
    for (int i = 0; i < 3; ++i) {
      out.push_back(Turn(writer, engine, {}, {axiom}) / 1000);
      gone = changed_;
      in.push_back(Turn(writer, engine, {axiom}, {}) / 1000);
    }
    Note(name, absl::StrCat(subclass, " subclass axiom out, ", gone, " facts go"), "ms", out);
    Note(name, absl::StrCat(subclass, " subclass axiom in again"), "ms", in);
    Require(size > 1000000 || Median(out) < 300);
  }

  const std::vector<size_t> sizes_;
  const bool peers_;
  bool missed_ = false;
  std::map<std::string, std::pair<double, double>> small_;  // microseconds to add and remove a fact, by rules
  uint64_t revision_ = 2;
  size_t changed_ = 0;
  GraphVersionPtr version_;
};

}  // namespace

int RunRulesBench(const std::vector<std::string>& args) {
  bool json = false, peers = true;
  std::vector<size_t> sizes;
  CLI::App app{"Closure, facts and axioms in and out, beside SWI-Prolog and EYE", "docent-bench rules"};
  app.add_flag("--json", json, "One JSON object a line");
  app.add_flag("!--no-peers", peers, "Without the peers");
  app.add_option("FACTS", sizes, "Sizes of the data")
      ->default_str("10000 100000 1000000")
      ->check(CLI::Range(10000, 100000000));
  if (std::optional<int> code = Parse(&app, args)) return *code;
  if (sizes.empty()) sizes = {10000, 100000, 1000000};
  RulesBench bench(sizes, peers);
  const int code = bench.Run();
  Print(bench.measurements, json);
  return code;
}

}  // namespace docent::bench
