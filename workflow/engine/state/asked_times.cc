#include "workflow/engine/state/asked_times.h"

#include "graph/calendar/time_spec.h"
#include "graph/rdf/vocabulary.h"

namespace docent::engine {

void AskedTimes::Count(const Iris& iris, bool more) {
  for (const std::string& iri : iris) {
    size_t& count = asked_[iri];
    if (more)
      ++count;
    else
      --count;
    if (count == 0) asked_.erase(iri);
    changed_.insert(iri);
  }
}

void AskedTimes::Set(ConditionHandle handle, Iris iris) {
  const auto known = asked_by_.find(handle);
  if (known != asked_by_.end()) {
    Count(known->second, false);
    asked_by_.erase(known);
  }
  Count(iris, true);
  if (!iris.empty()) asked_by_.emplace(handle, std::move(iris));
}

void AskedTimes::Arm(const ConditionRequest& request) {
  Iris iris = calendar::TimeIrisIn(request.ask);
  if (iris.empty()) return;
  undo_.emplace_back(request.handle, Iris());
  Set(request.handle, std::move(iris));
}

void AskedTimes::Disarm(ConditionHandle handle) {
  const auto known = asked_by_.find(handle);
  if (known == asked_by_.end()) return;
  undo_.emplace_back(handle, known->second);
  Set(handle, {});
}

void AskedTimes::Tell(Dictionary* dictionary, std::vector<Quad>* add, std::vector<Quad>* remove) {
  for (const std::string& iri : changed_) {
    const bool asked = asked_.contains(iri);
    if (asked == told_.contains(iri)) continue;
    if (!told_before_) told_before_ = told_;
    const Quad fact = {dictionary->InternIri(iri), dictionary->InternIri(kRdfType),
                       dictionary->InternIri(DocentIri("TimeTrigger")), dictionary->InternIri(kRunsGraph)};
    (asked ? add : remove)->push_back(fact);
    if (asked)
      told_.insert(iri);
    else
      told_.erase(iri);
  }
  changed_.clear();
}

void AskedTimes::Restore(const std::vector<ConditionRequest>& armed) {
  *this = AskedTimes();
  for (const ConditionRequest& request : armed) Arm(request);
  for (const auto& [iri, count] : asked_) told_.insert(iri);
  changed_.clear();
  undo_.clear();
}

void AskedTimes::Rollback() {
  for (auto change = undo_.rbegin(); change != undo_.rend(); ++change)
    Set(change->first, std::move(change->second));
  if (told_before_) told_ = *std::move(told_before_);
  told_before_.reset();
  changed_.clear();
  undo_.clear();
}

}  // namespace docent::engine
