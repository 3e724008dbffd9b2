// A condition → SPARQL ASK texts, one for each alternative that may open it.
//
// constraint   subject verb object .            with `type`: subject rdf:type type .
//              object "> 0.5":                  subject verb ?_1 . FILTER (?_1 > 0.5)
// and, or, not joined, UNION, FILTER NOT EXISTS. `or` is carried to the outside (disjunctive normal form), so that a
//              comparison or a `not` sees everything that its own alternative binds.
// event        ?_event_1 rdf:type docent:Event . ?_event_1 docent:operation "NAME" .
//
// `$name` is replaced by its value; without a value it is the free variable ?name (see ast.h on how bindings flow).
// The text is what people see and what is kept (docent:waitsFor, snapshots). It is self-contained: it declares the prefixes
// that it uses. Functions without state; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_ASK_COMPILER_H_
#define DOCENT_WORKFLOW_CAWL_ASK_COMPILER_H_

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/sparql/syntax/algebra.h"
#include "workflow/cawl/ast.h"
#include "workflow/cawl/formula.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// The value of a variable ("name" or "name.part") now; nullopt: it has none yet.
using VariableValues = std::function<std::optional<Term>(const std::string&)>;

// A rule with ext:for, as an ASK of its own.
struct LastingAsk {
  std::string ask;
  std::shared_ptr<const sparql::Query> query;  // of `ask`; null until ParseAsks
  // What tells its solutions apart: the variables that each of them binds, without "?".
  std::vector<std::string> variables;
  int64_t at_least_ms = 0;
};

struct CompiledAsk {
  std::string
      name;         // of the context or case ("context 2", "case" without one), or the condition's expression
  std::string ask;  // SPARQL
  std::shared_ptr<const sparql::Query> query;  // of `ask`; null until ParseAsks
  int priority = 0;
  // What a solution binds, without "?", in order of first use. A variable that stands only in some alternatives of
  // an `or` may be left unbound. Names beginning with "_" and event variables are not among them.
  std::vector<std::string> free_variables;
  // Those that are written `$name` and have no value yet (for `$name.part`: "name_part").
  std::vector<std::string> unset;
  // Not empty: the alternative needs an event and opens by edge, not by level: only a binding of these variables
  // that appears in a turn during which the condition is awaited opens it. What was told before does not count,
  // though it may complete an `and`. Arm the condition with these as key variables and look at what appeared.
  std::vector<std::string> event_variables;
  // Operations of those events that are needed together with others: one of them that is told first has to wait.
  std::vector<std::string> joint_events;
  // A solution counts only while, for each of these, its part of the solution has held for so long without a break.
  std::vector<LastingAsk> lasting;

  bool has_alternatives = false;  // `ask` is a UNION of them (AlternativesOf)

  bool by_event() const { return !event_variables.empty(); }
};

// The alternatives in the order in which they are to be tried; none: the condition holds at once.
// `events`: whether the events that it needs are asked for, or taken to have happened.
// INVALID_ARGUMENT: a variable's value is a blank node (SPARQL cannot name one) or a literal where a resource has to
// stand, or beyond the limits condition_alternatives, condition_parts and query_text_bytes. `refused` (null: not asked for)
// is then the place of the context, case or expression.
enum class Events { kAsked, kHappened };
absl::StatusOr<std::vector<CompiledAsk>> CompileCondition(const Document& document,
                                                          const Condition& condition,
                                                          const VariableValues& values, const Limits& limits,
                                                          SourceSpan* refused = nullptr,
                                                          Events events = Events::kAsked);

// The ASK of one constraint (ext:while).
absl::StatusOr<CompiledAsk> CompileConstraint(const Document& document, const Constraint& constraint,
                                              const VariableValues& values, const Limits& limits);

// One way in which a condition may hold: an ASK whose condition has an `or` has several.
struct Alternative {
  size_t ask = 0;                    // its place among those of CompileCondition
  const Context* context = nullptr;  // whose ext:for and <ext:time after="…"/> count; null: none do
  Conjunction parts;
};
// In the order in which they are written; none: the condition holds at once, or is beyond a limit.
std::vector<Alternative> AlternativesOf(const Condition& condition);
// The ASK of that alternative alone.
absl::StatusOr<CompiledAsk> CompileAlternative(const Document& document, const Alternative& alternative,
                                               const VariableValues& values, const Limits& limits);

// Sets the queries of what was compiled. INVALID_ARGUMENT: SPARQL does not take a text; what is armed must not come to
// that. Apart from compiling, because most texts are compared and thrown away.
absl::Status ParseAsks(const Limits& limits, CompiledAsk* ask);

// The variables of which each new binding starts a run: those of the activator's own variables that `ask` binds; all
// of ask.free_variables if that are none; ask.event_variables in front when there are any. `names`: what variables of `ask` are called
// in the activator, where that is otherwise.
std::vector<std::string> KeyVariables(const Activator& activator, const CompiledAsk& ask,
                                      const std::map<std::string, std::string>& names = {});

// A condition of a document as people see it (`docent check --ask`, Workflows.Check).
struct ConditionText {
  std::string place;  // "activator OnChoice / context C1", "flow BoothGuide / node Move2User / context C1"
  std::string ask;    // SPARQL after comment lines that name the $variables shown as ?name
  SourceSpan span;    // of the condition, or of the link's condition
};
// All conditions of the document, in its order, no variable having a value. One that can never be asked is an error at its
// place. `cancellation`: ends it early, without the conditions that follow; null: nothing does.
std::vector<ConditionText> ConditionTexts(const Document& document, const Limits& limits,
                                          xml::ElementReader* reader, Cancellation* cancellation = nullptr);

// What CompiledAsk::joint_events is of an ask that was compiled before it had them: read from its text.
std::vector<std::string> JointEventsOf(const CompiledAsk& ask);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ASK_COMPILER_H_
