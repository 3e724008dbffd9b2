#include "workflow/cawl/mode_reader.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

const std::vector<std::pair<std::string, ActivatorMode>>& Modes() {
  static const auto* modes =
      new std::vector<std::pair<std::string, ActivatorMode>>{{"single", ActivatorMode::kSingle},
                                                             {"queued", ActivatorMode::kQueued},
                                                             {"restart", ActivatorMode::kRestart},
                                                             {"parallel", ActivatorMode::kParallel}};
  return *modes;
}

}  // namespace

void ReadMode(const xml::Element& element, xml::ElementReader* reader, Activator* activator) {
  activator->mode_text = reader->Extension(element, "mode");
  if (activator->mode_text.given()) {
    const std::string& word = activator->mode_text.value;
    std::vector<std::string> names;
    for (const auto& [name, mode] : Modes()) {
      names.push_back(name);
      if (name == word) activator->mode = mode;
    }
    if (std::find(names.begin(), names.end(), word) == names.end()) {
      reader->Error(activator->mode_text.span, Concat("mode \"", word, "\" is unknown"),
                    reader->DidYouMean(word, names, "write single, queued, restart or parallel"));
    }
  }
  activator->max_text = reader->Extension(element, "max");
  if (!activator->max_text.given()) return;
  int max = 0;
  if (!absl::SimpleAtoi(activator->max_text.value, &max) || max < 1 || max > kWorkflowLimits.activator_max) {
    reader->Error(activator->max_text.span,
                  Concat("max \"", activator->max_text.value, "\" is not a number of runs"),
                  absl::StrCat("write a whole number from 1 to ", kWorkflowLimits.activator_max,
                               " (the limit activator_max)"));
    return;
  }
  activator->max = max;
  const bool counts =
      activator->mode == ActivatorMode::kQueued || activator->mode == ActivatorMode::kParallel;
  if (counts) return;
  Diagnostic& report = reader->Warning(
      activator->max_text.span,
      Concat("max has no effect: with mode ", activator->mode_text.value, " a key has one run at a time"),
      "take it away, or write ext:mode=\"queued\" or ext:mode=\"parallel\"");
  report.rule = kMaxWithoutEffect;
  report.fix = {reader->AttributeRemoval(activator->max_text.span)};
}

}  // namespace docent::cawl
