#include "kb_server/replay/played_clock.h"

#include <algorithm>
#include <utility>

#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"

namespace docent::server {
namespace {

// Changes of times of day that are looked at to find one.
constexpr int kLooksAhead = 200;

}  // namespace

void PlayedClock::Begin(const Dictionary& dictionary, const GraphVersion& graph) {
  const GraphReader reader(dictionary, graph);
  simulated_ = !reader.Object(std::string(kClockGraph), DocentIri("simulatedTime")).empty();
  if (tells_ != Tells::kUnrecorded) return;
  for (std::string& time : reader.Subjects(kRdfType, Term::Iri(DocentIri("TimeTrigger"))))
    asked_.insert(std::move(time));
}

bool PlayedClock::IsConcerned(TimeMicros now_us, const Dictionary& dictionary, const Delta& delta) const {
  if (tells_ != Tells::kUnrecorded || (next_us_ && *next_us_ <= now_us)) return true;
  const std::optional<TermId> trigger = dictionary.FindIri(DocentIri("TimeTrigger"));
  if (!trigger) return false;
  const auto asks = [&trigger](const Quad& quad) { return quad.object == *trigger; };
  return std::any_of(delta.added.begin(), delta.added.end(), asks) ||
         std::any_of(delta.removed.begin(), delta.removed.end(), asks);
}

void PlayedClock::TakeTurn(const CaseTurn& turn, WriteBatch* batch) {
  asked_.insert(turn.asked.begin(), turn.asked.end());
  for (const std::string& time : turn.asked_no_more) asked_.erase(time);
  if (own_.empty() || batch->source != kClockGraph) return;
  std::erase_if(batch->operations, [this](const QuadOperation& operation) {
    return own_.contains(operation.quad.subject.lexical);
  });
}

std::vector<QuadOperation> PlayedClock::Tell(TimeMicros now_us, const Dictionary& dictionary,
                                             const GraphVersion& graph) {
  if (tells_ == Tells::kNothing) return {};
  std::set<std::string> mine = own_;
  if (tells_ == Tells::kUnrecorded) {
    const GraphReader reader(dictionary, graph);
    for (const std::string& time : reader.Subjects(kRdfType, Term::Iri(DocentIri("TimeTrigger")))) {
      if (!asked_.contains(time)) mine.insert(time);
    }
    next_us_.reset();
    if (mine.empty()) return {};
  }
  const ClockFacts facts =
      ClockFactsAt({now_us, now_us, simulated_}, dictionary, graph,
                   [&](const std::string& time) { return tells_ == Tells::kAll || mine.contains(time); });
  next_us_ = NextLook(facts);
  own_ = std::move(mine);
  return facts.operations;
}

std::optional<TimeMicros> PlayedClock::NextLook(const ClockFacts& facts) {
  std::optional<TimeMicros> next = facts.next_wall_us;
  if (facts.next_steady_us) next = std::min(next.value_or(*facts.next_steady_us), *facts.next_steady_us);
  return next;
}

std::optional<TimeMicros> PlayedClock::NextChange(
    const Dictionary& dictionary, const GraphVersion& graph,
    const std::function<bool(const TermQuad&)>& concerns) const {
  std::optional<TimeMicros> at = next_us_;
  for (int looks = 0; at && looks < kLooksAhead; ++looks) {
    const ClockFacts facts = ClockFactsAt({*at, *at, simulated_}, dictionary, graph);
    if (std::any_of(facts.operations.begin(), facts.operations.end(),
                    [&](const QuadOperation& operation) { return concerns(operation.quad); }))
      return at;
    const std::optional<TimeMicros> next = NextLook(facts);
    if (!next || *next <= *at) break;
    at = next;
  }
  return std::nullopt;
}

}  // namespace docent::server
