#include "kb_server/robots/robot_facts.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "graph/store/own_states.h"
#include "graph/store/server_graphs.h"

namespace docent::server {
namespace {

constexpr std::string_view kKeptOfOffline[] = {"x",      "y",           "heading",
                                               "status", "incarnation", "adapterAddress"};

// Changes of what one robot tells, beside what it told before.
class RobotFacts {
 public:
  RobotFacts(const std::string& robot, const Dictionary& dictionary, const GraphVersion& version)
      : robot_(robot), dictionary_(dictionary), version_(version) {
    batch_.source = robot;
  }

  // The object, and of those that were told before nothing else.
  void Replace(const std::string& subject, std::string_view predicate, const Term& object) {
    Replace(subject, predicate, std::vector<Term>{object});
  }
  void Replace(const std::string& subject, std::string_view predicate, const std::vector<Term>& objects) {
    for (const Term& told : Told(subject, predicate)) {
      if (std::find(objects.begin(), objects.end(), told) == objects.end())
        Change(QuadOperation::Kind::kRemove, subject, predicate, told);
    }
    for (const Term& object : objects) Change(QuadOperation::Kind::kAdd, subject, predicate, object);
  }
  void Add(const std::string& subject, std::string_view predicate, Term object) {
    Change(QuadOperation::Kind::kAdd, subject, predicate, std::move(object));
  }
  void RemoveStates() {
    const std::optional<TermId> robot = dictionary_.FindIri(robot_);
    const std::optional<TermId> type = dictionary_.FindIri(kRdfType);
    const std::optional<TermId> state = dictionary_.FindIri(DocentIri("StateProperty"));
    if (!robot) return;
    const auto is_state = [&](const Quad& quad, const std::string& predicate) {
      return IsOwnState(predicate) ||
             (type && state && version_.ContainsMatch({quad.predicate, *type, *state, {}}));
    };
    version_.ForEach({*robot, {}, {}, *robot}, [&](const Quad& quad) {
      const std::string predicate = dictionary_.Decode(quad.predicate).lexical;
      const bool kept = std::any_of(std::begin(kKeptOfOffline), std::end(kKeptOfOffline),
                                    [&](std::string_view local) { return predicate == DocentIri(local); });
      if (!kept && is_state(quad, predicate))
        Change(QuadOperation::Kind::kRemove, robot_, predicate, dictionary_.Decode(quad.object));
      return true;
    });
  }
  WriteBatch Take() { return std::move(batch_); }

  // In the robot's own graph.
  std::vector<Term> Told(const std::string& subject, std::string_view predicate) const {
    std::vector<Term> objects;
    const auto s = dictionary_.FindIri(subject), p = dictionary_.FindIri(predicate),
               graph = dictionary_.FindIri(robot_);
    if (!s || !p || !graph) return objects;
    version_.ForEach({*s, *p, {}, *graph}, [&](const Quad& quad) {
      objects.push_back(dictionary_.Decode(quad.object));
      return true;
    });
    return objects;
  }

 private:
  void Change(QuadOperation::Kind kind, const std::string& subject, std::string_view predicate, Term object) {
    batch_.operations.push_back(
        {kind, {Term::Iri(subject), Term::Iri(std::string(predicate)), std::move(object), Term()}});
  }

  const std::string& robot_;
  const Dictionary& dictionary_;
  const GraphVersion& version_;
  WriteBatch batch_;
};

// Why the name cannot be taken; nullopt: it can, and is new among `names`.
std::optional<std::string> FaultOf(const std::string& name, std::set<std::string>* names) {
  if (name.find_first_not_of(" \t\r\n") == std::string::npos) return "is empty";
  if (std::optional<std::string> fault = NameFault(name)) return fault;
  if (name.front() == ' ' || name.back() == ' ')
    return "begins or ends with a blank, which documents do not keep";
  if (!names->insert(name).second) return "stands twice";
  return std::nullopt;
}

// Of what is too long to be shown, the beginning.
std::string Shown(const std::string& name) {
  constexpr size_t kShown = 60;
  return Concat("\"", name.substr(0, kShown), name.size() <= kShown ? "\"" : "…\"");
}

void TakeParts(const std::string& operation, std::string_view what, std::vector<std::string>* parts,
               std::vector<std::string>* warnings) {
  std::set<std::string> names;
  std::erase_if(*parts, [&](const std::string& part) {
    const std::optional<std::string> fault = FaultOf(part, &names);
    if (fault) {
      warnings->push_back(absl::StrCat(ToAbsl(what), " ", Shown(part), " of operation ", operation, " ",
                                       *fault, "; it is left out"));
    }
    return fault.has_value();
  });
}

// The types of `parts`, in full.
void TakeTypes(const std::string& operation, const std::vector<std::string>& parts, rsel::PartTypes* types,
               std::vector<std::string>* warnings) {
  rsel::PartTypes taken;
  for (const auto& [part, given] : *types) {
    const std::string type = rsel::FullType(given);
    if (type.empty() || std::find(parts.begin(), parts.end(), part) == parts.end()) continue;
    if (IsValidTermIri(type)) {
      taken.emplace(part, type);
    } else {
      warnings->push_back(absl::StrCat("the type ", Shown(type), " of part ", part, " of operation ",
                                       operation, " is not an absolute IRI; the part has no type"));
    }
  }
  *types = std::move(taken);
}

void TakeCapabilities(OperationDescription* operation, std::vector<std::string>* warnings) {
  std::vector<std::string> taken;
  for (const std::string& given : operation->capabilities) {
    const std::string iri = rsel::FullType(given);
    if (!IsValidTermIri(iri)) {
      warnings->push_back(absl::StrCat("capability ", Shown(given), " of operation ", operation->name,
                                       " is not an absolute IRI; it is left out"));
    } else if (std::find(taken.begin(), taken.end(), iri) == taken.end()) {
      taken.push_back(iri);
    }
  }
  operation->capabilities = std::move(taken);
}

// Operation and its parts in the robot's own graph.
void TellParts(const std::string& operation, std::string_view direction,
               const std::vector<std::string>& parts, const rsel::PartTypes& types, RobotFacts* facts) {
  std::vector<Term> names, typed;
  for (const std::string& part : parts) {
    names.push_back(Term::Literal(part));
    const auto type = types.find(part);
    if (type == types.end()) continue;
    const std::string iri = Concat(operation, "/", direction, "/", IriSegment(part));
    typed.push_back(Term::Iri(iri));
    facts->Add(iri, kRdfType, Term::Iri(DocentIri("Part")));
    facts->Add(iri, DocentIri("partName"), Term::Literal(part));
    facts->Replace(iri, DocentIri("partType"), Term::Iri(type->second));
  }
  const std::string property = Concat(direction, "Part");
  for (const Term& before : facts->Told(operation, DocentIri(property))) {
    if (std::find(typed.begin(), typed.end(), before) != typed.end()) continue;
    for (const std::string& predicate : {std::string(kRdfType), DocentIri("partName"), DocentIri("partType")})
      facts->Replace(before.lexical, predicate, std::vector<Term>());
  }
  facts->Replace(operation, DocentIri(direction), names);
  facts->Replace(operation, DocentIri(property), typed);
}

}  // namespace

std::string RobotNameFault(const std::string& robot) {
  constexpr std::string_view kOwnNames = "urn:docent:";
  const bool own = robot.starts_with(kDocentNs) || robot.starts_with(kOwnNames) || IsServerGraph(robot) ||
                   IsModuleGraph(robot);
  if (!own) return "";
  return absl::StrCat("<", robot, "> is a name of the server's own; give the robot another IRI");
}

RobotDescription AcceptedDescription(RobotDescription description, std::vector<std::string>* warnings) {
  std::set<std::string> names;
  std::vector<OperationDescription> operations;
  for (OperationDescription& operation : description.operations) {
    if (const std::optional<std::string> fault = FaultOf(operation.name, &names)) {
      warnings->push_back(absl::StrCat("the name of operation ", Shown(operation.name), " ", *fault,
                                       "; the operation is left out"));
      continue;
    }
    TakeParts(operation.name, "input", &operation.inputs, warnings);
    TakeParts(operation.name, "output", &operation.outputs, warnings);
    TakeParts(operation.name, "resource", &operation.occupies, warnings);
    TakeTypes(operation.name, operation.inputs, &operation.input_types, warnings);
    TakeTypes(operation.name, operation.outputs, &operation.output_types, warnings);
    TakeCapabilities(&operation, warnings);
    operations.push_back(std::move(operation));
  }
  description.operations = std::move(operations);
  std::string& type = description.type;
  if (!type.empty() && !IsValidTermIri(type)) {
    warnings->push_back(
        absl::StrCat("the type ", Shown(type), " is not an absolute IRI; docent:Robot is taken"));
    type.clear();
  }
  return description;
}

WriteBatch FactsOfJoin(const RobotDescription& description, const Dictionary& dictionary,
                       const GraphVersion& version) {
  const std::string& robot = description.robot;
  RobotFacts facts(robot, dictionary, version);
  facts.Add(robot, kRdfType, Term::Iri(DocentIri("Robot")));
  if (!description.type.empty()) facts.Add(robot, kRdfType, Term::Iri(description.type));
  if (!description.label.empty())
    facts.Replace(robot, Concat(kRdfsNs, "label"), Term::Literal(description.label));
  facts.Replace(robot, DocentIri("incarnation"), Term::Literal(description.incarnation));
  facts.Replace(robot, DocentIri("adapterAddress"), Term::Literal(description.address));
  facts.Replace(robot, DocentIri("lastSeenAt"), std::vector<Term>());
  const std::string status = GraphReader(dictionary, version).Object(robot, DocentIri("status"));
  if (status.empty() || status == DocentIri("Offline"))
    facts.Replace(robot, DocentIri("status"), Term::Iri(DocentIri("Standby")));
  std::vector<Term> offers, capabilities;
  for (const OperationDescription& operation : description.operations) {
    const std::string iri = OperationIri(operation.name);
    offers.push_back(Term::Iri(iri));
    facts.Add(iri, kRdfType, Term::Iri(DocentIri("Operation")));
    facts.Add(iri, Concat(kRdfsNs, "label"), Term::Literal(operation.name));
    facts.Replace(iri, DocentIri("idempotent"), Term::Boolean(operation.idempotent));
    if (!operation.description.empty())
      facts.Replace(iri, Concat(kRdfsNs, "comment"), Term::Literal(operation.description));
    TellParts(iri, "input", operation.inputs, operation.input_types, &facts);
    TellParts(iri, "output", operation.outputs, operation.output_types, &facts);
    facts.Replace(iri, DocentIri("inputsKnown"), Term::Boolean(true));
    std::vector<Term> occupies;
    for (const std::string& resource : operation.occupies) occupies.push_back(Term::Literal(resource));
    facts.Replace(iri, DocentIri("occupies"), occupies);
    std::vector<Term> classes;
    for (const std::string& capability : operation.capabilities) classes.push_back(Term::Iri(capability));
    facts.Replace(iri, DocentIri("capability"), classes);
    for (const Term& capability : classes) {
      if (std::find(capabilities.begin(), capabilities.end(), capability) == capabilities.end())
        capabilities.push_back(capability);
    }
  }
  facts.Replace(robot, DocentIri("hasCapability"), capabilities);
  facts.Replace(robot, DocentIri("offers"), offers);
  return facts.Take();
}

bool HasFacts(const WriteBatch& told, const Dictionary& dictionary, const GraphVersion& version) {
  const std::optional<TermId> graph = dictionary.FindIri(told.source);
  return graph && std::all_of(told.operations.begin(), told.operations.end(), [&](const QuadOperation& o) {
           if (o.kind != QuadOperation::Kind::kAdd) return true;
           const auto s = dictionary.Find(o.quad.subject), p = dictionary.Find(o.quad.predicate),
                      object = dictionary.Find(o.quad.object);
           return s && p && object && version.ContainsMatch({*s, *p, *object, *graph});
         });
}

WriteBatch FactsOfLoss(const std::string& robot, TimeMicros seen_us, const Dictionary& dictionary,
                       const GraphVersion& version) {
  RobotFacts facts(robot, dictionary, version);
  facts.Replace(robot, DocentIri("status"), Term::Iri(DocentIri("Offline")));
  if (seen_us != 0) facts.Replace(robot, DocentIri("lastSeenAt"), DateTimeTerm(seen_us));
  facts.RemoveStates();
  return facts.Take();
}

}  // namespace docent::server
