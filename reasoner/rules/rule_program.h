// All rules of all sets, ready to run: bodies compiled, strata found, patterns indexed. Private to this
// folder. Writer thread only (bodies keep scratch space); otherwise unchanged after Build.
#ifndef DOCENT_REASONER_RULES_RULE_PROGRAM_H_
#define DOCENT_REASONER_RULES_RULE_PROGRAM_H_

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/sparql/function_registry.h"
#include "kb_server/store/quad.h"
#include "reasoner/matching/body.h"
#include "reasoner/matching/pattern_index.h"
#include "reasoner/rules/rule_parser.h"

namespace docent {

struct Triple {
  TermId subject, predicate, object;
  friend constexpr auto operator<=>(const Triple&, const Triple&) = default;
  template <typename H>
  friend H AbslHashValue(H h, const Triple& t) {
    return H::combine(std::move(h), t.subject, t.predicate, t.object);
  }
};

// A triple of a head: constants, and columns of the body.
struct HeadTriple {
  std::array<TermId, 3> constants;
  std::array<int16_t, 3> columns = {Trigger::kNoColumn, Trigger::kNoColumn, Trigger::kNoColumn};

  // False where the row does not make an RDF triple (unbound variable, literal as subject).
  bool Make(absl::Span<const TermId> row, Triple& out) const;
  // The seed under which this head can make `triple`; false if it cannot.
  bool SeedFrom(const Triple& triple, size_t column_count, std::vector<TermId>& seed) const;
  QuadPattern Pattern() const { return {constants[0], constants[1], constants[2], TermId()}; }
};

struct CompiledRule {
  std::string label;  // "s01.rules, rule 3 (line 12)"
  std::string set;
  SourceSpan span;
  std::vector<HeadTriple> head;
  std::unique_ptr<Body> body;
  int stratum = 0;
};

using RuleSets = std::map<std::string, std::shared_ptr<const ParsedRules>>;

class RuleProgram {
 public:
  // Null and diagnostics (negation through recursion with its cycle, unknown functions) where it cannot be
  // run.
  static std::shared_ptr<RuleProgram> Build(const RuleSets& sets, Dictionary& dictionary,
                                            const sparql::FunctionRegistry* functions,
                                            Diagnostics& diagnostics);

  std::vector<CompiledRule> rules;
  int stratum_count = 0;
  std::vector<std::vector<uint32_t>> rules_of_stratum;
  PatternIndex triggers;  // reference: rule, trigger of its body
  PatternIndex heads;     // reference: rule, triple of its head

 private:
  bool Compile(const RuleSets& sets, Dictionary& dictionary, const sparql::FunctionRegistry* functions,
               Diagnostics& diagnostics);
  void Index();
};

}  // namespace docent

#endif  // DOCENT_REASONER_RULES_RULE_PROGRAM_H_
