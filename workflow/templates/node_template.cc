#include "workflow/templates/node_template.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/iri_names.h"
#include "workflow/xml/element_reader.h"
#include "workflow/xml/formatter.h"

namespace docent::templates {
namespace {

// For text; characters that XML cannot hold are left out.
std::string Escaped(std::string_view text) {
  std::string kept;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) >= 0x20) kept += c;
  }
  return xml::XmlEscaped(kept);
}

std::string MessageText(const std::string& name, const std::vector<TemplatePart>& parts) {
  std::string out = Concat("<message name=\"", Escaped(name), "\">\n");
  for (const TemplatePart& part : parts) {
    out += Concat("<part name=\"", part.name, "\"");
    if (!part.type.empty()) out += Concat(" type=\"", Escaped(IriNames::WellKnown().Iri(part.type)), "\"");
    out += "/>\n";
  }
  return out + "</message>\n";
}

bool IsCalledOtherwise(const TemplatePart& part) {
  return !part.called.empty();
}

// Where a result is named, only those that are become variables.
std::vector<TemplatePart> NamedOutputs(const NodeTemplate& of) {
  const bool any = std::any_of(of.outputs.begin(), of.outputs.end(), IsCalledOtherwise);
  return any ? of.outputs : std::vector<TemplatePart>();
}

std::string InvokeText(const NodeTemplate& of) {
  std::string parts;
  for (const TemplatePart& part : of.inputs) {
    if (IsCalledOtherwise(part))
      parts += Concat("<ext:input part=\"", Escaped(part.called), "\" variable=\"", part.name, "\"/>\n");
  }
  for (const TemplatePart& part : NamedOutputs(of)) {
    parts += Concat("<ext:output part=\"", Escaped(IsCalledOtherwise(part) ? part.called : part.name),
                    "\" variable=\"", part.name, "\"/>\n");
  }
  const std::string start = Concat("<invoke operation=\"", Escaped(of.operation), "\"");
  return parts.empty() ? start + "/>\n" : Concat(start, ">\n", parts, "</invoke>\n");
}

// Those that ext:input and ext:output name.
std::string VariablesText(const NodeTemplate& of) {
  std::set<std::string> names;
  for (const TemplatePart& part : of.inputs) {
    if (IsCalledOtherwise(part)) names.insert(part.name);
  }
  for (const TemplatePart& part : NamedOutputs(of)) names.insert(part.name);
  std::string out;
  for (const std::string& name : names) out += Concat("<variable name=\"", name, "\"/>\n");
  return out;
}

std::string NodeText(const NodeTemplate& of, const std::string& name) {
  const std::string variables = VariablesText(of);
  std::string out =
      Concat("<node name=\"", Escaped(name), "\"",
             variables.empty() ? "" : " xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"", ">\n");
  std::string about = of.documentation;
  if (!of.service.empty())
    about += Concat(about.empty() ? "" : " ", "Of ", of.service, of.endpoint.empty() ? "." : "");
  if (!of.endpoint.empty()) about += Concat(about.empty() ? "At " : " at ", of.endpoint, ".");
  if (!about.empty()) out += Concat("<documentation>", Escaped(about), "</documentation>\n");
  if (!of.inputs.empty()) out += MessageText(name + "Request", of.inputs);
  if (!of.outputs.empty()) out += MessageText(name + "Reply", of.outputs);
  out += Concat(variables, InvokeText(of), "</node>");
  const xml::FormattedXml formatted = xml::FormatXml(out, "node");
  return formatted.ok() ? formatted.text : out + "\n";
}

}  // namespace

bool AddPart(std::string_view name, std::string type, std::vector<TemplatePart>* parts) {
  if (parts->size() >= kWorkflowLimits.import_parts) return false;
  std::string plain;
  for (const char c : name.substr(0, kWorkflowLimits.name_bytes / 2)) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;  // of a character that began before
    plain += absl::ascii_isalnum(byte) ? c : '_';
  }
  if (plain.empty() || !absl::ascii_isalpha(static_cast<unsigned char>(plain[0]))) plain = "p" + plain;
  const auto taken = [parts](const std::string& wanted) {
    return std::any_of(parts->begin(), parts->end(),
                       [&](const TemplatePart& part) { return part.name == wanted; });
  };
  std::string own = plain;
  for (int number = 2; taken(own); ++number) own = absl::StrCat(plain, "_", number);
  const bool sayable = !name.empty() && name != own && !NameFault(name);
  parts->push_back({std::move(own), std::move(type), sayable ? std::string(name) : ""});
  return true;
}

bool IsOperationName(std::string_view name) {
  return !name.empty() && name.front() != ' ' && name.back() != ' ' && !NameFault(name);
}

void WriteCawl(std::vector<NodeTemplate>* templates) {
  constexpr size_t kRoom = 16;  // for a number, "Request" and the like
  std::set<std::string> names;
  for (NodeTemplate& one : *templates) {
    const bool long_name = one.operation.size() + kRoom > kWorkflowLimits.name_bytes;
    const std::string base = long_name ? "node" : one.operation;
    std::string name = base;
    for (int number = 2; !names.insert(name).second; ++number) name = absl::StrCat(base, "_", number);
    one.cawl = NodeText(one, name);
  }
}

}  // namespace docent::templates
