#include "reasoner/shapes/shape_reader.h"

#include <algorithm>
#include <deque>
#include <functional>
#include <tuple>
#include <utility>

#include "absl/container/btree_set.h"
#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/regex/regex_parser.h"
#include "reasoner/shapes/path_reader.h"
#include "reasoner/shapes/shape_order.h"
#include "reasoner/shapes/shape_parameters.h"
#include "reasoner/shapes/shape_properties.h"
#include "reasoner/shapes/shape_words.h"
#include "reasoner/shapes/sparql_reader.h"

namespace docent::shapes {
namespace {

class ShapeReader {
 public:
  ShapeReader(const GraphView& graph, const Dictionary& dictionary, const CheckLimits& limits,
              const SourceMap* places, const sparql::FunctionRegistry* functions, const Regimes& regimes)
      : graph_(graph),
        dictionary_(dictionary),
        limits_(limits),
        places_(places),
        regimes_(regimes),
        paths_(graph, dictionary, limits.shape_nesting),
        type_(Id(kRdfType)),
        sparql_(graph, dictionary, functions, roles_,
                [this](TermId node, std::string_view local, std::string message, std::string hint,
                       Diagnostic::Severity severity) {
                  Report(node, local, std::move(message), std::move(hint), severity);
                }) {}

  ParsedShapes Run() {
    for (const TermId node : Roots()) IndexOf(node);
    while (!waiting_.empty()) {
      const ShapeIndex index = waiting_.front();
      waiting_.pop_front();
      Read(index);
    }
    sparql_.CheckUnused();
    CheckEntailment();
    CheckWords();
    NameGraph();
    if (!HasErrors(parsed_.diagnostics)) CheckOrder();
    if (!HasErrors(parsed_.diagnostics)) CollectProperties(dictionary_, &parsed_.shapes);
    std::stable_sort(
        parsed_.diagnostics.begin(), parsed_.diagnostics.end(), [](const Diagnostic& a, const Diagnostic& b) {
          return std::tie(a.file, a.span.line, a.span.column) < std::tie(b.file, b.span.line, b.span.column);
        });
    return std::move(parsed_);
  }

 private:
  TermId Id(std::string_view iri) const { return dictionary_.FindIri(iri).value_or(kAbsentTerm); }
  TermId Sh(std::string_view local) const { return Id(Shacl(local)); }
  std::string Show(TermId id) const { return ToDisplay(dictionary_.Decode(id)); }
  std::vector<TermId> Values(TermId node, std::string_view local) const {
    return graph_.Objects(node, Sh(local));
  }

  void Report(TermId node, std::string_view local, std::string message, std::string hint,
              Diagnostic::Severity severity = Diagnostic::Severity::kError) {
    const bool full = parsed_.diagnostics.size() >= limits_.check_diagnostics;
    const bool is_first_error =
        severity == Diagnostic::Severity::kError && full && !HasErrors(parsed_.diagnostics);
    if (full && !is_first_error) return;
    Diagnostic diagnostic;
    const SourcePlace* place = nullptr;
    if (places_ != nullptr && !local.empty()) place = places_->Find(node, Sh(local));
    if (places_ != nullptr && place == nullptr) place = places_->Find(node);
    if (place != nullptr) {
      diagnostic.file = place->file;
      diagnostic.span = place->span;
    }
    diagnostic.message = Concat("shape ", Show(node), ": ", message);
    diagnostic.hint = std::move(hint);
    diagnostic.severity = severity;
    parsed_.diagnostics.push_back(std::move(diagnostic));
  }

  void NameGraph() {
    if (graph_.graphs().size() == 1) {
      parsed_.shapes.shapes_graph = graph_.graphs()[0];
    } else if (sparql_.asks_shapes_graph()) {
      graph_.ForEach(TermId(), TermId(), TermId(), [this](const Quad& quad) {
        parsed_.shapes.triples.push_back(quad);
        return true;
      });
    }
  }

  // The nodes that are shapes by their targets or types, ascending.
  std::vector<TermId> Roots() {
    std::vector<TermId> roots;
    for (const char* word : {"targetNode", "targetClass", "targetSubjectsOf", "targetObjectsOf", "target"}) {
      graph_.ForEach(TermId(), Sh(word), TermId(), [&roots](const Quad& q) {
        roots.push_back(q.subject);
        return true;
      });
    }
    for (const char* word : {"NodeShape", "PropertyShape"}) {
      for (const TermId node : graph_.Subjects(type_, Sh(word))) roots.push_back(node);
    }
    std::sort(roots.begin(), roots.end());
    roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
    return roots;
  }

  ShapeIndex IndexOf(TermId node) {
    auto [it, is_new] = index_.try_emplace(node, static_cast<ShapeIndex>(parsed_.shapes.shapes.size()));
    if (is_new) {
      parsed_.shapes.shapes.emplace_back().node = node;
      waiting_.push_back(it->second);
    }
    return it->second;
  }

  void Read(ShapeIndex index) {
    Shape shape;
    shape.node = parsed_.shapes.shapes[index].node;
    if (shape.node.IsLiteral()) {
      return Report(shape.node, "", "a literal is not a shape", "name the shape by an IRI or a blank node");
    }
    roles_.Add(shape.node, NodeRole::kShape);
    for (const TermId rule : Values(shape.node, "rule")) roles_.Add(rule, NodeRole::kRule);
    ReadPath(&shape);
    ReadTargets(&shape);
    ReadOthers(&shape);
    for (const Parameter& parameter : kParameters) ReadParameter(parameter, &shape);
    ReadQualified(&shape);
    if (!shape.is_property || shape.has_path) sparql_.ReadConstraints(&shape);
    parsed_.shapes.shapes[index] = std::move(shape);
  }

  void ReadPath(Shape* shape) {
    const std::vector<TermId> paths = Values(shape->node, "path");
    const bool typed = graph_.Contains(shape->node, type_, Sh("PropertyShape"));
    if (paths.empty()) {
      if (typed) {
        Report(shape->node, "", "a property shape without sh:path", "add sh:path, or make it a sh:NodeShape");
      }
      return;
    }
    shape->is_property = true;
    if (paths.size() > 1) {
      return Report(shape->node, "path", absl::StrCat("has ", paths.size(), " sh:path; one is allowed"),
                    "write several property shapes, or one sh:alternativePath");
    }
    std::optional<Path> path = paths_.Read(paths[0]);
    if (!path)
      return Report(shape->node, "path", "ill-formed sh:path: " + paths_.problem(),
                    "see SHACL section 2.3.1");
    shape->path = *std::move(path);
    shape->has_path = true;
  }

  void ReadTargets(Shape* shape) {
    shape->target_nodes = Values(shape->node, "targetNode");
    for (const TermId node : shape->target_nodes) {
      if (node.IsBlank())
        Report(shape->node, "targetNode", "a blank node is not a target", "target an IRI or a literal");
    }
    shape->target_classes = IriValues(shape->node, "targetClass");
    shape->target_subjects_of = IriValues(shape->node, "targetSubjectsOf");
    shape->target_objects_of = IriValues(shape->node, "targetObjectsOf");
    if (shape->node.IsIri() && IsClass(shape->node)) shape->target_classes.push_back(shape->node);
    sparql_.ReadTargets(shape);
  }

  // Section 2.1.3.3, with owl:Class as well.
  bool IsClass(TermId node) const {
    for (const std::string_view name : {kRdfsNs, kOwlNs}) {
      if (graph_.Contains(node, type_, Id(Concat(name, "Class")))) return true;
    }
    return false;
  }

  std::vector<TermId> IriValues(TermId node, std::string_view local) {
    std::vector<TermId> iris;
    for (const TermId value : Values(node, local)) {
      if (value.IsIri()) {
        iris.push_back(value);
      } else {
        Report(node, local, Concat("sh:", local, " is ", Show(value), ", which is not an IRI"),
               "name it by its IRI");
      }
    }
    return iris;
  }

  void ReadOthers(Shape* shape) {
    const std::vector<TermId> severities = IriValues(shape->node, "severity");
    shape->severity = severities.empty() ? Sh("Violation") : severities[0];
    if (severities.size() > 1) {
      Report(shape->node, "severity", "has several sh:severity; one is allowed", "keep one");
    }
    for (const TermId message : Values(shape->node, "message")) {
      const std::string_view datatype = dictionary_.Datatype(message);
      if (message.IsLiteral() && (datatype == kXsdString || datatype == kRdfLangString)) {
        shape->messages.push_back(message);
      } else {
        Report(shape->node, "message", Concat("sh:message is ", Show(message), ", which is not a text"),
               "write \"text\"");
      }
    }
    const std::vector<TermId> deactivated = Values(shape->node, "deactivated");
    shape->deactivated = IsTrue(deactivated);
    for (const TermId value : deactivated) {
      if (dictionary_.Datatype(value) != kXsdBoolean) {
        Report(shape->node, "deactivated", "sh:deactivated is neither true nor false", "write true or false");
      }
    }
  }

  bool IsTrue(const std::vector<TermId>& values) const {
    return std::any_of(values.begin(), values.end(),
                       [this](TermId id) { return id.tag() == TermId::Tag::kBoolean && InlineBoolean(id); });
  }

  void ReadParameter(const Parameter& parameter, Shape* shape) {
    const std::string name = ParameterName(parameter.component);
    const std::vector<TermId> values = Values(shape->node, name);
    if (values.empty()) return;
    if (parameter.single && values.size() > 1) {
      return Report(shape->node, name, absl::StrCat("has ", values.size(), " sh:", name, "; one is allowed"),
                    "keep one, or write several shapes");
    }
    if (parameter.property_only && !shape->is_property) {
      return Report(shape->node, name, Concat("sh:", name, " at a node shape"),
                    "it says something of a property's values: put it into a sh:property with its sh:path");
    }
    for (const TermId value : values) {
      Constraint constraint;
      constraint.component = parameter.component;
      constraint.value = value;
      if (ReadValue(parameter, name, shape->node, value, &constraint)) {
        shape->constraints.push_back(std::move(constraint));
      }
    }
  }

  bool Wrong(TermId node, std::string_view name, TermId value, std::string_view expected) {
    Report(node, name, Concat("sh:", name, " is ", Show(value), ", not ", expected), "");
    return false;
  }

  // False: it is ill-formed, or has no effect.
  bool ReadValue(const Parameter& parameter, const std::string& name, TermId node, TermId value,
                 Constraint* out) {
    switch (parameter.values) {
      case ValueRule::kAny:
        return true;
      case ValueRule::kIri:
        return value.IsIri() || Wrong(node, name, value, "an IRI");
      case ValueRule::kLiteral:
        return value.IsLiteral() || Wrong(node, name, value, "a literal");
      case ValueRule::kInteger:
        return ReadInteger(node, name, value, &out->number);
      case ValueRule::kNodeKind:
        return IsNodeKind(value) ||
               Wrong(node, name, value, "sh:IRI, sh:BlankNode, sh:Literal or a pair of them");
      case ValueRule::kTrue:
        return ReadTrue(name, node, value, out);
      case ValueRule::kString:
        return ReadPattern(node, value, out);
      case ValueRule::kList:
        return ReadTermList(name, node, value, out);
      case ValueRule::kShape:
        if (value.IsLiteral()) return Wrong(node, name, value, "a shape");
        CheckKind(parameter.component, node, value);
        out->shapes.push_back(IndexOf(value));
        return true;
      case ValueRule::kShapes:
        return ReadShapeList(name, node, value, out);
    }
    return false;
  }

  // sh:property names property shapes; sh:node names node shapes.
  void CheckKind(Component component, TermId node, TermId value) {
    const bool has_path = !Values(value, "path").empty();
    if (component == Component::kProperty && !has_path) {
      Report(node, "property", Concat("sh:property is ", Show(value), ", which has no sh:path"),
             "add sh:path to it, or refer to it with sh:node");
    }
    if (component == Component::kNode && has_path) {
      Report(node, "node", Concat("sh:node is ", Show(value), ", which has a sh:path"),
             "refer to it with sh:property");
    }
  }

  bool ReadInteger(TermId node, std::string_view name, TermId value, int64_t* out) {
    if (value.tag() == TermId::Tag::kInteger) {
      *out = InlineInteger(value);
      return true;
    }
    const Term term = dictionary_.Decode(value);  // of another form, as +5, or large
    if (!term.IsLiteral() || term.datatype != kXsdInteger) return Wrong(node, name, value, "an xsd:integer");
    if (absl::SimpleAtoi(term.lexical, out)) return true;
    const size_t sign = term.lexical.starts_with('-') || term.lexical.starts_with('+') ? 1 : 0;
    const bool digits =
        term.lexical.size() > sign && term.lexical.find_first_not_of("0123456789", sign) == std::string::npos;
    return Wrong(node, name, value, digits ? "a number below 2^63" : "an xsd:integer");
  }

  bool IsNodeKind(TermId value) const {
    for (const char* kind :
         {"IRI", "BlankNode", "Literal", "BlankNodeOrIRI", "BlankNodeOrLiteral", "IRIOrLiteral"}) {
      if (value == Sh(kind)) return true;
    }
    return false;
  }

  // sh:uniqueLang and sh:closed: only the literal true has an effect (test uniqueLang-002 of the suite).
  bool ReadTrue(const std::string& name, TermId node, TermId value, Constraint* out) {
    if (dictionary_.Datatype(value) != kXsdBoolean) return Wrong(node, name, value, "true or false");
    if (!IsTrue({value})) return false;
    if (out->component == Component::kClosed) ReadClosed(node, out);
    return true;
  }

  void ReadClosed(TermId node, Constraint* out) {
    for (const TermId property : Values(node, "property")) {
      for (const TermId path : Values(property, "path")) {
        if (path.IsIri()) out->terms.push_back(path);
      }
    }
    for (const TermId list : Values(node, "ignoredProperties")) {
      std::optional<std::vector<TermId>> ignored = paths_.ReadList(list);
      if (!ignored) {
        Report(node, "ignoredProperties", "ill-formed sh:ignoredProperties: " + paths_.problem(),
               "write ( ex:p ex:q )");
        continue;
      }
      for (const TermId property : *ignored) {
        if (!property.IsIri()) Wrong(node, "ignoredProperties", property, "an IRI");
        out->terms.push_back(property);
      }
    }
    std::sort(out->terms.begin(), out->terms.end());
  }

  bool ReadPattern(TermId node, TermId value, Constraint* out) {
    if (!value.IsLiteral() || dictionary_.Datatype(value) != kXsdString) {
      return Wrong(node, "pattern", value, "a plain text");
    }
    out->pattern = dictionary_.Decode(value);
    const std::vector<TermId> flags = Values(node, "flags");
    if (flags.size() > 1) Report(node, "flags", "has several sh:flags; one is allowed", "keep one");
    if (!flags.empty()) {
      if (!flags[0].IsLiteral() || dictionary_.Datatype(flags[0]) != kXsdString)
        return Wrong(node, "flags", flags[0], "a plain text");
      out->flags = dictionary_.Decode(flags[0]);
    }
    sparql::RegexTree tree;
    const auto mistake = sparql::ParseRegex(out->pattern.lexical, out->flags.lexical, &tree);
    if (!mistake) return true;
    const bool of_flags = mistake->where == sparql::RegexMistake::Where::kFlags;
    Report(node, of_flags ? "flags" : "pattern",
           Concat(of_flags ? "sh:flags " : "sh:pattern ", Show(of_flags ? flags[0] : value),
                  " cannot be evaluated: ", mistake->message),
           mistake->hint);
    return false;
  }

  bool ReadTermList(const std::string& name, TermId node, TermId head, Constraint* out) {
    std::optional<std::vector<TermId>> members = paths_.ReadList(head);
    if (!members) {
      Report(node, name, Concat("ill-formed sh:", name, ": ", paths_.problem()), "write ( … )");
      return false;
    }
    if (out->component == Component::kIn) {
      out->terms = *std::move(members);
      std::sort(out->terms.begin(), out->terms.end());
      return true;
    }
    for (const TermId tag : *members) {
      if (!tag.IsLiteral() || dictionary_.Datatype(tag) != kXsdString)
        return Wrong(node, name, tag, "a language tag");
      out->languages.push_back(dictionary_.Decode(tag));
    }
    return true;
  }

  bool ReadShapeList(const std::string& name, TermId node, TermId head, Constraint* out) {
    std::optional<std::vector<TermId>> members = paths_.ReadList(head);
    if (!members) {
      Report(node, name, Concat("ill-formed sh:", name, ": ", paths_.problem()),
             "write ( ex:Shape1 ex:Shape2 )");
      return false;
    }
    for (const TermId member : *members) out->shapes.push_back(IndexOf(member));
    return true;
  }

  // Section 4.7.3: a shape, the number of values that must conform to it, and whether those of sibling shapes
  // are excluded.
  void ReadQualified(Shape* shape) {
    const std::vector<TermId> shapes = Values(shape->node, "qualifiedValueShape");
    const std::vector<TermId> least = Values(shape->node, "qualifiedMinCount");
    const std::vector<TermId> most = Values(shape->node, "qualifiedMaxCount");
    if (shapes.empty() && least.empty() && most.empty()) return;
    if (shapes.empty()) {  // without all its parameters it is ignored (test qualified-001 of the suite)
      return Report(shape->node, least.empty() ? "qualifiedMaxCount" : "qualifiedMinCount",
                    "a qualified count without sh:qualifiedValueShape says nothing",
                    "add the shape whose values count, or write sh:minCount or sh:maxCount",
                    Diagnostic::Severity::kWarning);
    }
    if (!shape->is_property) {
      return Report(shape->node, "qualifiedValueShape", "sh:qualifiedValueShape at a node shape",
                    "it counts a property's values: put it into a sh:property with its sh:path");
    }
    if (shapes.size() != 1 || least.size() > 1 || most.size() > 1) {
      return Report(
          shape->node, "qualifiedValueShape",
          "needs one sh:qualifiedValueShape, and at most one sh:qualifiedMinCount and sh:qualifiedMaxCount",
          "write a property shape for each");
    }
    if (least.empty() && most.empty()) {
      return Report(shape->node, "qualifiedValueShape", "sh:qualifiedValueShape without a count says nothing",
                    "add sh:qualifiedMinCount or sh:qualifiedMaxCount", Diagnostic::Severity::kWarning);
    }
    Constraint constraint;
    constraint.shapes = {IndexOf(shapes[0])};
    if (IsTrue(Values(shape->node, "qualifiedValueShapesDisjoint")))
      ReadSiblings(shape->node, shapes[0], &constraint);
    for (const auto& [component, counts] : {std::pair{Component::kQualifiedMinCount, &least},
                                            std::pair{Component::kQualifiedMaxCount, &most}}) {
      if (counts->empty()) continue;
      constraint.component = component;
      if (ReadInteger(shape->node, ParameterName(component), (*counts)[0], &constraint.number)) {
        shape->constraints.push_back(constraint);
      }
    }
  }

  void ReadSiblings(TermId node, TermId own, Constraint* out) {
    absl::flat_hash_set<TermId> siblings;
    for (const TermId parent : graph_.Subjects(Sh("property"), node)) {
      for (const TermId property : Values(parent, "property")) {
        for (const TermId shape : Values(property, "qualifiedValueShape")) siblings.insert(shape);
      }
    }
    siblings.erase(own);
    std::vector<TermId> sorted(siblings.begin(), siblings.end());
    std::sort(sorted.begin(), sorted.end());
    for (const TermId sibling : sorted) out->siblings.push_back(IndexOf(sibling));
  }

  // Section 1.5: a regime that the data do not follow is a failure.
  void CheckEntailment() {
    graph_.ForEach(TermId(), Sh("entailment"), TermId(), [this](const Quad& q) {
      const auto& followed = regimes_.followed;
      if (!q.object.IsIri() ||
          std::find(followed.begin(), followed.end(), dictionary_.Lexical(q.object)) == followed.end()) {
        Report(q.subject, "entailment",
               Concat("the entailment regime ", Show(q.object),
                      " is not followed here, and a validation needs it"),
               "put the rule set of that regime in use at the server, rdfs or owl2rl, or remove the triple",
               regimes_.otherwise);
      }
      return true;
    });
  }

  // Reports triples with words of the sh: namespace that have no effect.
  void CheckWords() {
    for (const TermId predicate : graph_.version().predicates()) {
      const std::string_view iri = dictionary_.Lexical(predicate);
      if (!iri.starts_with(kShaclNs) || predicate == Sh("entailment")) continue;
      const std::string word(iri.substr(kShaclNs.size()));
      TermId last;
      graph_.ForEach(TermId(), predicate, TermId(), [&](const Quad& q) {
        const bool own = q.subject.IsIri() && dictionary_.Lexical(q.subject).starts_with(kShaclNs);
        if (q.subject != last && !own) CheckWord(q.subject, word);
        last = q.subject;
        return parsed_.diagnostics.size() < limits_.check_diagnostics;
      });
    }
    for (const TermId node : unused_nodes_) {
      Report(node, "", "is never used: it has no target, and no shape refers to it",
             "give it a target such as sh:targetClass, or the type sh:NodeShape or sh:PropertyShape",
             Diagnostic::Severity::kWarning);
    }
    for (const char* type : {"SPARQLFunction", "JSFunction", "JSConstraint", "JSValidator", "JSRule"}) {
      for (const TermId node : graph_.Subjects(type_, Sh(type))) {
        Report(node, "", Concat("sh:", type, " is not evaluated"),
               "write its pattern into the queries that call it", Diagnostic::Severity::kWarning);
      }
    }
  }

  void CheckWord(TermId node, const std::string& word) {
    const uint8_t roles = roles_.Of(node);
    std::string message, hint;
    switch (UseOf(word, roles)) {
      case WordUse::kSays:
        return;
      case WordUse::kElsewhere:
        if (roles == 0 && MakesAShape(word)) {
          unused_nodes_.insert(node);
          return;
        }
        message = Concat("sh:", word, " says nothing here");
        hint = Concat("it says something at ", PlaceOfWord(word));
        break;
      case WordUse::kNotEvaluated:
        message = Concat("sh:", word, " is not evaluated");
        hint = std::string(AdviceFor(word));
        break;
      case WordUse::kUnknown: {
        const std::string nearest = Nearest(word, ShapeWords());
        message = Concat("sh:", word, " is not known and says nothing");
        hint = nearest.empty() ? "see SHACL section 4" : Concat("did you mean sh:", nearest, "?");
      }
    }
    Report(node, word, std::move(message), std::move(hint), Diagnostic::Severity::kWarning);
  }

  void CheckOrder() {
    const ShapeOrder order = OrderShapes(parsed_.shapes);
    if (!order.cycle.empty()) {
      std::string cycle;
      for (const ShapeIndex index : order.cycle) {
        absl::StrAppend(&cycle, Show(parsed_.shapes.shapes[index].node), " → ");
      }
      const TermId first = parsed_.shapes.shapes[order.cycle[0]].node;
      return Report(
          first, "", Concat("refers to itself: ", cycle, Show(first)),
          "SHACL does not say what recursive shapes mean (section 3.4.3); use a property path such as "
          "[ sh:zeroOrMorePath ex:p ], or give one shape a target of its own");
    }
    if (order.depth > limits_.shape_nesting) {
      Report(parsed_.shapes.shapes[order.deepest].node, "",
             absl::StrCat("shapes refer to each other ", order.depth, " deep; the limit shape_nesting is ",
                          limits_.shape_nesting),
             "give inner shapes targets of their own");
    }
  }

  const GraphView& graph_;
  const Dictionary& dictionary_;
  const CheckLimits& limits_;
  const SourceMap* places_;
  const Regimes& regimes_;
  PathReader paths_;
  const TermId type_;
  NodeRoles roles_;
  SparqlReader sparql_;
  absl::btree_set<TermId> unused_nodes_;  // nodes that look like shapes and are not used
  absl::flat_hash_map<TermId, ShapeIndex> index_;
  std::deque<ShapeIndex> waiting_;
  ParsedShapes parsed_;
};

}  // namespace

ParsedShapes ReadShapes(const GraphView& graph, const Dictionary& dictionary, const CheckLimits& limits,
                        const SourceMap* places, const sparql::FunctionRegistry* functions,
                        const Regimes& regimes) {
  return ShapeReader(graph, dictionary, limits, places, functions, regimes).Run();
}

}  // namespace docent::shapes
