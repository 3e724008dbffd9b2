#include "workflow/rsel/generator.h"

#include <algorithm>
#include <map>

#include "graph/base/text.h"
#include "workflow/xml/term_text.h"

namespace docent::rsel {
namespace {

// For attribute values and text (XML 1.0 section 2.4). Characters that XML cannot hold are left out.
std::string Escaped(std::string_view text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\n':
      case '\t':
        out += ' ';
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) out += c;
    }
  }
  return out;
}

// Names that cannot stand in a document as they are.
bool Usable(const OfferedOperation& operation) {
  auto part = [](const std::string& name) { return xml::IsVariableName(name); };
  return operation.name.find_first_not_of(" \t\r\n") != std::string::npos &&
         std::all_of(operation.inputs.begin(), operation.inputs.end(), part) &&
         std::all_of(operation.outputs.begin(), operation.outputs.end(), part);
}

std::string MessageText(const std::string& name, const std::vector<std::string>& parts) {
  std::string out = Concat("  <message name=\"", name, "\">\n");
  for (const std::string& part : parts) out += Concat("    <part name=\"", part, "\"/>\n");
  return out + "  </message>\n";
}

std::string ProcessText(const OfferedOperation& operation) {
  std::string name = Escaped(operation.name);
  std::string out = Concat("  <process name=\"", name, "\" input=\"", name, "Request\"");
  if (!operation.outputs.empty()) out += Concat(" output=\"", name, "Reply\"");
  out += ">\n";
  if (!operation.description.empty()) {
    out += Concat("    <documentation>", Escaped(operation.description), "</documentation>\n");
  }
  out += Concat("    <invoke operation=\"", name, "\">\n");
  for (const std::string& part : operation.inputs)
    out += Concat("      <input part=\"", part, "\" from=\"", part, "\"/>\n");
  for (const std::string& part : operation.outputs)
    out += Concat("      <output part=\"", part, "\" to=\"", part, "\"/>\n");
  return out + "    </invoke>\n  </process>\n";
}

}  // namespace

std::string GenerateRsel(const std::string& name, const std::vector<OfferedOperation>& operations) {
  std::map<std::string, const OfferedOperation*> by_name;
  std::string left_out;
  for (const OfferedOperation& operation : operations) {
    if (Usable(operation)) {
      by_name.emplace(operation.name, &operation);
    } else {
      left_out += Concat("  <documentation>left out, a name cannot stand here: ", Escaped(operation.name),
                         "</documentation>\n");
    }
  }
  std::string messages, processes;
  for (const auto& [unused, operation] : by_name) {
    messages += MessageText(Escaped(operation->name) + "Request", operation->inputs);
    if (!operation->outputs.empty())
      messages += MessageText(Escaped(operation->name) + "Reply", operation->outputs);
    processes += "\n" + ProcessText(*operation);
  }
  return Concat(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Generated from what robots offer: one process for "
      "each operation. ",
      "Compose your own from them. -->\n<rsel name=\"", Escaped(name),
      "\" version=\"1.0\"\n      xmlns:ext=\"", kExtensionNs, "\">\n", left_out, messages, processes,
      "</rsel>\n");
}

}  // namespace docent::rsel
