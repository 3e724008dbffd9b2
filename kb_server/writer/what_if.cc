#include "kb_server/writer/what_if.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/text_bytes.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"

namespace docent::server {
namespace {

std::vector<std::pair<std::string, Term>> Decode(const conditions::Binding& binding,
                                                 const Dictionary& dictionary) {
  std::vector<std::pair<std::string, Term>> terms;
  for (const auto& [name, id] : binding) terms.emplace_back(name, dictionary.Decode(id));
  return terms;
}

// Follows all conditions beside the engine, which disarms those that open.
class FlipWatch {
 public:
  FlipWatch(Stages* stages, const std::vector<engine::ConditionRequest>& requests)
      : stages_(*stages), requests_(requests) {}

  absl::Status Begin(TimeMicros now_us) {
    for (const engine::ConditionRequest& request : requests_) {
      if (stages_.cancellation != nullptr) {
        if (absl::Status status = stages_.cancellation->CheckNow(); !status.ok()) return status;
      }
      sparql::ParsedQuery parsed = sparql::ParseQuery(request.ask);
      if (!parsed.ok()) return ToStatus(parsed.diagnostics, request.ask);
      auto id = stages_.standing_conditions.Register(parsed.query, stages_.writer.current(),
                                                     {request.key_variables, now_us, stages_.cancellation});
      if (!id.ok()) return id.status();
      before_.push_back({*id, stages_.engine.PlaceOf(request.handle), stages_.standing_conditions.Holds(*id),
                         stages_.standing_conditions.Keys(*id)});
    }
    return absl::OkStatus();
  }

  std::vector<ConditionFlip> Flips() const {
    std::vector<ConditionFlip> flips;
    for (size_t i = 0; i < before_.size(); ++i) {
      const Level& level = before_[i];
      ConditionFlip flip{
          level.place, requests_[i].ask, level.holds, stages_.standing_conditions.Holds(level.id), {}, {}, 0};
      for (const engine::LastingPart& part : requests_[i].lasting)
        flip.lasting_us = std::max(flip.lasting_us, part.at_least_us);
      const std::vector<conditions::Binding> now = stages_.standing_conditions.Keys(level.id);
      const auto missing_in = [&](const std::vector<conditions::Binding>& all,
                                  const std::vector<conditions::Binding>& in, auto* out) {
        if (requests_[i].key_variables.empty()) return;
        for (const conditions::Binding& key : all) {
          if (std::find(in.begin(), in.end(), key) == in.end())
            out->push_back(Decode(key, stages_.dictionary));
        }
      };
      missing_in(now, level.keys, &flip.appeared);
      missing_in(level.keys, now, &flip.disappeared);
      if (flip.held != flip.holds || !flip.appeared.empty() || !flip.disappeared.empty())
        flips.push_back(std::move(flip));
    }
    return flips;
  }

 private:
  struct Level {
    conditions::ConditionId id;
    std::string place;  // whose condition it is, before the turn
    bool holds;
    std::vector<conditions::Binding> keys;
  };
  Stages& stages_;
  const std::vector<engine::ConditionRequest>& requests_;
  std::vector<Level> before_;
};

// As long as they have room in an answer, where each stands as terms and in the text for people.
absl::StatusOr<std::vector<TermQuad>> Decode(const std::vector<Quad>& quads, const Dictionary& dictionary,
                                             const Limits& limits, size_t* bytes) {
  const std::optional<TermId> runs = dictionary.FindIri(kRunsGraph);
  std::vector<TermQuad> out;
  for (const Quad& q : quads) {
    if (q.graph == runs) continue;
    const TermQuad& quad = out.emplace_back(dictionary.Decode(q.subject), dictionary.Decode(q.predicate),
                                            dictionary.Decode(q.object), dictionary.Decode(q.graph));
    *bytes += 2 * TextBytes(quad);
    if (*bytes > limits.grpc_message_bytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat(quads.size(),
                       " facts would change, more than an answer of the limit "
                       "grpc_message_bytes = ",
                       limits.grpc_message_bytes, " can tell; ask about fewer"));
    }
  }
  std::sort(out.begin(), out.end(), [](const TermQuad& a, const TermQuad& b) {
    return std::tie(a.graph, a.subject, a.predicate, a.object) <
           std::tie(b.graph, b.subject, b.predicate, b.object);
  });
  return out;
}

}  // namespace

StagesCopy CopyStages(Stages* stages, Revision revision) {
  StagesCopy copy;
  copy.version = stages->writer.Freeze(revision);
  copy.rules = stages->documents.MakeCatalog(stages->engine)->rules;
  copy.conditions = stages->conditions.Requests();
  copy.times = stages->conditions.Times();
  copy.engine = stages->engine.Save();
  copy.events = stages->events.events();
  return copy;
}

absl::StatusOr<WhatIfAnswer> RunWhatIf(const StagesCopy& copy, Dictionary* dictionary,
                                       const sparql::FunctionRegistry* functions, const Limits& limits,
                                       WriteBatch batch, Cancellation* cancellation) {
  Stages stages(dictionary, functions, limits, copy.version);
  stages.cancellation = cancellation;
  for (const explain::RuleText& set : copy.rules) {
    const Diagnostics diagnostics =
        stages.rules.PutRules(set.name, *set.text, rules::RuleTextOrigin::kAccepted);
    if (HasErrors(diagnostics)) return ToStatus(diagnostics, *set.text);
  }
  stages.rules.Adopt();
  stages.engine.Restore(copy.engine);
  stages.events.Restore(copy.events, batch.time_us);
  absl::Status armed =
      stages.conditions.Restore(copy.conditions, copy.times, *copy.version, batch.time_us, cancellation);
  if (!armed.ok()) return armed;
  FlipWatch watch(&stages, copy.conditions);
  if (absl::Status begun = watch.Begin(batch.time_us); !begun.ok()) return begun;
  stages.Commit();

  auto turn = RunTurn(&stages, std::move(batch), copy.version->revision().value() + 1);
  if (!turn.ok()) return turn.status();
  WhatIfAnswer answer;
  answer.revision = copy.version->revision();
  size_t bytes = 0;
  for (const bool added : {true, false}) {
    auto facts = Decode(added ? turn->delta.added : turn->delta.removed, *dictionary, limits, &bytes);
    if (!facts.ok()) return facts.status();
    (added ? answer.added : answer.removed) = *std::move(facts);
  }
  answer.flips = watch.Flips();
  answer.transitions = std::move(turn->record.transitions);
  for (const RobotCommand& command : turn->record.commands)
    answer.commands.push_back(log::ToDisplay(command));
  return answer;
}

void WhatIf::Ask(WriteBatch batch, ClientPtr client, std::shared_ptr<Cancellation> cancellation,
                 Answered answered) {
  if (batch.OperationCount() > ports_.explain_limits.what_if_operations) {
    return answered(absl::ResourceExhaustedError(absl::StrCat("the question has ", batch.OperationCount(),
                                                              " facts; the limit what_if_operations is ",
                                                              ports_.explain_limits.what_if_operations)));
  }
  auto copy = std::make_shared<StagesCopy>();
  auto question = std::make_shared<WriteBatch>(std::move(batch));
  const auto evaluate = [this, copy, question, cancellation, answered] {
    Dictionary dictionary(ports_.dictionary);
    question->time_us = ports_.clock->Now();
    const WorkerPool::SharedWork shared(ports_.workers, cancellation.get());
    answered(RunWhatIf(*copy, &dictionary, ports_.functions, ports_.limits, std::move(*question),
                       cancellation.get()));
  };
  ports_.inbox->Visit(
      [copy, cancellation](Stages* stages, Revision revision) {
        if (!cancellation->IsOver()) *copy = CopyStages(stages, revision);
      },
      [this, evaluate, client, cancellation, answered](absl::Status status) {
        if (status.ok()) status = cancellation->CheckNow();
        if (!status.ok()) return answered(status);
        ports_.workers->Submit({.run = evaluate,
                                .refuse = answered,
                                .client = client,
                                .until = absl::Now() + absl::FromChrono(cancellation->Left()),
                                .cancellation = cancellation});
      });
}

}  // namespace docent::server
