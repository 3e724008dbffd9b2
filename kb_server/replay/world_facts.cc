#include "kb_server/replay/world_facts.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"

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
      absl::StrCat("the graph before the run and the changes in its life have more than ",
                   limits_.replay_facts, " facts; the limit is replay_facts"));
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

absl::StatusOr<std::vector<QuadOperation>> WorldFacts::Changes(const Delta& delta) {
  std::vector<QuadOperation> changes;
  for (const Quad& quad : delta.removed) {
    if (IsOfWorld(quad.graph)) changes.push_back({QuadOperation::Kind::kRemove, Decode(quad)});
  }
  std::set<Quad> added;
  for (const Quad& quad : delta.added) {
    if (!IsOfWorld(quad.graph)) continue;
    changes.push_back({QuadOperation::Kind::kAdd, Decode(quad)});
    added.insert(quad);
  }
  // An event that is told again while the graph has it still is no change of the graph, but it counts.
  for (const engine::ToldEvent& told : stages_.events.news().told) {
    const std::optional<TermId> event = stages_.dictionary.Find(told.event);
    if (!event) continue;
    stages_.writer.current().ForEach({*event, {}, {}, {}}, [&](const Quad& quad) {
      if (IsOfWorld(quad.graph) && added.insert(quad).second)
        changes.push_back({QuadOperation::Kind::kAdd, Decode(quad)});
      return true;
    });
  }
  if (absl::Status counted = Count(changes.size()); !counted.ok()) return counted;
  return changes;
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
  Delta all;
  stages_.writer.current().ForEach({{}, *held_by, {}, *runs}, [&](const Quad& quad) {
    all.added.push_back(quad);
    return true;
  });
  UpdateHolds(all);
}

bool WorldFacts::UpdateHolds(const Delta& delta) {
  const std::optional<TermId> held_by = stages_.dictionary.FindIri(DocentIri("heldBy"));
  const std::optional<TermId> runs = stages_.dictionary.FindIri(kRunsGraph);
  if (!held_by || !runs) return false;
  const Holds before = holds_;
  const auto each = [&](const std::vector<Quad>& quads, auto visit) {
    for (const Quad& quad : quads) {
      if (quad.predicate != *held_by || quad.graph != *runs) continue;
      const auto run = RunOfIri(stages_.dictionary.Decode(quad.object).lexical);
      if (run) visit(RobotId(stages_.dictionary.Decode(quad.subject).lexical), *run);
    }
  };
  each(delta.removed, [&](const RobotId& robot, const RunId& run) {
    const auto held = holds_.find(robot);
    if (held != holds_.end() && held->second == run) holds_.erase(held);
  });
  each(delta.added, [&](const RobotId& robot, const RunId& run) {
    if (own_ == nullptr || !own_->Has(run)) holds_[robot] = run;
  });
  return holds_ != before;
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
