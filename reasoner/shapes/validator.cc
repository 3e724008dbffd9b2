#include "reasoner/shapes/validator.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "reasoner/shapes/evaluation.h"
#include "reasoner/shapes/report.h"

namespace docent::shapes {

Evaluation::Evaluation(const ShapeSet& shapes, const GraphView& data, Dictionary& dictionary,
                       const ValidateOptions& options)
    : shapes_(shapes),
      data_(data),
      dictionary_(dictionary),
      options_(options),
      type_(Id(kRdfType)),
      sub_class_of_(Id(Concat(kRdfsNs, "subClassOf"))) {}

absl::StatusOr<ValidationReport> Evaluation::Run() {
  // First: the constants of all other queries are looked up when targets that are computed have their ids.
  for (const Shape& shape : shapes_.shapes) {
    if (shape.deactivated) continue;
    for (const ShapeQueryPtr& query : shape.target_queries) AddTargetsOf(*query, &of_queries_[&shape]);
  }
  for (const Shape& shape : shapes_.shapes) {
    if (shape.deactivated || !shape.HasTargets()) continue;
    for (const TermId focus : FocusNodes(shape)) {
      if (!Poll()) return status_;
      nodes_.insert(focus);
      Sink sink{&report_.results};
      Check(shape, focus, sink);
    }
  }
  if (!status_.ok()) return status_;
  report_.focus_nodes = nodes_.size();
  return std::move(report_);
}

bool Evaluation::Poll() {
  if (!status_.ok()) return false;
  if (options_.cancellation != nullptr) status_ = options_.cancellation->Check();
  return status_.ok();
}

bool Evaluation::Charge(size_t bytes) {
  memory_ += bytes;
  if (memory_ > options_.memory_bytes && status_.ok()) {
    status_ = absl::ResourceExhaustedError(
        absl::StrCat("validation stopped at its limit query_memory_bytes = ", options_.memory_bytes));
  }
  return status_.ok();
}

std::vector<TermId> Evaluation::FocusNodes(const Shape& shape) {
  std::vector<TermId> nodes = shape.target_nodes;
  for (const TermId cls : shape.target_classes) {
    for (const TermId each : ClassAndSubclasses(cls)) {
      for (const TermId node : data_.Subjects(type_, each)) nodes.push_back(node);
    }
  }
  for (const TermId property : shape.target_subjects_of) {
    data_.ForEach(TermId(), property, TermId(), [&](const Quad& q) {
      nodes.push_back(q.subject);
      return Poll();
    });
  }
  for (const TermId property : shape.target_objects_of) {
    data_.ForEach(TermId(), property, TermId(), [&](const Quad& q) {
      nodes.push_back(q.object);
      return Poll();
    });
  }
  if (const auto found = of_queries_.find(&shape); found != of_queries_.end())
    nodes.insert(nodes.end(), found->second.begin(), found->second.end());
  Charge(nodes.size() * sizeof(TermId));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void Evaluation::Check(const Shape& shape, TermId focus, Sink& sink) {
  if (shape.deactivated) return;
  const std::vector<TermId> values =
      shape.is_property ? ValueNodes(shape.path, focus) : std::vector<TermId>{focus};
  for (const Constraint& constraint : shape.constraints) {
    if (!Poll() || sink.done()) return;
    CheckConstraint({shape, constraint, focus, values, sink});
  }
}

// Shapes do not refer to themselves, so the result depends only on shape and node.
bool Evaluation::Conforms(ShapeIndex shape, TermId node) {
  const std::pair<ShapeIndex, TermId> key(shape, node);
  if (auto it = conforms_.find(key); it != conforms_.end()) return it->second;
  Sink sink;
  Check(shapes_.shapes[shape], node, sink);
  if (!Poll()) return true;
  constexpr size_t kEntryBytes = 40;
  if (memory_ + kEntryBytes < options_.memory_bytes / 2) {
    Charge(kEntryBytes);
    conforms_.emplace(key, !sink.any);
  }
  return !sink.any;
}

void Evaluation::Report(const Place& place, TermId value, const std::string& message) {
  ValidationResult result;
  result.value = value;
  result.has_path = place.shape.is_property;
  if (result.has_path && place.sink.results != nullptr) result.path = place.shape.path;
  Add(place, std::move(result), message);
}

void Evaluation::Add(const Place& place, ValidationResult result, const std::string& message) {
  place.sink.any = true;
  if (place.sink.results == nullptr) return;
  const bool counted = place.sink.results == &report_.results;
  if (counted) ++report_.total;
  if (place.sink.results->size() >= options_.limits.validation_results) return;
  result.focus = place.focus;
  result.component = place.constraint.component;
  result.shape = place.shape.node;
  result.severity = place.shape.severity;
  if (result.messages.empty()) {
    for (const TermId id : place.shape.messages) result.messages.push_back(dictionary_.Decode(id));
  }
  if (result.messages.empty()) result.messages.push_back(Term::LangString(message, "en"));
  Charge(sizeof(result) + message.size());
  place.sink.results->push_back(std::move(result));
}

const absl::flat_hash_set<TermId>& Evaluation::ClassAndSubclasses(TermId cls) {
  auto [it, is_new] = classes_.try_emplace(cls);
  if (!is_new) return it->second;
  std::vector<TermId> open = {cls};
  it->second.insert(cls);
  while (!open.empty() && Poll()) {
    const TermId at = open.back();
    open.pop_back();
    for (const TermId sub : data_.Subjects(sub_class_of_, at)) {
      if (it->second.insert(sub).second) open.push_back(sub);
    }
  }
  Charge(it->second.size() * 2 * sizeof(TermId));
  return it->second;
}

bool Evaluation::IsInstance(TermId node, TermId cls) {
  if (node.IsLiteral()) return false;
  const absl::flat_hash_set<TermId>& classes = ClassAndSubclasses(cls);
  bool found = false;
  data_.ForEach(node, type_, TermId(), [&](const Quad& q) {
    found = classes.contains(q.object);
    return !found;
  });
  return found;
}

std::string Evaluation::ShowPath(const Shape& shape) const {
  return PathText(shape.path, dictionary_);
}

absl::StatusOr<ValidationReport> Validate(const ShapeSet& shapes, const GraphView& data,
                                          Dictionary& dictionary, const ValidateOptions& options) {
  return Evaluation(shapes, data, dictionary, options).Run();
}

}  // namespace docent::shapes
