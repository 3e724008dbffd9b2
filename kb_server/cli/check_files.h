// RDF, rules and queries as `docent check` looks at them: each file by itself, its words against the vocabulary of all.
// One thread.
#ifndef DOCENT_KB_SERVER_CLI_CHECK_FILES_H_
#define DOCENT_KB_SERVER_CLI_CHECK_FILES_H_

#include <map>
#include <set>
#include <string>
#include <vector>

#include "graph/base/check_limits.h"
#include "graph/base/memory_budget.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/rdf/iri_names.h"
#include "graph/sparql/values/function_registry.h"
#include "kb_server/cli/consistency_check.h"
#include "kb_server/cli/rehearsal/load_rehearsal.h"
#include "reasoner/ontology/finding.h"
#include "reasoner/ontology/vocabulary.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/shacl_rules_import.h"
#include "reasoner/shapes/file_graph.h"

namespace docent::server {

class FileChecker {
 public:
  explicit FileChecker(const CheckLimits& limits = {});

  // An RDF document that is to be checked, or (`only_words`) whose words the others may use. All are added before the
  // first is checked.
  // Gives what its reader says; more than the limit check_memory_bytes is an error.
  Diagnostics AddRdf(const std::string& file, const RdfText& rdf, bool only_words);
  // Of a document that was added to be checked: none where it has syntax errors.
  const std::vector<TermQuad>& QuadsOf(const std::string& file) { return documents_[file].rdf.quads; }
  // Rules that the others are to be consistent with; likewise before the first is checked.
  void AddRules(const std::string& file, const std::string& text);

  // What is wrong with an RDF document that was added; with a `.rules` text, beside those that were checked before and had
  // no errors, as a server would say that has them; with a query. Syntax errors have the rule "syntax", and hide all others.
  std::vector<ontology::Finding> CheckRdf(const std::string& file);
  std::vector<ontology::Finding> CheckRules(const std::string& file, const std::string& text);
  std::vector<ontology::Finding> CheckQuery(const std::string& file, const std::string& text);

  // Loads a workflow or an RSEL document after the RDF documents, the rules and the documents of earlier calls, and gives
  // the server's error, if it has one, as a finding. The document's name is the file's.
  std::vector<ontology::Finding> Rehearse(const Document& document);

  // By the prefixes of the RDF documents that were added, in their order.
  const IriNames& names() const { return names_; }
  const sparql::FunctionRegistry& functions() const { return functions_; }

 private:
  // The shapes of all documents, read once; each finding with its file.
  void CheckShapes();
  // The rules of the file's shapes: their mistakes, and the words of their queries.
  void CheckImported(const std::string& file, ontology::Findings& findings);
  // Loads facts beside those of the documents before, up to the limit check_facts.
  void RehearseData(const std::string& file, const std::vector<TermQuad>& quads);
  // Why a server refuses to load the file, unless the findings have an error already. `text`: of rules, else empty.
  void AddRefusal(const std::string& file, const std::string& text, ontology::Findings& findings) const;
  // The inconsistencies of all, looked for once, into the findings of the file.
  void AddInconsistencies(const std::string& file, ontology::Findings& findings);

  const CheckLimits limits_;
  sparql::FunctionRegistry functions_;  // that a server has
  Dictionary dictionary_;
  rules::RuleEngine rules_{dictionary_, {}, &functions_};
  ontology::Vocabulary vocabulary_;
  IriNames names_ = IriNames::WellKnown();
  MemoryUse memory_{limits_.check_memory_bytes};  // of documents_
  std::map<std::string, LocatedRdf> documents_;
  std::set<std::string> cycles_;
  shapes::FileGraph graph_;
  bool shapes_read_ = false;
  std::map<std::string, Diagnostics> of_shapes_;          // by file
  std::map<std::string, rules::ImportedRules> imported_;  // the rules of shapes (sh:SPARQLRule), by file
  size_t texts_ = 0;                                      // that were added: each has blank nodes of its own
  ConsistencyCheck consistency_{limits_, &functions_};
  bool consistency_checked_ = false;
  LoadRehearsal rehearsal_{&functions_};
  std::map<std::string, absl::Status> refused_;  // by file: what a server says to a load of it
  std::map<std::string, std::vector<ConsistencyCheck::Result>> inconsistencies_;  // by file
};

// Diagnostics by their own rules, those that have none under `rule`.
std::vector<ontology::Finding> AsFindings(const std::string& rule, const Diagnostics& diagnostics);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_CHECK_FILES_H_
