#include "kb_server/replay/world_facts.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {

WorldFacts::WorldFacts(const Stages* stages, const RunTree* own, const ReplayLimits& limits)
    : stages_(*stages), own_(own), limits_(limits) {}

bool WorldFacts::IsOfWorld(TermId graph) {
  const std::string iri = stages_.dictionary.Decode(graph).lexical;
  if (IsDerivedGraph(iri) || iri == kDocumentsGraph) return false;
  return own_ == nullptr || !own_->IsOwnGraph(iri);
}

absl::Status WorldFacts::Count(size_t more) {
  counted_ += more;
  if (counted_ <= limits_.replay_facts) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the graph has more than ", limits_.replay_facts, " facts; the limit is replay_facts"));
}

TermQuad WorldFacts::Decode(const Quad& quad) const {
  const Dictionary& dictionary = stages_.dictionary;
  return {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate), dictionary.Decode(quad.object),
          dictionary.Decode(quad.graph)};
}

absl::StatusOr<std::vector<TermQuad>> WorldFacts::All(const std::set<Quad>& but) {
  std::vector<TermQuad> facts;
  absl::Status counted;
  TermId graph;
  bool wanted = false;
  stages_.writer.current().ForEach({}, [&](const Quad& quad) {
    if (quad.graph != graph) wanted = IsOfWorld(graph = quad.graph);
    if (!wanted || but.contains(quad)) return true;
    counted = Count(1);
    if (counted.ok()) facts.push_back(Decode(quad));
    return counted.ok();
  });
  if (!counted.ok()) return counted;
  return facts;
}

std::vector<std::pair<TimeMicros, TermQuad>> WorldFacts::Lifetimes() {
  std::vector<std::pair<TimeMicros, TermQuad>> lifetimes;
  for (const auto& [end_us, quad] : stages_.applier.Lifetimes()) {
    if (IsOfWorld(quad.graph)) lifetimes.emplace_back(end_us, Decode(quad));
  }
  return lifetimes;
}

std::set<Quad> WorldFacts::Passing() const {
  std::set<Quad> passing;
  for (const auto& [id, event] : stages_.events.events())
    passing.insert(event.facts.begin(), event.facts.end());
  const std::optional<TermId> occurs = stages_.dictionary.FindIri(DocentIri("occurs"));
  if (!occurs) return passing;
  stages_.writer.current().ForEach({{}, *occurs, {}, {}}, [&passing](const Quad& quad) {
    passing.insert(quad);
    return true;
  });
  return passing;
}

std::vector<QuadOperation> WorldFacts::Telling(const std::set<Quad>& facts) {
  std::vector<QuadOperation> telling;
  for (const Quad& quad : facts) {
    if (IsOfWorld(quad.graph)) telling.push_back({QuadOperation::Kind::kAdd, Decode(quad)});
  }
  return telling;
}

void WorldFacts::ReadHolds() {
  holds_.clear();
  const std::optional<TermId> held_by = stages_.dictionary.FindIri(DocentIri("heldBy"));
  const std::optional<TermId> runs = stages_.dictionary.FindIri(kRunsGraph);
  if (!held_by || !runs) return;
  stages_.writer.current().ForEach({{}, *held_by, {}, *runs}, [&](const Quad& quad) {
    const auto run = RunOfIri(stages_.dictionary.Decode(quad.object).lexical);
    if (run && (own_ == nullptr || !own_->Has(*run)))
      holds_[RobotId(stages_.dictionary.Decode(quad.subject).lexical)] = *run;
    return true;
  });
}

std::vector<HeldSince> HeldSinceOf(const Stages& stages, const std::string& workflow) {
  std::vector<HeldSince> held;
  const engine::EngineState state = stages.engine.Save();
  const auto deployed = state.deployments.find(workflow);
  if (deployed == state.deployments.end()) return held;
  for (LastingSince& time : stages.conditions.Times()) {
    for (const engine::ArmedCondition& armed : deployed->second.armed) {
      if (armed.handle == time.handle)
        held.push_back({armed.ask.lasting.at(time.part).ask, std::move(time.binding), time.since_us});
    }
  }
  return held;
}

std::vector<Document> DocumentsOf(const Stages& stages, const std::string& but) {
  std::vector<Document> documents;
  const auto put = [&documents](Document::Kind kind, const std::string& name, const std::string& text) {
    documents.push_back({kind, Document::Action::kPut, name, text, nullptr});
  };
  for (const auto& [key, entry] : stages.documents.entries()) {
    if (key.first == Document::Kind::kRules && entry.text != nullptr)
      put(Document::Kind::kRules, key.second, *entry.text);
  }
  for (const rsel::DocumentPtr& services : stages.engine.services().Documents())
    put(Document::Kind::kRsel, services->name.value, services->source);
  for (const cawl::DocumentPtr& workflow : stages.engine.workflows()) {
    if (workflow->name.value != but) put(Document::Kind::kCawl, workflow->name.value, workflow->source);
  }
  return documents;
}

}  // namespace docent::server
