#include "workflow/engine/state/run_terms.h"

#include <string>
#include <string_view>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::engine {
namespace {

struct Name {
  std::string_view space, local;
};

constexpr std::array kNames = {
    Name{"", kRunsGraph},
    Name{"", kRdfType},
    Name{kDocentNs, "Run"},
    Name{kDocentNs, "NodeInstance"},
    Name{kDocentNs, "Invocation"},
    Name{kProvNs, "startedAtTime"},
    Name{kProvNs, "endedAtTime"},
    Name{kDocentNs, "workflow"},
    Name{kDocentNs, "flow"},
    Name{kDocentNs, "runState"},
    Name{kDocentNs, "reason"},
    Name{kDocentNs, "parentRun"},
    Name{kDocentNs, "usesRobot"},
    Name{kDocentNs, "hasVariable"},
    Name{kDocentNs, "variableName"},
    Name{kDocentNs, "variableValue"},
    Name{kDocentNs, "ofRun"},
    Name{kDocentNs, "nodeName"},
    Name{kDocentNs, "position"},
    Name{kDocentNs, "nodeState"},
    Name{kDocentNs, "waitsFor"},
    Name{kDocentNs, "firedBecause"},
    Name{kDocentNs, "firedAt"},
    Name{kDocentNs, "since"},
    Name{kDocentNs, "ofNode"},
    Name{kDocentNs, "operation"},
    Name{kDocentNs, "invocationState"},
    Name{kDocentNs, "robot"},
    Name{kDocentNs, "childRun"},
    Name{kDocentNs, "command"},
    Name{kDocentNs, "step"},
    Name{kDocentNs, "progress"},
    Name{kDocentNs, "stepDone"},
    Name{kDocentNs, "stepFailed"},
    Name{kDocentNs, "stepRunning"},
    Name{kDocentNs, "heldBy"},
    Name{kDocentNs, "heldFor"},
    Name{kDocentNs, "endingCommand"},
    Name{kDocentNs, "hasResult"},
    Name{kDocentNs, "pausedAt"},
    Name{kDocentNs, "pauseReason"},
    Name{kDocentNs, "notBefore"},
    Name{kDocentNs, "opensAt"},
    Name{kDocentNs, "wantedCapability"},
    Name{kDocentNs, "wantedRobot"},
    Name{kDocentNs, "forValue"},
    Name{kDocentNs, "load"},
    Name{kDocentNs, "lastUsed"},
};
static_assert(kNames.size() == static_cast<size_t>(RunTerm::kLastUsed) + 1);

}  // namespace

TermId RunTerms::Of(RunTerm term) {
  TermId& id = terms_[static_cast<size_t>(term)];
  const Name& name = kNames[static_cast<size_t>(term)];
  if (id.IsNone()) id = dictionary_.InternIri(Concat(name.space, name.local));
  return id;
}

TermId RunTerms::Of(WorkState state) {
  TermId& id = states_[static_cast<size_t>(state)];
  if (id.IsNone()) id = dictionary_.Intern(Term::Literal(std::string(ToString(state))));
  return id;
}

}  // namespace docent::engine
