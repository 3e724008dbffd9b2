// Reader of the manifests of the W3C SPARQL test suites (github.com/w3c/rdf-tests).
#ifndef DOCENT_TESTS_CONFORMANCE_SPARQL_W3C_MANIFEST_H_
#define DOCENT_TESTS_CONFORMANCE_SPARQL_W3C_MANIFEST_H_

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

struct W3cQueryTest {
  enum class Kind { kEvaluation, kPositiveSyntax, kNegativeSyntax };
  Kind kind = Kind::kEvaluation;
  std::string name;                                        // folder/name-of-the-entry
  std::string query;                                       // files below are IRIs beneath kBase
  std::vector<std::string> data;                           // default graph
  std::vector<std::pair<std::string, std::string>> named;  // graph IRI, file
  std::string result;
  std::vector<std::pair<std::string, std::string>> services;  // endpoint IRI, the file that it serves
  bool lax = false;  // REDUCED: the number of equal solutions is ignored
};

// An update test: a request, and the graph store before and after it.
struct W3cUpdateTest {
  enum class Kind { kEvaluation, kPositiveSyntax, kNegativeSyntax };
  struct State {
    std::vector<std::string> data;                           // default graph
    std::vector<std::pair<std::string, std::string>> named;  // graph IRI, file
  };
  Kind kind = Kind::kEvaluation;
  std::string name;
  std::string request;
  State before, after;
};

inline constexpr char kW3cBase[] = "http://w3c.test/";

// $DOCENT_W3C_TESTS, else beside the source tree; may not exist.
std::filesystem::path W3cRoot();
// The file of an IRI beneath kW3cBase.
std::filesystem::path W3cFile(const std::string& iri);
std::string ReadText(const std::filesystem::path& path);
// "kind" of "http://…#kind".
std::string LocalName(const std::string& iri);

// RDF by subject and predicate.
class ManifestGraph {
 public:
  explicit ManifestGraph(const std::vector<TermQuad>& quads) {
    for (const TermQuad& q : quads) values_[{Key(q.subject), q.predicate.lexical}].push_back(q.object);
  }
  std::vector<Term> All(const Term& subject, const std::string& predicate) const {
    const auto it = values_.find({Key(subject), predicate});
    return it == values_.end() ? std::vector<Term>() : it->second;
  }
  Term One(const Term& subject, const std::string& predicate) const {
    const std::vector<Term> all = All(subject, predicate);
    return all.empty() ? Term{} : all[0];
  }
  std::vector<Term> List(Term cell) const {
    std::vector<Term> out;
    const std::string rdf(kRdfNs);
    while (!cell.lexical.empty() && cell.lexical != rdf + "nil") {
      out.push_back(One(cell, rdf + "first"));
      cell = One(cell, rdf + "rest");
    }
    return out;
  }
  Term WithType(const std::string& type) const {
    for (const auto& [key, objects] : values_) {
      if (key.second != kRdfType) continue;
      for (const Term& o : objects) {
        if (o.lexical == type)
          return key.first[0] == '_' ? Term::Blank(key.first.substr(1)) : Term::Iri(key.first);
      }
    }
    return Term{};
  }

 private:
  static std::string Key(const Term& t) { return t.IsBlank() ? "_" + t.lexical : t.lexical; }
  std::map<std::pair<std::string, std::string>, std::vector<Term>> values_;
};

// A manifest file and its entries.
struct Manifest {
  explicit Manifest(const std::string& iri);
  // The local names of an entry's types.
  std::vector<std::string> Types(const Term& entry) const;
  static std::vector<TermQuad> Quads(const std::string& iri);

  ManifestGraph graph;
  std::vector<Term> entries;
};

// The query and update tests of a folder such as "sparql11/aggregates", in manifest order. Other tests are
// left out.
std::vector<W3cQueryTest> ReadQueryManifest(const std::string& folder);
std::vector<W3cUpdateTest> ReadUpdateManifest(const std::string& folder);

}  // namespace docent

#endif  // DOCENT_TESTS_CONFORMANCE_SPARQL_W3C_MANIFEST_H_
