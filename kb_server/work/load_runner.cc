#include "kb_server/work/load_runner.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/cancellation.h"
#include "kb_server/door/await_version.h"
#include "kb_server/door/ports.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/load_judge.h"

namespace docent::server {
namespace {

// For people. Not null.
std::shared_ptr<const IriNames> NamesOf(const ReadPorts& ports) {
  auto known = KnownNames(ports);
  return known != nullptr ? known : std::make_shared<const IriNames>(IriNames::WellKnown());
}

// Of many results a message shows so many.
constexpr size_t kShown = 20;
constexpr absl::Duration kNextVersion = absl::Seconds(10);  // for a version that is on its way, and a worker

Diagnostics AsWarnings(const LoadVerdict& verdict, const IriNames& names) {
  Diagnostics warnings;
  for (Diagnostic diagnostic : verdict.diagnostics) {
    diagnostic.severity = Diagnostic::Severity::kWarning;
    warnings.push_back(std::move(diagnostic));
  }
  for (const JudgedResult& result : verdict.results) {
    if (warnings.size() == kShown) break;
    const shapes::ResultText& r = result.text;
    const std::string shape_place =
        r.shape_file.empty() ? ""
                             : absl::StrCat(" (", r.shape_file, ":", r.shape_line, ":", r.shape_column, ")");
    warnings.push_back(
        {r.file,
         {r.line, r.column},
         names.InText(absl::StrCat(r.severity, ": ", r.focus, r.path.empty() ? "" : " ", r.path,
                                   r.value.empty() ? "" : " ", r.value, ": ", r.message)),
         names.InText(absl::StrCat("see the shape ", r.shape, ", ", r.component, shape_place)),
         Diagnostic::Severity::kWarning});
  }
  return warnings;
}

absl::StatusOr<BatchOutcome> With(const Diagnostics& warnings, absl::StatusOr<BatchOutcome> outcome) {
  if (outcome.ok() && !outcome->repeated) outcome->warnings = warnings;
  return outcome;
}

absl::Status Refusal(const LoadVerdict& verdict, const IriNames& names) {
  std::string text;
  if (HasErrors(verdict.diagnostics)) {
    text = absl::StrCat("the shapes are ill-formed:\n", Render(verdict.diagnostics, ""));
  } else {
    text = "the graph would violate its shapes; nothing was changed:\n";
    size_t shown = 0;
    for (const JudgedResult& result : verdict.results) {
      if (result.violation && ++shown <= kShown) text += names.InText(shapes::Render(result.text));
    }
    if (shown > kShown) absl::StrAppend(&text, "and ", shown - kShown, " more\n");
  }
  return absl::FailedPreconditionError(absl::StrCat(
      text, "  hint: correct the data or the shapes; `docent serve --on-violation warn` only warns"));
}

}  // namespace

class LoadRunner::Attempt : public std::enable_shared_from_this<Attempt> {
 public:
  Attempt(const LoadRunner& runner, LoadJob job, Diagnostics unknown)
      : runner_(runner), ports_(runner.ports_), job_(std::move(job)), unknown_(std::move(unknown)) {}

  // On a worker.
  void Judge() {
    ++attempts_;
    if (job_.made_on_turn) return Push(Revision(), {});
    // The version first: the rules that go with it may be a turn newer, never older.
    const GraphVersionPtr version = ports_.queries->Newest();
    const WorkerPool::SharedWork shared(ports_.workers, job_.cancellation.get());
    auto reads = Judge(job_.batch, *version, job_.cancellation.get());
    if (!reads.ok()) return job_.done(reads.status(), {});
    Push(version->revision(), *std::move(reads));
  }

 private:
  // What the verdict depends on; FAILED_PRECONDITION: it refuses.
  absl::StatusOr<std::vector<ReadPattern>> Judge(const WriteBatch& batch, const GraphVersion& version,
                                                 Cancellation* cancellation) {
    auto verdict = JudgeLoad(ports_, batch, version, job_.text, runner_.Rules(), cancellation);
    if (!verdict.ok()) return verdict.status();
    const bool refuse = ports_.on_violation == OnViolation::kRefuse;
    if (refuse && verdict->HasViolations()) return Refusal(*verdict, *NamesOf(ports_));
    warnings_ = AsWarnings(*verdict, *NamesOf(ports_));
    warnings_.insert(warnings_.end(), unknown_.begin(), unknown_.end());
    return refuse ? std::move(verdict->reads) : std::vector<ReadPattern>();
  }

  void Push(Revision judged_on, std::vector<ReadPattern> reads) {
    conflict_ = false;
    auto prepare = [self = shared_from_this(), judged_on, reads = std::move(reads)](
                       const TurnView& view, WriteBatch* batch) -> absl::Status {
      if (self->job_.prepare) {
        if (absl::Status status = self->job_.prepare(view, batch); !status.ok()) return status;
      }
      if (self->job_.made_on_turn) return self->JudgeOnTurn(view, *batch);
      if (view.revision == judged_on || !view.changes.Touched(judged_on, reads, *self->ports_.dictionary)) {
        return absl::OkStatus();
      }
      if (self->attempts_ >= self->ports_.limits.update_attempts) return self->JudgeOnTurn(view, *batch);
      self->conflict_ = true;
      self->needed_ = view.revision;
      return absl::AbortedError("what the shapes read has changed meanwhile");
    };
    auto done = [self = shared_from_this()](const absl::StatusOr<BatchOutcome>& outcome) {
      if (absl::IsAborted(outcome.status()) && self->conflict_) return self->Again();
      self->job_.done(outcome, self->warnings_);
    };
    ports_.inbox->Push(job_.batch, std::move(done), std::move(prepare));
  }

  absl::Status JudgeOnTurn(const TurnView& view, const WriteBatch& batch) {
    const int limit_ms = ports_.limits.update_turn_ms;
    Cancellation cancellation{std::chrono::milliseconds(limit_ms)};
    const auto judged = Judge(batch, view.graph, &cancellation);
    if (!absl::IsDeadlineExceeded(judged.status())) return judged.status();
    return absl::AbortedError(
        absl::StrCat("what the shapes read was changed by others meanwhile, and the validation while they "
                     "waited took longer than the "
                     "limit update_turn_ms = ",
                     limit_ms, "; nothing was changed, try again"));
  }

  void Again() {
    SubmitOnVersion(
        ports_, needed_,
        {.run = [self = shared_from_this()] { self->Judge(); },
         .refuse = [self = shared_from_this()](const absl::Status& why) { self->job_.done(why, {}); },
         .client = job_.client,
         .until = absl::Now() + kNextVersion,
         .cancellation = job_.cancellation});
  }

  const LoadRunner& runner_;
  const WritePorts& ports_;
  const LoadJob job_;
  const Diagnostics unknown_;
  Diagnostics warnings_;
  Revision needed_;
  int attempts_ = 0;
  bool conflict_ = false;
};

RuleTexts LoadRunner::Rules() const {
  RuleTexts rules;
  if (catalog_ == nullptr) return rules;
  const auto catalog = catalog_->Get();
  for (const ModuleEntry& module : catalog->modules) {
    if (module.kind == Document::Kind::kRules && module.text != nullptr)
      rules.push_back({module.name, *module.text});
  }
  return rules;
}

Diagnostics LoadRunner::UnknownIn(const WriteBatch& batch, const LoadedText& text) {
  const bool brings_words =
      std::any_of(batch.documents.begin(), batch.documents.end(),
                  [](const Document& d) { return d.kind == Document::Kind::kOntology; });
  return ports_.warn_unknown && !brings_words ? unknown_words_.In(batch, text) : Diagnostics();
}

void LoadRunner::Run(LoadJob job) {
  Diagnostics unknown = UnknownIn(job.batch, job.text);
  if (ports_.on_violation != OnViolation::kIgnore)
    return std::make_shared<Attempt>(*this, std::move(job), std::move(unknown))->Judge();
  LoadVerdict unjudged;
  unjudged.diagnostics = CheckLoadedShapes(ports_, job.batch, *ports_.queries->Newest(), job.text, Rules());
  Diagnostics warnings = AsWarnings(unjudged, *NamesOf(ports_));
  warnings.insert(warnings.end(), unknown.begin(), unknown.end());
  auto done = [done = std::move(job.done), warnings = std::move(warnings)](
                  const absl::StatusOr<BatchOutcome>& outcome) { done(outcome, warnings); };
  ports_.inbox->Push(std::move(job.batch), std::move(done), std::move(job.prepare));
}

void LoadRunner::Bring(WriteBatch batch, LoadedText text, BatchPreparation prepare, bool made_on_turn,
                       ClientPtr client, BatchCallback done) {
  Diagnostics unknown = UnknownIn(batch, text);
  if (ports_.on_violation == OnViolation::kIgnore) {
    BatchCallback told = done;
    if (!unknown.empty())
      told = [done, unknown](const absl::StatusOr<BatchOutcome>& outcome) { done(With(unknown, outcome)); };
    return ports_.inbox->Push(std::move(batch), std::move(told), std::move(prepare));
  }
  LoadJob job;
  job.batch = std::move(batch);
  job.text = std::move(text);
  job.prepare = std::move(prepare);
  job.cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(ports_.limits.query_timeout_ms));
  job.done = [done](const absl::StatusOr<BatchOutcome>& outcome, const Diagnostics& warnings) {
    done(With(warnings, outcome));
  };
  job.made_on_turn = made_on_turn;
  job.client = client;
  const std::shared_ptr<Cancellation> cancellation = job.cancellation;
  auto attempt = std::make_shared<Attempt>(*this, std::move(job), std::move(unknown));
  ports_.workers->Submit({.run = [attempt] { attempt->Judge(); },
                          .refuse = [done](const absl::Status& why) { done(why); },
                          .client = std::move(client),
                          .cancellation = cancellation});
}

void BringJudged(const WritePorts& ports, WriteBatch batch, LoadedText text, BatchPreparation prepare,
                 bool made_on_turn, ClientPtr client, BatchCallback done) {
  if (ports.loads != nullptr)
    return ports.loads->Bring(std::move(batch), std::move(text), std::move(prepare), made_on_turn,
                              std::move(client), std::move(done));
  ports.inbox->Push(std::move(batch), std::move(done), std::move(prepare));
}

}  // namespace docent::server
