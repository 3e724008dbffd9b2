// Would the graph violate its shapes after a write? The batch is applied to a private copy of a version, beside the writer, and the
// rules derive there what they would. Any thread.
#ifndef DOCENT_KB_SERVER_WORK_LOAD_JUDGE_H_
#define DOCENT_KB_SERVER_WORK_LOAD_JUDGE_H_

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/store/recent_changes.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/ports.h"
#include "reasoner/rules/rule_preview.h"
#include "reasoner/shapes/report.h"
#include "reasoner/shapes/validator.h"

namespace docent::server {

using RuleTexts = std::vector<rules::RuleSetText>;

// A result with terms in the place of ids, which a private copy's dictionary gave.
struct JudgedResult {
  shapes::ResultText text;
  Term focus, value, shape;  // an empty IRI as value: none
  bool violation = false;    // sh:Violation
};

struct LoadVerdict {
  std::vector<JudgedResult> results;  // that the version before does not have
  Diagnostics diagnostics;            // ill-formed shapes
  std::vector<ReadPattern> reads;     // what the shapes looked at
  bool HasViolations() const;
};

// The text that the batch was made of, for the places of results. Its blank nodes are those of the batch.
struct LoadedText {
  std::string name;                   // as the client named it; empty: there is no text
  std::function<LocatedRdf()> parse;  // only where there are results
};

// The batch of a client on `version`, with the rule sets that are in use there. CANCELLED, DEADLINE_EXCEEDED, RESOURCE_EXHAUSTED,
// INVALID_ARGUMENT as its turn would say: there is no verdict.
absl::StatusOr<LoadVerdict> JudgeLoad(const ReadPorts& ports, const WriteBatch& batch,
                                      const GraphVersion& version, const LoadedText& text,
                                      const RuleTexts& rules, Cancellation* cancellation);

// What a module's shapes say that is wrong or is not evaluated, as warnings and errors with their places in `text`. Nothing is
// validated. Errors elsewhere, which the module may have brought about, have no place.
Diagnostics CheckLoadedShapes(const ReadPorts& ports, const WriteBatch& batch, const GraphVersion& version,
                              const LoadedText& text, const RuleTexts& rules);

// A server's limits and functions for a validation.
shapes::ValidateOptions ValidateOptionsOf(const ReadPorts& ports, Cancellation* cancellation);

// The graphs of the ontology modules: where shapes are looked for.
std::vector<TermId> ModuleGraphs(const GraphVersion& version, const Dictionary& dictionary);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_LOAD_JUDGE_H_
