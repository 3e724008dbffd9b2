#include "reasoner/shapes/sparql_reader.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <set>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/syntax/parser.h"

namespace docent::shapes {
namespace {

// Section 6.2.1: names that parameters must not have.
constexpr std::array<std::string_view, 6> kReserved = {"this", "shapesGraph", "currentShape",
                                                       "path", "PATH",        "value"};

// "maxLength" of <http://example.org/ns#maxLength>.
std::string LocalName(std::string_view iri) {
  const size_t end = iri.find_last_of("#/:");
  return std::string(end == std::string_view::npos ? iri : iri.substr(end + 1));
}

// SPARQL's VARNAME, in ASCII.
bool IsVariableName(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' ||
           static_cast<unsigned char>(c) >= 0x80;
  });
}

bool Mentions(const std::vector<std::string>& variables, std::string_view name) {
  return std::find(variables.begin(), variables.end(), name) != variables.end();
}

}  // namespace

SparqlReader::SparqlReader(const GraphView& graph, const Dictionary& dictionary,
                           const sparql::FunctionRegistry* functions, NodeRoles& roles, Tell tell)
    : graph_(graph),
      dictionary_(dictionary),
      functions_(functions),
      roles_(roles),
      tell_(std::move(tell)),
      components_(ReadDeclared("ConstraintComponent")),
      target_types_(ReadDeclared("TargetType")) {}

bool SparqlReader::IsTrue(TermId node, std::string_view local) const {
  const std::vector<TermId> values = Values(node, local);
  return std::any_of(values.begin(), values.end(),
                     [](TermId id) { return id.tag() == TermId::Tag::kBoolean && InlineBoolean(id); });
}

// Instances of the class sh:local and of its subclasses in the shapes graph.
std::vector<TermId> SparqlReader::InstancesOf(std::string_view local) const {
  std::vector<TermId> classes = {Sh(local)};
  if (local == "TargetType") classes.push_back(Sh("SPARQLTargetType"));
  const TermId type = Id(kRdfType), sub_class_of = Id(Concat(kRdfsNs, "subClassOf"));
  std::vector<TermId> instances;
  absl::flat_hash_set<TermId> seen(classes.begin(), classes.end());
  for (size_t i = 0; i < classes.size(); ++i) {
    for (const TermId sub : graph_.Subjects(sub_class_of, classes[i])) {
      if (seen.insert(sub).second) classes.push_back(sub);
    }
    for (const TermId node : graph_.Subjects(type, classes[i])) instances.push_back(node);
  }
  std::sort(instances.begin(), instances.end());
  instances.erase(std::unique(instances.begin(), instances.end()), instances.end());
  return instances;
}

std::vector<SparqlReader::Declared> SparqlReader::ReadDeclared(std::string_view type) {
  std::vector<Declared> all;
  for (const TermId node : InstancesOf(type)) {
    if (node.IsIri() && dictionary_.Lexical(node).starts_with(kShaclNs)) continue;  // SHACL's own vocabulary
    roles_.Add(node, NodeRole::kComponent);
    Declared& declared = all.emplace_back();
    declared.node = node;
    ReadParameters(&declared);
    for (const char* word : {"validator", "nodeValidator", "propertyValidator"}) {
      for (const TermId validator : Values(node, word)) roles_.Add(validator, NodeRole::kValidator);
    }
  }
  return all;
}

// Section 6.2.1.
void SparqlReader::ReadParameters(Declared* declared) {
  const auto wrong = [declared](TermId node, std::string_view local, std::string message, std::string hint) {
    declared->problems.push_back({node, std::string(local), std::move(message), std::move(hint)});
  };
  for (const TermId node : Values(declared->node, "parameter")) {
    roles_.Add(node, NodeRole::kParameter);
    const std::vector<TermId> paths = Values(node, "path");
    if (paths.size() != 1 || !paths[0].IsIri()) {
      wrong(node, "path", "a parameter needs one sh:path, an IRI", "write sh:parameter [ sh:path ex:p ]");
      continue;
    }
    Parameter parameter{paths[0], LocalName(dictionary_.Lexical(paths[0])), IsTrue(node, "optional")};
    if (!IsVariableName(parameter.variable)) {
      wrong(node, "path", Concat("the local name of ", Show(paths[0]), " is not a valid variable name"),
            "choose an IRI that ends in letters and digits");
    } else if (std::find(kReserved.begin(), kReserved.end(), parameter.variable) != kReserved.end()) {
      wrong(node, "path", Concat("a parameter cannot be called ", parameter.variable),
            "SHACL gives that variable a meaning of its own: choose another IRI");
    }
    const auto same = [&](const Parameter& other) { return other.variable == parameter.variable; };
    if (std::any_of(declared->parameters.begin(), declared->parameters.end(), same)) {
      wrong(declared->node, "parameter", Concat("two parameters are called ", parameter.variable),
            "their IRIs must end in different names");
    }
    declared->parameters.push_back(std::move(parameter));
  }
  const bool mandatory = std::any_of(declared->parameters.begin(), declared->parameters.end(),
                                     [](const Parameter& p) { return !p.optional; });
  if (!mandatory) {
    wrong(declared->node, "parameter", "has no parameter that is not optional, so no shape can use it",
          "add sh:parameter [ sh:path ex:p ]");
  }
}

std::vector<TermId> SparqlReader::Messages(TermId node) {
  std::vector<TermId> messages;
  for (const TermId message : Values(node, "message")) {
    const std::string_view datatype =
        message.IsLiteral() ? dictionary_.Datatype(message) : std::string_view();
    if (datatype == kXsdString || datatype == kRdfLangString) {
      messages.push_back(message);
    } else {
      Error(node, "message", Concat("sh:message is ", Show(message), ", which is not a text"),
            "write \"text\"");
    }
  }
  return messages;
}

// Section 5.2.1: sh:prefixes/owl:imports*/sh:declare.
std::optional<SparqlReader::Prefixes> SparqlReader::PrefixesOf(TermId node) {
  std::vector<TermId> holders = Values(node, "prefixes");
  absl::flat_hash_set<TermId> seen(holders.begin(), holders.end());
  std::map<std::string, std::string> found;
  bool ok = true;
  for (size_t i = 0; i < holders.size(); ++i) {
    for (const TermId imported : graph_.Objects(holders[i], Id(Concat(kOwlNs, "imports")))) {
      if (seen.insert(imported).second) holders.push_back(imported);
    }
    for (const TermId declaration : Values(holders[i], "declare")) {
      const std::vector<TermId> names = Values(declaration, "prefix"),
                                iris = Values(declaration, "namespace");
      if (names.size() != 1 || iris.size() != 1 || !names[0].IsLiteral() || !iris[0].IsLiteral()) {
        Error(declaration, "", "a declaration needs one sh:prefix and one sh:namespace",
              "write sh:declare [ sh:prefix \"ex\" ; sh:namespace \"http://example.org/\"^^xsd:anyURI ]");
        ok = false;
        continue;
      }
      const std::string name = dictionary_.Decode(names[0]).lexical,
                        iri = dictionary_.Decode(iris[0]).lexical;
      const auto [place, is_new] = found.try_emplace(name, iri);
      if (is_new || place->second == iri) continue;
      Error(node, "prefixes",
            Concat("the prefix ", name, ": stands for <", place->second, "> and for <", iri, ">"),
            "declare it once");
      ok = false;
    }
  }
  if (!ok) return std::nullopt;
  return Prefixes(found.begin(), found.end());
}

std::shared_ptr<ShapeQuery> SparqlReader::ReadQuery(TermId node, std::string_view word,
                                                    const GivenVariables& given, const Path* path) {
  const std::vector<TermId> texts = Values(node, word);
  if (texts.size() != 1 || !texts[0].IsLiteral() || dictionary_.Datatype(texts[0]) != kXsdString) {
    Error(node, word, Concat("needs one sh:", word, ", a text in SPARQL"),
          Concat("write sh:", word, " \"\"\"", word == "ask" ? "ASK" : "SELECT $this WHERE", " { … }\"\"\""));
    return nullptr;
  }
  const std::optional<Prefixes> prefixes = PrefixesOf(node);
  if (!prefixes) return nullptr;
  sparql::ParseOptions options;
  options.prefixes = *prefixes;
  options.functions = functions_;
  sparql::ParsedQuery parsed = sparql::ParseQuery(dictionary_.Decode(texts[0]).lexical, options);
  const auto tell = [&](const Diagnostics& found) {
    for (const Diagnostic& d : found) {
      if (d.severity != Diagnostic::Severity::kError) continue;
      Error(node, word,
            absl::StrCat("sh:", std::string(word), ", line ", d.span.line, ", column ", d.span.column, ": ",
                         d.message),
            d.hint);
    }
    return !HasErrors(found);
  };
  if (!tell(parsed.diagnostics)) return nullptr;
  sparql::Query& query = parsed.query;
  const bool ask = word == "ask";
  if (query.form != (ask ? sparql::Query::Form::kAsk : sparql::Query::Form::kSelect)) {
    Error(node, word, Concat("sh:", word, " is no ", ask ? "ASK" : "SELECT"), "");
    return nullptr;
  }
  if (!query.from.empty() || !query.from_named.empty()) {
    Error(node, word, Concat("sh:", word, " has FROM; it always asks the data graph"), "leave FROM out");
    return nullptr;
  }
  const bool this_is_projected = std::any_of(query.projection.begin(), query.projection.end(),
                                             [](const sparql::Variable& v) { return v.name == "this"; });
  if (!ask && !this_is_projected) {
    Error(node, word, "sh:select does not select ?this", "write SELECT $this … WHERE { … }");
    return nullptr;
  }
  if (!given.required.empty() && !tell(CheckGiven(query, given))) return nullptr;
  auto read = std::make_shared<ShapeQuery>();
  if (Mentions(VariablesOf(query), "PATH")) {
    if (path == nullptr) {
      Error(node, word, "$PATH has no meaning here: only a property shape has a path", "name the property");
      return nullptr;
    }
    if (!tell(SubstitutePath(*path, dictionary_, &query))) return nullptr;
  }
  read->variables = VariablesOf(query);
  read->query = std::move(query);
  read->messages = Messages(node);
  read->node = node;
  asks_shapes_graph_ = asks_shapes_graph_ || Mentions(read->variables, "shapesGraph");
  return read;
}

void SparqlReader::ReadConstraints(Shape* shape) {
  for (const TermId node : Values(shape->node, "sparql")) ReadSparql(shape, node);
  for (Declared& component : components_) ReadOwn(shape, &component);
}

// Section 5.2.
void SparqlReader::ReadSparql(Shape* shape, TermId node) {
  if (node.IsLiteral())
    return Error(shape->node, "sparql", Concat("sh:sparql is ", Show(node), ", not a constraint"),
                 "write sh:sparql [ sh:select \"…\" ]");
  roles_.Add(node, NodeRole::kConstraint);
  if (IsTrue(node, "deactivated")) return;
  auto query = ReadQuery(node, "select", {.required = {"this"}}, shape->is_property ? &shape->path : nullptr);
  if (query == nullptr) return;
  Constraint constraint;
  constraint.component = Component::kSparql;
  constraint.query = std::move(query);
  shape->constraints.push_back(std::move(constraint));
}

std::vector<SparqlReader::ArgumentList> SparqlReader::ArgumentsAt(TermId node, Declared* declared) {
  std::vector<std::vector<TermId>> values;
  bool any = false;
  const Parameter* missing = nullptr;
  for (const Parameter& parameter : declared->parameters) {
    values.push_back(graph_.Objects(node, parameter.path));
    any = any || !values.back().empty();
    if (values.back().empty() && !parameter.optional) missing = &parameter;
  }
  if (!any) return {};
  declared->used = true;
  for (const Problem& problem : declared->problems) {
    Error(problem.node, problem.local, Concat("of ", Show(declared->node), ": ", problem.message),
          problem.hint);
  }
  if (!declared->problems.empty()) return {};
  if (missing != nullptr) {
    Warn(node, "",
         Concat("has values for ", Show(declared->node), ", but none for ", Show(missing->path),
                "; it is not checked"),
         "add the missing value");
    return {};
  }
  std::vector<ArgumentList> all;
  if (values.size() == 1) {  // section 6.1: each value of a single parameter is a constraint
    for (const TermId value : values[0]) all.push_back({{declared->parameters[0].variable, value}});
    return all;
  }
  ArgumentList& one = all.emplace_back();
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i].size() > 1) {
      Error(node, "",
            absl::StrCat("has ", values[i].size(), " values of ", Show(declared->parameters[i].path),
                         "; a component with several parameters takes one"),
            "write a shape for each");
      return {};
    }
    if (!values[i].empty()) one.emplace_back(declared->parameters[i].variable, values[i][0]);
  }
  return all;
}

// Section 6.3. Validators in other languages (such as a sh:JSValidator) are ignored.
TermId SparqlReader::ValidatorFor(const Shape& shape, const Declared& component) {
  for (const char* word : {shape.is_property ? "propertyValidator" : "nodeValidator", "validator"}) {
    for (const TermId validator : Values(component.node, word)) {
      if (!Values(validator, "ask").empty() || !Values(validator, "select").empty()) return validator;
    }
  }
  return TermId();
}

GivenVariables SparqlReader::GivenOf(const Declared& declared, bool constraint, bool ask) {
  GivenVariables given;
  if (constraint) given.required.push_back("this");
  if (ask) given.required.push_back("value");
  for (const Parameter& parameter : declared.parameters) given.required.push_back(parameter.variable);
  return given;
}

void SparqlReader::ReadOwn(Shape* shape, Declared* component) {
  const std::vector<ArgumentList> arguments = ArgumentsAt(shape->node, component);
  if (arguments.empty()) return;
  const TermId validator = ValidatorFor(*shape, *component);
  if (validator.IsNone()) {
    return Warn(shape->node, "",
                Concat(Show(component->node), " has no validator in SPARQL for ",
                       shape->is_property ? "property" : "node", " shapes; it is not checked"),
                Concat("add sh:validator [ sh:ask \"…\" ] or sh:",
                       shape->is_property ? "propertyValidator" : "nodeValidator", " [ sh:select \"…\" ]"));
  }
  const bool ask = !Values(validator, "ask").empty();
  const auto query = ReadQuery(validator, ask ? "ask" : "select", GivenOf(*component, true, ask),
                               shape->is_property ? &shape->path : nullptr);
  if (query == nullptr) return;
  const std::vector<TermId> component_messages = Messages(component->node);
  for (const ArgumentList& values : arguments) {
    auto own = std::make_shared<ShapeQuery>();
    own->query = query->query.Clone();
    own->variables = query->variables;
    own->messages = query->messages;
    own->node = query->node;
    own->parameters = values;
    own->component_messages = component_messages;
    own->component = component->node;
    Constraint constraint;
    constraint.component = Component::kOwn;
    constraint.query = std::move(own);
    shape->constraints.push_back(std::move(constraint));
  }
}

// SHACL Advanced Features, section 3.
void SparqlReader::ReadTargets(Shape* shape) {
  const TermId type = Id(kRdfType);
  for (const TermId target : Values(shape->node, "target")) {
    roles_.Add(target, NodeRole::kTarget);
    if (!Values(target, "select").empty()) {
      auto query = ReadQuery(target, "select", {.required = {}, .optional = {}}, nullptr);
      if (query == nullptr) continue;
      query->is_target = true;
      shape->target_queries.push_back(std::move(query));
      continue;
    }
    const std::vector<TermId> types =
        target.IsLiteral() ? std::vector<TermId>() : graph_.Objects(target, type);
    bool known = false;
    for (Declared& declared : target_types_) {
      if (std::find(types.begin(), types.end(), declared.node) == types.end()) continue;
      known = true;
      for (ArgumentList& values : ArgumentsAt(target, &declared)) {
        auto query = ReadQuery(declared.node, "select", GivenOf(declared, false, false), nullptr);
        if (query == nullptr) continue;
        query->parameters = std::move(values);
        query->is_target = true;
        shape->target_queries.push_back(std::move(query));
      }
    }
    if (!known) {
      Warn(shape->node, "target",
           Concat("sh:target ", Show(target), " is not evaluated: it has no sh:select"),
           "write sh:target [ a sh:SPARQLTarget ; sh:select \"SELECT ?this WHERE { … }\" ]");
    }
  }
}

void SparqlReader::CheckUnused() {
  lenient_ = true;
  for (const std::vector<Declared>* all : {&components_, &target_types_}) {
    for (const Declared& declared : *all) {
      if (declared.used) continue;
      for (const Problem& problem : declared.problems) {
        Error(problem.node, problem.local, Concat("of ", Show(declared.node), ": ", problem.message),
              problem.hint);
      }
      CheckQueries(declared, all == &components_);
    }
  }
  lenient_ = false;
}

// Any path is good enough for the checks of $PATH.
void SparqlReader::CheckQueries(const Declared& declared, bool constraint) {
  if (!constraint) {
    ReadQuery(declared.node, "select", GivenOf(declared, false, false), nullptr);
    return;
  }
  Path any;
  any.predicate = Sh("parameter");
  bool none = true;
  for (const char* word : {"validator", "nodeValidator", "propertyValidator"}) {
    for (const TermId validator : Values(declared.node, word)) {
      const bool ask = !Values(validator, "ask").empty();
      if (!ask && Values(validator, "select").empty()) continue;
      none = false;
      ReadQuery(validator, ask ? "ask" : "select", GivenOf(declared, true, ask),
                std::string_view(word) == "nodeValidator" || any.predicate == kAbsentTerm ? nullptr : &any);
    }
  }
  if (none) {
    Error(declared.node, "", "a component without a validator in SPARQL is not checked",
          "add sh:validator [ sh:ask \"…\" ]");
  }
}

}  // namespace docent::shapes
