#include "workflow/rsel/generator.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/iri_names.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/rsel/type_checks.h"
#include "workflow/xml/element_reader.h"
#include "workflow/xml/formatter.h"
#include "workflow/xml/term_text.h"

namespace docent::rsel {
namespace {

// For attribute values and text (XML 1.0 section 2.4). Characters that XML cannot hold are left out.
std::string Escaped(std::string_view text) {
  std::string kept;
  for (const char c : text) {
    if (c == '\n' || c == '\t') {
      kept += ' ';
    } else if (static_cast<unsigned char>(c) >= 0x20) {
      kept += c;
    }
  }
  return xml::XmlEscaped(kept);
}

// Types as they stand in a document, and the prefixes that they need.
class TypeWriter {
 public:
  // " type=\"docent:Booth\"", or nothing.
  std::string Attribute(const std::string& type) {
    if (type.empty()) return "";
    const size_t end = type.find_last_of("#/");
    const std::string name_space = type.substr(0, end == std::string::npos ? 0 : end + 1);
    const std::string local = type.substr(name_space.size());
    if (name_space.empty() || !IsPrefixedName("p", local))
      return Concat(" type=\"&lt;", Escaped(type), "&gt;\"");
    return Concat(" type=\"", PrefixOf(name_space), ":", local, "\"");
  }
  // The declarations: " xmlns:docent=\"…\"".
  std::string Declarations() const {
    std::string out;
    for (const auto& [name_space, prefix] : prefixes_)
      out += Concat(" xmlns:", prefix, "=\"", Escaped(name_space), "\"");
    return out;
  }

 private:
  const std::string& PrefixOf(const std::string& name_space) {
    const auto known = prefixes_.find(name_space);
    if (known != prefixes_.end()) return known->second;
    for (const auto& [prefix, well_known] : kWellKnownPrefixes) {
      if (well_known == name_space) return prefixes_[name_space] = std::string(prefix);
    }
    return prefixes_[name_space] = absl::StrCat("ns", ++own_);
  }

  std::map<std::string, std::string> prefixes_;  // by namespace
  int own_ = 0;
};

// Names that cannot stand in a document as they are.
bool Usable(const OfferedOperation& operation) {
  const auto part = [](const std::string& name) { return xml::IsVariableName(name); };
  return operation.name.find_first_not_of(" \t\r\n") != std::string::npos && !NameFault(operation.name) &&
         std::all_of(operation.inputs.begin(), operation.inputs.end(), part) &&
         std::all_of(operation.outputs.begin(), operation.outputs.end(), part);
}

std::string TypeIn(const PartTypes& types, const std::string& part) {
  const auto found = types.find(part);
  return found == types.end() ? std::string() : found->second;
}

// Parts of a message, in order.
using Parts = std::vector<std::pair<std::string, std::string>>;  // name, type

// One process: the operations one after the other.
class ProcessWriter {
 public:
  explicit ProcessWriter(const std::vector<const OfferedOperation*>& steps) {
    for (const OfferedOperation* step : steps) Add(*step);
  }

  std::string Text(const std::string& name, const std::string& documentation, TypeWriter* types) const {
    const std::string escaped = Escaped(name);
    // An invoke without inputs would be given all parts of the message; without one it is given none.
    const bool has_message = !takes_nothing_ || inputs_.empty();
    std::string out;
    if (has_message) out += Message(escaped + "Request", inputs_, types);
    if (!outputs_.empty()) out += Message(escaped + "Reply", outputs_, types);
    out += Concat("<process name=\"", escaped, "\"");
    if (has_message) out += Concat(" input=\"", escaped, "Request\"");
    if (!outputs_.empty()) out += Concat(" output=\"", escaped, "Reply\"");
    out += ">\n";
    if (!documentation.empty())
      out += Concat("<documentation>", Escaped(documentation), "</documentation>\n");
    return Concat(out, invokes_, "</process>\n");
  }

 private:
  static std::string Message(const std::string& name, const Parts& parts, TypeWriter* types) {
    if (parts.empty()) return Concat("<message name=\"", name, "\"/>\n");
    std::string out = Concat("<message name=\"", name, "\">\n");
    for (const auto& [part, type] : parts)
      out += Concat("<part name=\"", part, "\"", types->Attribute(type), "/>\n");
    return out + "</message>\n";
  }

  void Add(const OfferedOperation& step) {
    takes_nothing_ = takes_nothing_ || step.inputs.empty();
    std::string invoke = Concat("<invoke operation=\"", Escaped(step.name), "\"");
    if (step.inputs.empty() && step.outputs.empty()) {
      invokes_ += invoke + "/>\n";
      return;
    }
    invoke += ">\n";
    for (const std::string& part : step.inputs) {
      const std::string from = Source(step.name, part, TypeIn(step.input_types, part));
      invoke += Concat("<input part=\"", part, "\" from=\"", from, "\"/>\n");
    }
    for (const std::string& part : step.outputs) {
      const std::string to = Target(step.name, part, TypeIn(step.output_types, part));
      invoke += Concat("<output part=\"", part, "\" to=\"", to, "\"/>\n");
    }
    invokes_ += invoke + "</invoke>\n";
  }

  // What the process gives for the part: what has its name, if it may be of its type; otherwise a new part of its input message.
  std::string Source(const std::string& operation, const std::string& part, const std::string& type) {
    for (const std::string& name : {part, OwnName(operation, part)}) {
      const auto known = names_.find(name);
      if (known == names_.end()) {
        names_[name] = type;
        inputs_.emplace_back(name, type);
        return name;
      }
      if (!IsSame(known->second, type)) continue;
      if (known->second.empty()) TakeType(name, type);
      return name;
    }
    return Fresh(part, type, &inputs_);
  }
  // The name under which a result is kept: its own, unless that stands for something of another type.
  std::string Target(const std::string& operation, const std::string& part, const std::string& type) {
    for (const std::string& name : {part, OwnName(operation, part)}) {
      const auto known = names_.find(name);
      if (known != names_.end() && type != known->second) continue;
      names_[name] = type;
      if (!IsIn(name, outputs_)) outputs_.emplace_back(name, type);
      return name;
    }
    return Fresh(part, type, &outputs_);
  }

  // A value of the one type is taken for the other: both are the same, one is not known, or both are datatypes of one kind.
  static bool IsSame(const std::string& a, const std::string& b) {
    return a == b || a.empty() || b.empty() || (IsDatatype(a) && IsDatatype(b) && MayBeOf(a, b));
  }
  // The input that is known without type is of the type that a later operation wants.
  void TakeType(const std::string& name, const std::string& type) {
    for (Parts* parts : {&inputs_, &outputs_}) {
      for (auto& [part, of] : *parts) {
        if (part == name && of.empty()) of = type;
      }
    }
    names_[name] = type;
  }
  std::string Fresh(const std::string& part, const std::string& type, Parts* parts) {
    int number = 2;
    while (names_.contains(absl::StrCat(part, number))) ++number;
    std::string name = absl::StrCat(part, number);
    names_[name] = type;
    parts->emplace_back(name, type);
    return name;
  }
  static bool IsIn(const std::string& name, const Parts& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const auto& part) { return part.first == name; });
  }
  // "moveToBooth_place"; without what a part's name may not hold.
  static std::string OwnName(const std::string& operation, const std::string& part) {
    std::string out;
    for (const char c : operation) {
      const std::string longer = out + c;
      if (xml::IsVariableName(longer)) out = longer;
    }
    return out.empty() ? part + "_2" : Concat(out, "_", part);
  }

  std::map<std::string, std::string> names_;  // what a name stands for at this point → its type
  Parts inputs_, outputs_;
  std::string invokes_;
  bool takes_nothing_ = false;  // an operation without inputs is among them
};

std::string DocumentText(const std::string& name, const std::string& content, const TypeWriter& types) {
  const std::string text =
      Concat("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
             "<!-- Generated from what robots offer. Compose your own from it. -->\n<rsel name=\"",
             Escaped(name), "\" version=\"1.0\"", types.Declarations(), " xmlns:ext=\"", kExtensionNs,
             "\">\n", content, "</rsel>\n");
  const xml::FormattedXml formatted = xml::FormatXml(text, name);
  return formatted.ok() ? formatted.text : text;
}

// A registered service as if it were an operation.
std::optional<OfferedOperation> ServiceAsOperation(const std::string& name, const ServiceRegistry& registry,
                                                   const std::vector<OfferedOperation>& offered) {
  const PlanPtr plan = registry.Find(name);
  if (plan == nullptr) return std::nullopt;
  OfferedOperation out;
  out.name = name;
  out.inputs = plan->inputs;
  for (const auto& [part, source] : plan->outputs) out.outputs.push_back(part);
  ServiceTypes types = TypesOf(*plan, offered);
  out.input_types = std::move(types.inputs);
  out.output_types = std::move(types.outputs);
  return out;
}

absl::Status CheckNames(const GeneratorRequest& request) {
  for (const auto& [what, name] :
       {std::pair("document", &request.name), std::pair("process", &request.process)}) {
    if (name->empty() && name == &request.process) continue;
    if (name->find_first_not_of(" \t\r\n") == std::string::npos)
      return absl::InvalidArgumentError(absl::StrCat("the name of the ", what, " is empty; give one"));
    if (const std::optional<std::string> fault = NameFault(*name))
      return absl::InvalidArgumentError(absl::StrCat("the name of the ", what, " ", *fault));
  }
  return absl::OkStatus();
}

// What there is, of the robot where one is named.
absl::StatusOr<std::vector<OfferedOperation>> OfRobot(const GeneratorRequest& request,
                                                      const std::vector<OfferedOperation>& offered) {
  std::vector<OfferedOperation> of_robot;
  std::set<std::string> robots;
  for (const OfferedOperation& o : offered) {
    robots.insert(Concat("<", o.robot.value(), ">"));
    if (request.robot.empty() || o.robot == request.robot) of_robot.push_back(o);
  }
  if (!of_robot.empty()) return of_robot;
  if (offered.empty())
    return absl::NotFoundError("no robot describes an operation now; start an adapter first");
  return absl::NotFoundError(Concat("robot <", request.robot.value(), "> describes no operation; there are ",
                                    xml::ListOf({robots.begin(), robots.end()})));
}

}  // namespace

absl::StatusOr<std::string> GenerateDocument(const GeneratorRequest& request,
                                             const std::vector<OfferedOperation>& offered,
                                             const ServiceRegistry& registry) {
  if (absl::Status status = CheckNames(request); !status.ok()) return status;
  absl::StatusOr<std::vector<OfferedOperation>> of_robot = OfRobot(request, offered);
  const bool only_services = !of_robot.ok() && request.robot.empty() && !request.operations.empty();
  if (!of_robot.ok() && !only_services) return of_robot.status();
  if (only_services) of_robot = std::vector<OfferedOperation>();
  if (request.operations.empty()) return GenerateRsel(request.name, *of_robot);
  std::vector<OfferedOperation> steps;
  for (const std::string& name : request.operations) {
    const auto found = std::find_if(of_robot->begin(), of_robot->end(),
                                    [&](const OfferedOperation& o) { return o.name == name; });
    std::optional<OfferedOperation> step;
    if (found != of_robot->end()) step = *found;
    if (!step) step = ServiceAsOperation(name, registry, offered);
    if (!step) {
      std::vector<std::string> names = registry.ProcessNames();
      for (const OfferedOperation& o : *of_robot) names.push_back(o.name);
      std::sort(names.begin(), names.end());
      names.erase(std::unique(names.begin(), names.end()), names.end());
      const std::string near = Nearest(name, names);
      return absl::NotFoundError(Concat(request.robot.empty()
                                            ? "no robot describes"
                                            : Concat("robot <", request.robot.value(), "> does not describe"),
                                        " operation ", name, ", and no service of this name is registered",
                                        !near.empty()   ? Concat("; did you mean ", near, "?")
                                        : names.empty() ? ""
                                                        : Concat("; there are ", xml::ListOf(names))));
    }
    if (!Usable(*step))
      return absl::InvalidArgumentError(
          Concat("operation ", name, " has a name or a part whose name cannot stand in a document"));
    steps.push_back(*std::move(step));
  }
  std::vector<const OfferedOperation*> in_order;
  for (const OfferedOperation& step : steps) in_order.push_back(&step);
  TypeWriter types;
  const std::string content =
      ProcessWriter(in_order).Text(request.process.empty() ? request.name : request.process,
                                   steps.size() == 1 ? steps[0].description : "", &types);
  return DocumentText(request.name, content, types);
}

std::string GenerateRsel(const std::string& name, const std::vector<OfferedOperation>& operations) {
  std::map<std::string, const OfferedOperation*> by_name;
  std::set<std::string> left_out;
  for (const OfferedOperation& operation : operations) {
    if (Usable(operation)) {
      by_name.emplace(operation.name, &operation);
    } else {
      left_out.insert(operation.name);
    }
  }
  TypeWriter types;
  std::string content;
  for (const std::string& left : left_out)
    content +=
        Concat("<documentation>left out, a name cannot stand here: ", Escaped(left), "</documentation>\n");
  for (const auto& [operation_name, operation] : by_name)
    content += ProcessWriter(std::vector<const OfferedOperation*>{operation})
                   .Text(operation_name, operation->description, &types);
  return DocumentText(name, content, types);
}

}  // namespace docent::rsel
