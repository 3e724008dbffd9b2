// Do documents and rules contradict each other? They are put into a graph in memory, rule set owl2rl and the given rules
// are followed to their end, and each docent:Inconsistency that comes of it is told at a told fact, with its proof.
// One thread.
#ifndef DOCENT_KB_SERVER_CLI_CONSISTENCY_CHECK_H_
#define DOCENT_KB_SERVER_CLI_CONSISTENCY_CHECK_H_

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "graph/base/cancellation.h"
#include "graph/base/check_limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/graph_version.h"
#include "reasoner/explain/proof.h"
#include "reasoner/explain/rule_text.h"
#include "reasoner/ontology/finding.h"

namespace docent::server {

class ConsistencyCheck {
 public:
  // An inconsistency, as it was proved, or a warning of what was not checked.
  struct Result {
    ontology::Finding finding;
    std::string check;                                    // the short name of its rule: "cax-dw"
    std::vector<std::pair<std::string, QuadPlace>> told;  // the facts that it rests on: file and place
  };

  // `functions` must outlive it.
  ConsistencyCheck(const CheckLimits& limits, const sparql::FunctionRegistry* functions)
      : limits_(limits), functions_(functions) {}

  // All are added before Run. A document that is only background (`findings` false) is not where something is told, if
  // another one will do. Blank nodes of two documents must have different labels.
  void AddDocument(const std::string& file, const LocatedRdf& document, bool findings);
  void AddRules(const std::string& file, const std::string& text, bool findings);

  // By file. Of inconsistencies that rest on the same facts, or on those of another one and more, one is told. Where the
  // limits check_facts, check_consistency_ms, check_inconsistencies are met, a warning ("consistency") says what was not
  // checked; so it does of rules that cannot be followed beside owl2rl.
  std::map<std::string, std::vector<Result>> Run();

 private:
  struct Place {
    size_t file = 0;
    QuadPlace at;
    bool schema = false;  // an axiom, and no fact about a thing
  };
  struct Source {
    std::string file;
    bool findings = false;
  };
  struct Conflict {
    std::string check, rule, proof;
    std::vector<Quad> leaves;  // sorted
  };

  absl::Status Materialise(Cancellation* cancellation, GraphVersionPtr* version);
  void LeaveOut(std::string why);
  void Prove(const GraphVersionPtr& version, Cancellation* cancellation);
  Conflict ToConflict(explain::Proof proof) const;
  void Tell(const Conflict& conflict);
  // At the file, or where that is only background, at the first one that is not.
  void Warn(size_t file, std::string message, std::string hint);
  size_t WithFindings(size_t file) const;

  const CheckLimits limits_;
  const sparql::FunctionRegistry* functions_;
  Dictionary dictionary_;
  std::vector<Source> sources_;
  std::vector<Quad> told_;
  absl::flat_hash_map<Quad, Place>
      places_;  // where a fact was told first; of documents with findings, if any
  std::vector<std::pair<std::string, std::string>> prefixes_;
  std::vector<std::pair<size_t, explain::RuleText>> rules_;  // given ones, with their source
  std::set<size_t> left_out_;                                // of rules_: those that cannot be followed
  std::vector<explain::RuleText> followed_;                  // those that the graph follows
  absl::flat_hash_map<std::string, std::pair<size_t, SourceSpan>> rule_places_;  // by label
  std::map<std::string, std::vector<Result>> results_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_CONSISTENCY_CHECK_H_
