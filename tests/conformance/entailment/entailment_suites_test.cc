// The W3C suites of entailment: SPARQL 1.1 entailment regimes (RDF, RDFS, and the part of OWL in the RL
// profile), and RDF semantics (rdf-mt). Found like the other suites; skipped if absent. A regime is a rule
// set here: RDF and RDFS `rdfs`, OWL `owl2rl`. ../known_failures.txt gives the reason of each failure.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/conformance/sparql/result_files.h"
#include "tests/conformance/sparql/suite_support.h"
#include "tests/conformance/sparql/w3c_manifest.h"

namespace docent {
namespace {

constexpr char kMf[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#";
constexpr char kQt[] = "http://www.w3.org/2001/sw/DataAccess/tests/test-query#";
constexpr char kSd[] = "http://www.w3.org/ns/sparql-service-description#";

// The suites of RDF are in the folder beside those of SPARQL, to which kW3cBase leads.
std::string TextOf(const std::string& iri) {
  const std::string rdf = absl::StrCat(kW3cBase, "rdf/");
  return ReadText(
      W3cFile(iri.starts_with(rdf) ? absl::StrCat(kW3cBase, "../rdf/", iri.substr(rdf.size())) : iri));
}

// Documents with all facts that the rules derive from them.
class ReasonedStore {
 public:
  void Load(const std::string& iri) {
    ParseRdfOptions options;
    options.base_iri = iri;
    options.blank_node_scope = absl::StrCat("d", ++documents_);
    const std::string text = TextOf(iri);
    const ParsedRdf parsed = ParseRdf(text, *FormatOfFile(iri), options);
    EXPECT_TRUE(parsed.ok()) << iri << "\n" << Render(parsed.diagnostics, text);
    const TermId graph = dictionary.InternIri(kDefaultGraph);
    for (const TermQuad& q : parsed.quads) {
      const Quad quad = {dictionary.Intern(q.subject), dictionary.Intern(q.predicate),
                         dictionary.Intern(q.object), graph};
      told_.push_back(quad);
      vocabulary.insert({quad.subject, quad.predicate, quad.object});
    }
  }
  absl::Status Reason(const std::string& rule_set) {
    if (!rule_set.empty() && HasErrors(engine_.PutRules(rule_set, rules::BuiltInRuleSet(rule_set))))
      return absl::InternalError("the rule set is refused");
    return engine_.Update(writer_, writer_.Apply(told_, {})).status();
  }
  const GraphVersion& graph() const { return writer_.current(); }

  Dictionary dictionary;
  std::set<TermId> vocabulary;  // of the documents

 private:
  GraphWriter writer_{nullptr};
  rules::RuleEngine engine_{dictionary};
  std::vector<Quad> told_;
  int documents_ = 0;
};

struct RegimeTest {
  std::string name;
  std::string query, data, result;
  std::string rule_set;
};

std::vector<RegimeTest> RegimeTests() {
  const std::string folder = absl::StrCat(kW3cBase, "sparql11/entailment/");
  const Manifest manifest(folder + "manifest.ttl");
  std::vector<RegimeTest> tests;
  for (const Term& entry : manifest.entries) {
    const auto& graph = manifest.graph;
    const Term action = graph.One(entry, std::string(kMf) + "action");
    std::set<std::string> regimes, profiles;
    const auto read = [&](const std::string& property, std::set<std::string>& into) {
      for (const Term& value : graph.All(action, property)) {
        if (!value.IsBlank()) into.insert(LocalName(value.lexical));
        for (const Term& item : graph.List(value)) into.insert(LocalName(item.lexical));
      }
    };
    read(std::string(kSd) + "entailmentRegime", regimes);
    read(std::string(kSd) + "EntailmentProfile", profiles);
    const auto add = [&](const char* regime, const char* rule_set) {
      tests.push_back({absl::StrCat("entailment/", LocalName(entry.lexical), ":", regime),
                       graph.One(action, std::string(kQt) + "query").lexical,
                       graph.One(action, std::string(kQt) + "data").lexical,
                       graph.One(entry, std::string(kMf) + "result").lexical, rule_set});
    };
    const auto has = [](const std::set<std::string>& set, const char* one) {
      return std::any_of(set.begin(), set.end(), [&](const std::string& s) { return s.ends_with(one); });
    };
    if (has(regimes, "/RDF") || has(regimes, "=RDF") || regimes.contains("RDF")) add("RDF", "rdfs");
    if (has(regimes, "RDFS")) add("RDFS", "rdfs");
    if ((has(regimes, "OWL-RDF-Based") || has(regimes, "OWL-Direct")) && has(profiles, "RL"))
      add("OWL-RL", "owl2rl");
  }
  return tests;
}

// Empty if the test passes, else why not.
std::string RunRegime(const RegimeTest& test) {
  const std::string text = ReadText(W3cFile(test.query));
  sparql::ParseOptions options;
  options.base_iri = test.query;
  sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  if (!parsed.ok()) return Render(parsed.diagnostics, text);
  ReasonedStore store;
  store.Load(test.data);
  if (absl::Status status = store.Reason(test.rule_set); !status.ok()) return std::string(status.message());
  auto prepared = sparql::PreparedQuery::Prepare(parsed.query, store.dictionary);
  if (!prepared.ok()) return std::string(prepared.status().message());
  Answer answer;
  answer.variables = (*prepared)->variables();
  if (parsed.query.form == sparql::Query::Form::kAsk) {
    answer.boolean = *(*prepared)->Ask({.version = &store.graph()});
  } else {
    const absl::Status status =
        (*prepared)->Select({.version = &store.graph()}, {}, [&](absl::Span<const TermId> row) {
          std::map<std::string, Term> terms;
          for (size_t i = 0; i < row.size(); ++i) {
            if (row[i].IsNone()) continue;
            // SPARQL 1.1 Entailment Regimes, condition C2: answers consist of terms of the queried
            // graph.
            if (row[i].InDictionary() && !store.vocabulary.contains(row[i])) return true;
            terms[answer.variables[i]] = (*prepared)->Decode(row[i]);
          }
          answer.rows.push_back(std::move(terms));
          return true;
        });
    if (!status.ok()) return std::string(status.message());
  }
  const Answer expected = ReadXmlResult(ReadText(W3cFile(test.result)));
  return SameAnswer(expected, answer, /*lax=*/false)
             ? ""
             : "got\n" + ToText(answer) + "expected\n" + ToText(expected);
}

TEST(EntailmentSuites, SparqlRegimes) {
  if (!std::filesystem::exists(W3cRoot())) GTEST_SKIP() << "set DOCENT_W3C_TESTS to a clone of w3c/rdf-tests";
  std::map<std::string, std::vector<RegimeTest>> by_regime;
  for (const RegimeTest& test : RegimeTests())
    by_regime[test.name.substr(test.name.find(':') + 1)].push_back(test);
  for (const auto& [regime, tests] : by_regime) RunSuite("entailment-" + regime, tests, RunRegime);
}

struct SemanticsTest {
  std::string name;
  bool positive = true;
  std::string regime;
  std::string premise, conclusion;  // conclusion empty: inconsistency
  bool datatypes = false;           // some are to be recognised
};

std::vector<SemanticsTest> SemanticsTests() {
  const Manifest manifest(absl::StrCat(kW3cBase, "../rdf/rdf11/rdf-mt/manifest.ttl"));
  std::vector<SemanticsTest> tests;
  for (const Term& entry : manifest.entries) {
    SemanticsTest test;
    test.name = "rdf-mt/" + LocalName(entry.lexical);
    for (const std::string& type : manifest.Types(entry))
      test.positive = test.positive && type != "NegativeEntailmentTest";
    test.regime = manifest.graph.One(entry, std::string(kMf) + "entailmentRegime").lexical;
    test.premise = manifest.graph.One(entry, std::string(kMf) + "action").lexical;
    const Term result = manifest.graph.One(entry, std::string(kMf) + "result");
    if (!result.IsLiteral()) test.conclusion = result.lexical;
    tests.push_back(std::move(test));
  }
  return tests;
}

// Whether `graph` holds the document with its blank nodes as variables.
absl::StatusOr<bool> Entails(ReasonedStore& store, const std::string& document) {
  const std::string text = TextOf(document);
  ParseRdfOptions options;
  options.base_iri = document;
  const ParsedRdf parsed = ParseRdf(text, *FormatOfFile(document), options);
  if (!parsed.ok()) return absl::InvalidArgumentError(Render(parsed.diagnostics, text));
  const auto word = [](const Term& t) { return t.IsBlank() ? "?b" + t.lexical : ToNTriples(t); };
  std::string query = "ASK {";
  for (const TermQuad& q : parsed.quads) {
    absl::StrAppend(&query, " ", word(q.subject), " ", word(q.predicate), " ", word(q.object), " .");
  }
  const sparql::ParsedQuery ask = sparql::ParseQuery(query + " }");
  if (!ask.ok()) return absl::InvalidArgumentError(Render(ask.diagnostics, query));
  auto prepared = sparql::PreparedQuery::Prepare(ask.query, store.dictionary);
  if (!prepared.ok()) return prepared.status();
  return (*prepared)->Ask({.version = &store.graph()});
}

std::string RunSemantics(const SemanticsTest& test) {
  ReasonedStore store;
  store.Load(test.premise);
  if (absl::Status status = store.Reason(test.regime == "simple" ? "" : "rdfs"); !status.ok())
    return std::string(status.message());
  bool entailed = false;
  if (test.conclusion.empty()) {
    entailed =
        store.graph()
            .Scan({TermId(), TermId(), store.dictionary.InternIri(DocentIri("Inconsistency")), TermId()})
            .Valid();
  } else {
    const auto holds = Entails(store, test.conclusion);
    if (!holds.ok()) return std::string(holds.status().message());
    entailed = *holds;
  }
  if (entailed == test.positive) return "";
  return entailed ? "follows, but should not" : "does not follow";
}

TEST(EntailmentSuites, RdfSemantics) {
  if (!std::filesystem::exists(W3cRoot())) GTEST_SKIP() << "set DOCENT_W3C_TESTS to a clone of w3c/rdf-tests";
  RunSuite("rdf-mt", SemanticsTests(), RunSemantics);
}

}  // namespace
}  // namespace docent
