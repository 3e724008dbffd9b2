#include "workflow/templates/wsdl_reader.h"

#include <algorithm>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "workflow/templates/wsdl_schema.h"
#include "workflow/xml/xml_document.h"

namespace docent::templates {
namespace {

constexpr std::string_view kWsdlNs = "http://schemas.xmlsoap.org/wsdl/";
constexpr std::string_view kSchemaNs = "http://www.w3.org/2001/XMLSchema";
constexpr size_t kMostDiagnostics = 200;

bool IsWsdl(const xml::Element& element, std::string_view name) {
  return element.namespace_iri == kWsdlNs && element.name == name;
}

// Text with single blanks, at most so long.
std::string Collapsed(std::string_view text) {
  constexpr size_t kMostBytes = 2000;
  std::string out;
  for (const absl::string_view word :
       absl::StrSplit(ToAbsl(text), absl::ByAnyChar(" \t\r\n"), absl::SkipEmpty())) {
    if (out.size() + word.size() > kMostBytes) return out + " …";
    absl::StrAppend(&out, out.empty() ? "" : " ", word);
  }
  return out;
}

class WsdlReader {
 public:
  WsdlReader(const xml::Element& root, const std::string& file)
      : root_(root),
        file_(file),
        target_(AttributeOf(root, "targetNamespace")),
        schema_([this](const xml::Element& at, std::string message, std::string hint) {
          Warn(at, std::move(message), std::move(hint));
        }) {}

  ImportedTemplates Read() {
    if (target_.empty())
      Warn(root_, "the document has no targetNamespace", "names are looked up without a namespace");
    for (const auto& child : root_.children) Collect(*child);
    for (const xml::Element* port_type : port_types_) ReadPortType(*port_type);
    if (out_.templates.empty())
      Warn(root_, "the document has no operation", "operations stand in a <portType>");
    WriteCawl(&out_.templates);
    std::stable_sort(out_.diagnostics.begin(), out_.diagnostics.end(),
                     [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
    return std::move(out_);
  }

 private:
  void Collect(const xml::Element& child) {
    const QName name{target_, AttributeOf(child, "name")};
    if (IsWsdl(child, "import")) {
      Warn(child, Concat("the document ", AttributeOf(child, "location"), " is not read"),
           "what it defines is missing; import that document, too, or put its content into this one");
    } else if (IsWsdl(child, "types")) {
      for (const auto& schema : child.children) {
        if (schema->namespace_iri == kSchemaNs && schema->name == "schema") schema_.Add(*schema);
      }
    } else if (IsWsdl(child, "message")) {
      if (!messages_.Add(name, &child))
        Warn(child, Concat("message ", name.second, " stands twice"), "the first counts");
    } else if (IsWsdl(child, "portType")) {
      port_types_.push_back(&child);
    } else if (IsWsdl(child, "binding")) {
      bindings_.emplace_back(name, ResolveName(child, AttributeOf(child, "type"), target_));
    } else if (IsWsdl(child, "service")) {
      for (const auto& port : child.children) {
        if (IsWsdl(*port, "port")) CollectPort(*port);
      }
    }
  }

  void CollectPort(const xml::Element& port) {
    for (const auto& address : port.children) {
      const std::string location = AttributeOf(*address, "location");
      if (address->name != "address" || location.empty()) continue;
      ports_.emplace_back(ResolveName(port, AttributeOf(port, "binding"), target_), Collapsed(location));
    }
  }

  // The first port whose binding is of the port type; also where only the local names fit.
  std::string EndpointOf(const std::string& port_type) const {
    for (const auto& [binding, type] : bindings_) {
      if (type.second != port_type) continue;
      for (const auto& [of, location] : ports_) {
        if (of.second == binding.second) return location;
      }
    }
    return "";
  }

  void ReadPortType(const xml::Element& port_type) {
    const std::string name = AttributeOf(port_type, "name");
    const std::string endpoint = EndpointOf(name);
    std::map<std::string, int> seen;
    for (const auto& operation : port_type.children) {
      if (!IsWsdl(*operation, "operation")) continue;
      if (out_.templates.size() >= kWorkflowLimits.import_templates) {
        Warn(*operation,
             absl::StrCat("there are more operations; the limit import_templates is ",
                          kWorkflowLimits.import_templates),
             "split the document");
        return;
      }
      if (!ReadOperation(*operation, name, endpoint)) continue;
      if (++seen[AttributeOf(*operation, "name")] == 2) {
        Warn(*operation,
             Concat("operation ", AttributeOf(*operation, "name"), " is overloaded in port type ", name),
             "its nodes are told apart by a number; the operation that is invoked has one name");
      }
    }
  }

  // False: it is left out.
  bool ReadOperation(const xml::Element& operation, const std::string& port_type,
                     const std::string& endpoint) {
    NodeTemplate out;
    out.operation = AttributeOf(operation, "name");
    out.service = Collapsed(port_type);
    out.endpoint = endpoint;
    if (!IsOperationName(out.operation)) {
      Warn(operation, "the operation's name cannot stand in a document", "give it another one");
      return false;
    }
    bool has_input = false;
    for (const auto& child : operation.children) {
      if (IsWsdl(*child, "documentation")) out.documentation = Collapsed(child->text.value);
      if (IsWsdl(*child, "input")) {
        has_input = true;
        AddMessage(*child, &out.inputs);
      }
      if (IsWsdl(*child, "output")) {
        if (!has_input) {
          Warn(operation, Concat("operation ", out.operation, " is begun by the service, not by who uses it"),
               "it is left out: no node can invoke it");
          return false;
        }
        AddMessage(*child, &out.outputs);
      }
    }
    out_.templates.push_back(std::move(out));
    return true;
  }

  void AddMessage(const xml::Element& at, std::vector<TemplatePart>* parts) {
    const std::string text = AttributeOf(at, "message");
    const QName name = ResolveName(at, text, target_);
    const xml::Element* const* message = messages_.Find(name);
    if (message == nullptr) {
      Warn(at, Concat("message ", text, " is not defined here"), "the node has no parts of it");
      return;
    }
    for (const auto& part : (*message)->children) {
      if (!IsWsdl(*part, "part")) continue;
      const std::string element = AttributeOf(*part, "element"), type = AttributeOf(*part, "type");
      if (!element.empty()) {
        schema_.AddPartsOfElement(*part, ResolveName(*part, element, target_), parts);
      } else if (!AddPart(AttributeOf(*part, "name"),
                          type.empty() ? "" : schema_.TypeOfName(ResolveName(*part, type, target_)), parts)) {
        Warn(*part, Concat("message ", name.second, " has too many parts"),
             "those after the limit import_parts are left out");
        return;
      }
    }
  }

  void Warn(const xml::Element& at, std::string message, std::string hint) {
    const auto said = [&](const Diagnostic& d) {
      return d.span.offset == at.name_span.offset && d.message == message;
    };
    if (out_.diagnostics.size() >= kMostDiagnostics) return;
    if (std::any_of(out_.diagnostics.begin(), out_.diagnostics.end(), said)) return;
    out_.diagnostics.push_back(
        {file_, at.name_span, std::move(message), std::move(hint), Diagnostic::Severity::kWarning});
  }

  const xml::Element& root_;
  const std::string file_;
  const std::string target_;
  WsdlSchema schema_;
  NamedThings<const xml::Element*> messages_;
  std::vector<const xml::Element*> port_types_;
  std::vector<std::pair<QName, QName>> bindings_;     // name, type
  std::vector<std::pair<QName, std::string>> ports_;  // binding, address
  ImportedTemplates out_;
};

}  // namespace

ImportedTemplates ReadWsdl(std::string_view text, const std::string& file, const Limits& limits) {
  ImportedTemplates out;
  xml::ParsedXml parsed = xml::ParseXml(text, file, limits);
  if (parsed.root == nullptr) {
    out.diagnostics = std::move(parsed.diagnostics);
    return out;
  }
  if (IsWsdl(*parsed.root, "definitions")) return WsdlReader(*parsed.root, file).Read();
  const bool newer = parsed.root->name == "description";
  out.diagnostics.push_back(
      {file, parsed.root->name_span,
       Concat("<", parsed.root->name, "> is not the root element of a WSDL 1.1 document"),
       newer ? "WSDL 2.0 is not read; ask the service for its WSDL 1.1"
             : Concat("it is <definitions> of the namespace ", kWsdlNs)});
  return out;
}

}  // namespace docent::templates
