#include "robot_adapters/proxy/command_report.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "graph/base/cut_text.h"
#include "graph/base/limits.h"
#include "graph/base/text_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/number_literal.h"
#include "graph/rdf/term_check.h"
#include "graph/wire/term_proto.h"

namespace docent::proxy {
namespace {

constexpr size_t kShownName = 200;  // bytes of a name that is refused

CommandReport::Outcome OutcomeOf(v1::Feedback::State state) {
  switch (state) {
    case v1::Feedback::RUNNING:
      return CommandReport::Outcome::kProgress;
    case v1::Feedback::SUCCEEDED:
      return CommandReport::Outcome::kSucceeded;
    case v1::Feedback::FAILED:
      return CommandReport::Outcome::kFailed;
    case v1::Feedback::CANCELLED:
      return CommandReport::Outcome::kCancelled;
    default:
      return CommandReport::Outcome::kAccepted;
  }
}

// Why a result cannot become a value of the run; empty: it can.
std::string ResultFault(const std::string& name, const std::optional<Term>& value) {
  if (name.empty()) return "has no name";
  if (const std::optional<std::string> fault = NameFault(name))
    return absl::StrCat("cannot be named so: its name ", *fault);
  if (!value) return "has no value";
  if (const absl::Status status = CheckTerm(*value, Limits().term_bytes); !status.ok())
    return absl::StrCat("has a value that cannot be taken: ", status.message());
  if (IsNumberLiteral(*value) && !FiniteNumber(*value))
    return absl::StrCat("is ", ToDisplay(*value), ", which is not a finite number");
  return "";
}

}  // namespace

bool IsFinal(v1::Feedback::State state) {
  return state == v1::Feedback::SUCCEEDED || state == v1::Feedback::FAILED ||
         state == v1::Feedback::CANCELLED;
}

CommandReport ReportOf(const CommandId& command, const v1::Feedback& feedback, std::string* left_out) {
  CommandReport report;
  report.command = command;
  report.outcome = OutcomeOf(feedback.state());
  report.message = CutText(feedback.message(), kTextLimits.message_bytes);
  report.progress = std::isfinite(feedback.progress()) ? std::clamp(feedback.progress(), 0.0, 1.0) : 0;
  report.incarnation = feedback.incarnation();
  if (feedback.state() == v1::Feedback::SUCCEEDED) {
    for (const v1::NamedTerm& result : feedback.results()) {
      std::optional<Term> term = FromProto(result.value());
      if (const std::string fault = ResultFault(result.name(), term); !fault.empty()) {
        absl::StrAppend(left_out, left_out->empty() ? "" : "; ", "its result ",
                        CutText(result.name(), kShownName), " ", fault);
      } else {
        report.results.emplace_back(result.name(), *std::move(term));
      }
    }
  }
  return report;
}

v1::InvokeRequest InvokeRequestOf(const RobotCommand& command, const std::string& expected_incarnation) {
  v1::InvokeRequest request;
  request.set_command_id(command.id.value());
  request.set_operation(command.operation);
  for (const auto& [name, value] : command.arguments) {
    v1::NamedTerm* argument = request.add_arguments();
    argument->set_name(name);
    ToProto(value, argument->mutable_value());
  }
  request.set_expected_incarnation(expected_incarnation);
  request.set_guard_revision(command.guard_revision.value());
  request.set_deadline_us(command.deadline_us);
  return request;
}

}  // namespace docent::proxy
