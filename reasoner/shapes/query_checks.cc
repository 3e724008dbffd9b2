// Constraints and targets in SPARQL (SHACL sections 5 and 6; Advanced Features, section 3).
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "reasoner/shapes/evaluation.h"
#include "reasoner/shapes/shape_query.h"

namespace docent::shapes {
namespace {

constexpr std::string_view kShapesGraphName = "urn:docent:shapes-graph";

// A value as shown in a message: a text unchanged, an IRI as a short name.
std::string InMessage(const Term& term) {
  return term.IsLiteral() ? term.lexical : ToDisplay(term);
}

}  // namespace

// The queries read the data graph only; by GRAPH also the shapes graph, and all graphs if the data graph is
// the whole version.
void Evaluation::SetDataset(sparql::Query* query) const {
  if (data_.IsWhole()) return;
  for (const TermId graph : data_.graphs()) {
    if (graph != kAbsentTerm) query->from.push_back(dictionary_.Decode(graph));
  }
  if (query->from.empty()) query->from.push_back(Term::Iri("urn:docent:no-graph"));
  if (!shapes_.shapes_graph.IsNone() && shapes_.shapes_graph != kAbsentTerm)
    query->from_named.push_back(dictionary_.Decode(shapes_.shapes_graph));
  if (with_shapes_ != nullptr) query->from_named.push_back(Term::Iri(std::string(kShapesGraphName)));
}

// A graph of its own if the shapes are in several graphs, or not in the data's version (SHACL 5.3.1).
TermId Evaluation::ShapesGraph() {
  if (!shapes_.shapes_graph.IsNone()) return shapes_.shapes_graph;
  const TermId name = dictionary_.InternIri(kShapesGraphName);
  if (with_shapes_ != nullptr) return name;
  constexpr size_t kQuadBytes = 200;
  if (!Charge(shapes_.triples.size() * kQuadBytes)) return name;
  with_shapes_ = std::make_unique<GraphWriter>(GraphVersionPtr(&data_.version(), [](const GraphVersion*) {}));
  std::vector<Quad> quads = shapes_.triples;
  for (Quad& quad : quads) quad.graph = name;
  with_shapes_->AddAll(std::move(quads));
  return name;
}

// Null: it cannot run; status_ gives the reason.
Evaluation::Prepared* Evaluation::Prepare(const ShapeQuery& query) {
  std::unique_ptr<Prepared>& prepared = prepared_[&query];
  if (prepared != nullptr) return prepared.get();
  auto made = std::make_unique<Prepared>();
  const auto mentions = [&](std::string_view name) {
    return std::find(query.variables.begin(), query.variables.end(), name) != query.variables.end();
  };
  const auto give = [&](const std::string& name, TermId value) {
    if (!mentions(name)) return -1;
    made->names.push_back(name);
    made->values.push_back(value);
    return static_cast<int>(made->values.size()) - 1;
  };
  for (const auto& [name, value] : query.parameters) give(name, value);
  if (!query.is_target) made->this_at = give("this", TermId());
  const bool ask = query.query.form == sparql::Query::Form::kAsk;
  if (ask) made->value_at = give("value", TermId());
  if (!query.is_target) made->shape_at = give("currentShape", TermId());
  if (!query.is_target && mentions("shapesGraph")) give("shapesGraph", ShapesGraph());

  sparql::Query own = query.query.Clone();
  SetDataset(&own);
  sparql::PrepareOptions options;
  options.bound = made->names;
  options.functions = options_.functions;
  options.memory_bytes = options_.memory_bytes;
  options.all_memory = options_.all_memory;
  auto ready = sparql::PreparedQuery::Prepare(std::move(own), dictionary_, options);
  if (!ready.ok()) {
    Fail(query, ready.status());
    return nullptr;
  }
  made->query = *std::move(ready);
  const std::vector<std::string>& columns = made->query->variables();
  const auto column = [&](std::string_view name) {
    const auto found = std::find(columns.begin(), columns.end(), name);
    return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
  };
  made->this_column = column("this");
  made->value_column = column("value");
  made->path_column = column("path");
  made->message_column = column("message");
  made->failure_column = column("failure");
  prepared = std::move(made);
  return prepared.get();
}

void Evaluation::Fail(const ShapeQuery& query, const absl::Status& status) {
  if (!status_.ok()) return;
  const bool named = status.code() == absl::StatusCode::kInvalidArgument ||
                     status.code() == absl::StatusCode::kFailedPrecondition ||
                     status.code() == absl::StatusCode::kUnimplemented;
  status_ = named ? absl::Status(status.code(),
                                 absl::StrCat("the query of ", Show(query.node), ": ", status.message()))
                  : status;
}

// Starts the query with `focus` as ?this and `value` as ?value (kNone: it is no ASK). Null: status_ gives the
// reason.
Evaluation::Prepared* Evaluation::Start(const Place& place, TermId value) {
  Prepared* prepared = Prepare(*place.constraint.query);
  if (prepared == nullptr) return nullptr;
  const auto set = [&](int at, TermId id) {
    if (at >= 0) prepared->values[static_cast<size_t>(at)] = id;
  };
  set(prepared->this_at, place.focus);
  set(prepared->value_at, value);
  set(prepared->shape_at, place.shape.node);
  const absl::Status status = prepared->query->Start(RunNow(*place.constraint.query), prepared->values);
  if (status.ok()) return prepared;
  Fail(*place.constraint.query, status);
  return nullptr;
}

sparql::RunOptions Evaluation::RunNow(const ShapeQuery& query) {
  const bool asks_shapes =
      with_shapes_ != nullptr && !query.is_target &&
      std::find(query.variables.begin(), query.variables.end(), "shapesGraph") != query.variables.end();
  return {.version = asks_shapes ? &with_shapes_->current() : &data_.version(),
          .cancellation = options_.cancellation,
          .now_us = options_.now_us};
}

// 5.3 and 6.3: each solution of a SELECT violates, and each value for which an ASK is false.
void Evaluation::CheckQuery(const Place& place) {
  const ShapeQuery& query = *place.constraint.query;
  if (query.query.form == sparql::Query::Form::kSelect) {
    Prepared* prepared = Start(place, TermId());
    if (prepared == nullptr) return;
    while (Poll() && !place.sink.done() && prepared->query->Next()) ReportRow(place, *prepared);
    Fail(query, prepared->query->status());
    prepared->query->Stop();
    return;
  }
  for (const TermId value : place.values) {
    if (!Poll() || place.sink.done()) return;
    Prepared* prepared = Start(place, value);
    if (prepared == nullptr) return;
    const bool holds = prepared->query->Next();
    Fail(query, prepared->query->status());
    prepared->query->Stop();
    if (holds || !status_.ok()) continue;
    ValidationResult result;
    result.value = value;
    result.has_path = place.shape.is_property;
    result.path = place.shape.path;
    std::vector<std::pair<std::string, std::string>> values = GivenTexts(place);
    values.emplace_back("value", InMessage(dictionary_.Decode(value)));
    AddOfQuery(place, std::move(result), values, std::nullopt);
  }
}

// The values that messages may contain and that do not come from a solution.
std::vector<std::pair<std::string, std::string>> Evaluation::GivenTexts(const Place& place) const {
  std::vector<std::pair<std::string, std::string>> values;
  values.emplace_back("this", InMessage(dictionary_.Decode(place.focus)));
  if (place.shape.is_property) {
    values.emplace_back("PATH", ShowPath(place.shape));
    values.emplace_back("path", ShowPath(place.shape));
  }
  for (const auto& [name, value] : place.constraint.query->parameters)
    values.emplace_back(name, InMessage(dictionary_.Decode(value)));
  return values;
}

// 5.3.2: the result for a solution.
void Evaluation::ReportRow(const Place& place, const Prepared& prepared) {
  const absl::Span<const TermId> row = prepared.query->row();
  const auto at = [&](int column) { return column < 0 ? TermId() : row[static_cast<size_t>(column)]; };
  const TermId failure = at(prepared.failure_column);
  if (failure.tag() == TermId::Tag::kBoolean && InlineBoolean(failure)) {
    return Fail(*place.constraint.query,
                absl::FailedPreconditionError(absl::StrCat("it fails (?failure) for ", Show(place.focus))));
  }
  ValidationResult result;
  result.has_path = place.shape.is_property;
  result.path = place.shape.path;
  if (const TermId path = at(prepared.path_column); path.IsIri()) {
    result.has_path = true;
    result.path = Path();
    result.path.predicate = path;
  }
  const TermId value = at(prepared.value_column);
  if (value.tag() == TermId::Tag::kLocal) {
    result.computed = prepared.query->Decode(value);
  } else {
    result.value = value;
  }
  // A node shape's value node is its focus node.
  if (value.IsNone() && !place.shape.is_property) result.value = place.focus;
  std::vector<std::pair<std::string, std::string>> values;
  const std::vector<std::string>& names = prepared.query->variables();
  for (size_t i = 0; i < names.size(); ++i) {
    if (!row[i].IsNone()) values.emplace_back(names[i], InMessage(prepared.query->Decode(row[i])));
  }
  for (auto& given : GivenTexts(place)) values.push_back(std::move(given));
  std::optional<Term> message;
  if (const TermId id = at(prepared.message_column); id.IsLiteral() || id.tag() == TermId::Tag::kLocal)
    message = prepared.query->Decode(id);
  AddOfQuery(place, std::move(result), values, std::move(message));
}

// Adds a result. Its message is from the solution, the query, its component, the shape, or ours.
void Evaluation::AddOfQuery(const Place& place, ValidationResult result,
                            const std::vector<std::pair<std::string, std::string>>& values,
                            std::optional<Term> message) {
  const ShapeQuery& query = *place.constraint.query;
  if (message) {
    result.messages.push_back(*std::move(message));
  } else {
    for (const std::vector<TermId>* templates :
         {&query.messages, &query.component_messages, &place.shape.messages}) {
      if (!result.messages.empty()) break;
      for (const TermId id : *templates) {
        Term text = dictionary_.Decode(id);
        text.lexical = FillTemplate(text.lexical, values);
        result.messages.push_back(std::move(text));
      }
    }
  }
  if (place.constraint.component == Component::kSparql) result.constraint = query.node;
  result.own_component = query.component;
  Add(place, std::move(result),
      place.constraint.component == Component::kSparql
          ? std::string("violates a constraint in SPARQL (sh:sparql)")
          : Concat("violates the constraint ", Show(query.component)));
}

// The values of ?this, also those that are not in the data (SHACL 2.1.3).
void Evaluation::AddTargetsOf(const ShapeQuery& query, std::vector<TermId>* nodes) {
  Prepared* prepared = Prepare(query);
  if (prepared == nullptr) return;
  if (absl::Status status = prepared->query->Start(RunNow(query), prepared->values); !status.ok())
    return Fail(query, status);
  while (Poll() && prepared->query->Next()) {
    TermId node = prepared->query->row()[static_cast<size_t>(prepared->this_column)];
    if (node.tag() == TermId::Tag::kLocal) {
      const Term computed = prepared->query->Decode(node);
      if (!Charge(computed.lexical.size())) break;
      node = dictionary_.Intern(computed);
    }
    if (!node.IsNone() && Charge(sizeof(TermId))) nodes->push_back(node);
  }
  Fail(query, prepared->query->status());
  prepared->query->Stop();
}

}  // namespace docent::shapes
