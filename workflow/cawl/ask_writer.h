// Writes alternatives as the text of one SPARQL ASK. For ask_compiler.cc; one writer a text; one thread.
#ifndef DOCENT_WORKFLOW_CAWL_ASK_WRITER_H_
#define DOCENT_WORKFLOW_CAWL_ASK_WRITER_H_

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/limits.h"
#include "workflow/cawl/ask_compiler.h"
#include "workflow/cawl/formula.h"

namespace docent::cawl {

class AskWriter {
 public:
  // All must outlive the writer.
  AskWriter(const Document& document, const VariableValues& values, const Limits& limits);

  // INVALID_ARGUMENT: see CompileCondition.
  absl::Status Write(const std::vector<Conjunction>& alternatives);

  // Prefix declarations and the query.
  std::string Text() const;
  // As in CompiledAsk.
  const std::vector<std::string>& free_variables() const { return free_variables_; }
  const std::vector<std::string>& unset() const { return unset_; }
  const std::vector<std::string>& event_variables() const { return event_variables_; }
  const std::vector<std::string>& joint_events() const { return joint_events_; }

 private:
  // A group's triples and filters before they are laid out; a line each.
  struct Group {
    std::vector<std::string> triples;
    std::vector<std::string> filters;
    size_t bytes = 0;

    // Once each.
    void AddTriple(std::string line) { Add(std::move(line), &triples); }
    void AddFilter(std::string line) { Add(std::move(line), &filters); }

   private:
    void Add(std::string line, std::vector<std::string>* lines);
  };

  absl::Status CheckLength(size_t bytes) const;

  absl::Status WriteAlternatives(const std::vector<Conjunction>& alternatives, int indent, bool negated,
                                 std::string* out);
  absl::Status WriteConjunction(const Conjunction& conjunction, int indent, bool negated, std::string* out);
  absl::Status AddConstraint(const Constraint& constraint, bool negated, Group* group);
  absl::Status AddType(const Word& word, const std::string& value, Group* group);
  void AddEvent(const Event& event, bool negated, Group* group);
  // The ?_event_N of an event, or of a time that occurs.
  void TellEventsApart(const Conjunction& conjunction, Group* group);
  std::string EventVariable(const void* event, bool negated);
  // A time under `not` is asked for only once the clock has told of it: it is not absent before.
  void AddKnownTimes(const Formula& formula, Group* group);
  // The term that the word stands for now; nullopt: a free variable.
  std::optional<Term> ValueOf(const Word& word) const;
  // The word as SPARQL: the value, the variable, or the term.
  absl::StatusOr<std::string> Value(const Word& word, bool negated);
  absl::StatusOr<std::string> TermText(const Term& term);
  std::string Short(const std::string& iri);
  void Note(const std::string& name, std::vector<std::string>* list);

  const VariableValues& values_;
  const Limits& limits_;
  std::vector<std::pair<std::string, std::string>> prefixes_;  // namespace → prefix, longest namespace first
  std::set<std::pair<std::string, std::string>> used_prefixes_;  // prefix, namespace
  std::map<const Constraint*, int> compared_;  // number of the ?_N that stands for a compared object
  std::map<const void*, int> events_;          // by Event, or Constraint of a time that occurs
  std::string body_;
  std::vector<std::string> free_variables_, unset_, event_variables_, joint_events_;
};

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ASK_WRITER_H_
