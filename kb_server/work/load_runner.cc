#include "kb_server/work/load_runner.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "kb_server/door/await_version.h"
#include "kb_server/door/ports.h"
#include "kb_server/work/load_judge.h"

namespace docent::server {
namespace {

// Of many results a message shows so many.
constexpr size_t kShown = 20;
constexpr absl::Duration kNextVersion = absl::Seconds(10);  // for a version that is on its way, and a worker

Diagnostics AsWarnings(const LoadVerdict& verdict) {
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
    warnings.push_back({r.file,
                        {r.line, r.column},
                        absl::StrCat(r.severity, ": ", r.focus, r.path.empty() ? "" : " ", r.path,
                                     r.value.empty() ? "" : " ", r.value, ": ", r.message),
                        absl::StrCat("see the shape ", r.shape, ", ", r.component, shape_place),
                        Diagnostic::Severity::kWarning});
  }
  return warnings;
}

absl::Status Refusal(const LoadVerdict& verdict) {
  std::string text;
  if (HasErrors(verdict.diagnostics)) {
    text = absl::StrCat("the shapes are ill-formed:\n", Render(verdict.diagnostics, ""));
  } else {
    text = "the graph would violate its shapes; nothing was changed:\n";
    size_t shown = 0;
    for (const JudgedResult& result : verdict.results) {
      if (result.violation && ++shown <= kShown) text += shapes::Render(result.text);
    }
    if (shown > kShown) absl::StrAppend(&text, "and ", shown - kShown, " more\n");
  }
  return absl::FailedPreconditionError(absl::StrCat(
      text, "  hint: correct the data or the shapes; `docent serve --on-violation warn` only warns"));
}

}  // namespace

class LoadRunner::Attempt : public std::enable_shared_from_this<Attempt> {
 public:
  Attempt(const WritePorts& ports, LoadJob job) : ports_(ports), job_(std::move(job)) {}

  void Judge() {
    ++attempts_;
    const GraphVersionPtr version = ports_.queries->Newest();
    auto verdict = JudgeShared(*version);
    if (!verdict.ok()) return job_.done(verdict.status(), {});
    const bool refuse = ports_.on_violation == OnViolation::kRefuse;
    if (refuse && verdict->HasViolations()) return job_.done(Refusal(*verdict), {});
    warnings_ = AsWarnings(*verdict);
    Push(version->revision(), refuse ? std::move(verdict->reads) : std::vector<ReadPattern>());
  }

  absl::StatusOr<LoadVerdict> JudgeShared(const GraphVersion& version) {
    const WorkerPool::SharedWork shared(ports_.workers, job_.cancellation.get());
    return JudgeLoad(ports_, job_.batch, version, job_.text, job_.cancellation.get());
  }

  void Push(Revision judged_on, std::vector<ReadPattern> reads) {
    conflict_ = false;
    auto prepare = [self = shared_from_this(), judged_on, reads = std::move(reads)](
                       const TurnView& view, WriteBatch* batch) -> absl::Status {
      if (self->job_.prepare) {
        if (absl::Status status = self->job_.prepare(view, batch); !status.ok()) return status;
      }
      if (view.revision == judged_on || !view.changes.Touched(judged_on, reads, *self->ports_.dictionary)) {
        return absl::OkStatus();
      }
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

 private:
  void Again() {
    if (attempts_ >= ports_.limits.update_attempts) {
      return job_.done(absl::AbortedError(absl::StrCat(
                           "what the shapes read was changed by others during each of ", attempts_,
                           " validations (the limit update_attempts); nothing was changed, try "
                           "again")),
                       {});
    }
    SubmitOnVersion(
        ports_, needed_,
        {.run = [self = shared_from_this()] { self->Judge(); },
         .refuse = [self = shared_from_this()](const absl::Status& why) { self->job_.done(why, {}); },
         .client = job_.client,
         .until = absl::Now() + kNextVersion,
         .cancellation = job_.cancellation});
  }

  const WritePorts& ports_;
  const LoadJob job_;
  Diagnostics warnings_;
  Revision needed_;
  int attempts_ = 0;
  bool conflict_ = false;
};

void LoadRunner::Run(LoadJob job) {
  const bool rules_alone =
      job.batch.operations.empty() &&
      std::none_of(job.batch.documents.begin(), job.batch.documents.end(),
                   [](const Document& d) { return d.kind == Document::Kind::kOntology; });
  if (ports_.on_violation != OnViolation::kIgnore && !rules_alone) {
    return std::make_shared<Attempt>(ports_, std::move(job))->Judge();
  }
  LoadVerdict unjudged;
  if (!rules_alone)
    unjudged.diagnostics = CheckLoadedShapes(ports_, job.batch, *ports_.queries->Newest(), job.text);
  auto done = [done = std::move(job.done), warnings = AsWarnings(unjudged)](
                  const absl::StatusOr<BatchOutcome>& outcome) { done(outcome, warnings); };
  ports_.inbox->Push(std::move(job.batch), std::move(done), std::move(job.prepare));
}

}  // namespace docent::server
