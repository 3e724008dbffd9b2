#include "reasoner/rules/rule_preview.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/source_texts.h"
#include "graph/store/graph_writer.h"
#include "reasoner/rules/rule_engine.h"

namespace docent::rules {
namespace {

std::vector<std::string> Shown(const Dictionary& dictionary, const std::vector<Quad>& quads, size_t shown) {
  std::vector<std::string> lines;
  for (size_t i = 0; i < std::min(shown, quads.size()); ++i) {
    const Quad& q = quads[i];
    lines.push_back(absl::StrCat(ToNTriples(dictionary.Decode(q.subject)), " ",
                                 ToNTriples(dictionary.Decode(q.predicate)), " ",
                                 ToNTriples(dictionary.Decode(q.object)), " ."));
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

}  // namespace

absl::StatusOr<RulePreview> PreviewRules(const Dictionary& dictionary, const GraphVersionPtr& version,
                                         const std::vector<RuleSetText>& current, const std::string& name,
                                         const std::optional<std::string>& text, size_t shown,
                                         const Limits& limits, const sparql::FunctionRegistry* functions,
                                         Cancellation* cancellation) {
  Dictionary own(&dictionary);
  RuleEngine engine(own, limits, functions);
  SourceTexts texts;
  for (const RuleSetText& set : current) {
    texts.Put(set.name, set.text);
    if (absl::Status status = texts.ToStatus(engine.PutRules(set.name, set.text, RuleTextOrigin::kAccepted));
        !status.ok())
      return status;
  }
  engine.Adopt();
  if (!text) {
    if (!engine.RemoveRules(name))
      return absl::NotFoundError(absl::StrCat("there is no rule set \"", name, "\""));
  } else {
    texts.Put(name, *text);
    if (absl::Status status = texts.ToStatus(engine.PutRules(name, *text)); !status.ok()) return status;
  }
  GraphWriter writer(version);
  if (cancellation != nullptr) cancellation->AllowSteps(limits.StepsOfTurn(version->size()));
  const absl::StatusOr<Delta> delta = engine.Update(writer, {}, cancellation);
  if (!delta.ok()) return delta.status();
  RulePreview preview;
  preview.added = delta->added.size();
  preview.removed = delta->removed.size();
  preview.added_triples = Shown(own, delta->added, shown);
  preview.removed_triples = Shown(own, delta->removed, shown);
  return preview;
}

}  // namespace docent::rules
