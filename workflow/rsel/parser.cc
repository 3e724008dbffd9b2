#include "workflow/rsel/parser.h"

#include <map>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/xml/datatype_names.h"
#include "workflow/xml/element_reader.h"

namespace docent::rsel {
namespace {

class DocumentReader {
 public:
  explicit DocumentReader(xml::ElementReader* reader) : reader_(*reader) {}

  void Read(const xml::Element& root, Document* out) {
    out->span = root.span;
    reader_.CheckAttributes(root, {"name", "namespace", "version"});
    out->name = reader_.Name(root, "name");
    out->namespace_iri = reader_.Attribute(root, "namespace");
    out->version = reader_.Attribute(root, "version");
    reader_.ReadChildren(
        root, {{"message", [&](const xml::Element& e) { out->messages.push_back(ReadMessage(e)); }},
               {"process", [&](const xml::Element& e) { out->processes.push_back(ReadProcess(e)); }}});
    if (out->processes.empty()) reader_.Error(root.name_span, "<rsel> has no <process>");
  }

 private:
  Text ReadPartName(const xml::Element& element, std::string_view attribute) {
    Text name = reader_.Name(element, attribute);
    if (!name.empty() && !xml::IsVariableName(name.value)) {
      reader_.Error(name.span, Concat("\"", name.value, "\" cannot name a part"),
                    "use letters (a-z), digits and _, beginning with a letter");
    }
    return name;
  }

  Message ReadMessage(const xml::Element& element) {
    Message out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name"});
    out.name = reader_.Name(element, "name");
    reader_.ReadChildren(element,
                         {{"part", [&](const xml::Element& e) {
                             reader_.CheckAttributes(e, {"name", "type"});
                             Part part{ReadPartName(e, "name"), reader_.Attribute(e, "type"), e.span};
                             if (!part.type.empty()) part.type_term = reader_.TermOf(e, part.type);
                             if (part.type_term && part.type_term->IsIri())
                               xml::CheckDatatype(part.type_term->lexical, part.type.span, &reader_);
                             out.parts.push_back(std::move(part));
                             reader_.ReadChildren(e, {});
                           }}});
    return out;
  }

  Process ReadProcess(const xml::Element& element) {
    Process out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name", "input", "output"});
    out.name = reader_.Name(element, "name");
    out.input = reader_.Attribute(element, "input");
    out.output = reader_.Attribute(element, "output");
    reader_.ReadChildren(element,
                         {{"invoke", [&](const xml::Element& e) { out.invokes.push_back(ReadInvoke(e)); }}});
    if (out.invokes.empty()) reader_.Error(element.name_span, "<process> has no <invoke>");
    if (!out.invokes.empty() && out.invokes[0].parallel) {
      reader_.Error(out.invokes[0].span, "the first invoke is marked parallel, but none stands before it",
                    "mark the later one of the two");
    }
    return out;
  }

  Invoke ReadInvoke(const xml::Element& element) {
    Invoke out;
    out.span = element.start_tag;
    reader_.CheckAttributes(element, {"operation", "service"}, {"parallel", "retry", "timeout", "onFailure"});
    out.operation = reader_.Name(element, "operation");
    out.service = reader_.OptionalName(element, "service");
    out.parallel = reader_.Flag(element, "parallel");
    out.retry = reader_.Retry(element);
    out.timeout_text = reader_.Extension(element, "timeout");
    out.timeout_ms = reader_.Timeout(element);
    Text on_failure = reader_.Extension(element, "onFailure");
    if (on_failure.value == "continue") {
      out.on_failure = Invoke::OnFailure::kContinue;
    } else if (on_failure.given() && on_failure.value != "fail") {
      reader_.Error(on_failure.span, Concat("onFailure is \"", on_failure.value, "\""),
                    reader_.DidYouMean(on_failure.value, {"fail", "continue"}, "write fail or continue"));
    }
    reader_.ReadChildren(element,
                         {{"input", [&](const xml::Element& e) { out.inputs.push_back(ReadInput(e)); }},
                          {"output", [&](const xml::Element& e) { out.outputs.push_back(ReadOutput(e)); }}});
    return out;
  }

  Input ReadInput(const xml::Element& element) {
    Input out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"part", "from", "value"});
    out.part = ReadPartName(element, "part");
    out.from = reader_.Attribute(element, "from");
    out.value_text = reader_.Attribute(element, "value");
    if (out.from.given() == out.value_text.given()) {
      reader_.Error(element.name_span, "<input> needs either from or value");
    } else if (out.value_text.given()) {
      out.value = reader_.TermOf(element, out.value_text);
    }
    reader_.ReadChildren(element, {});
    return out;
  }

  Output ReadOutput(const xml::Element& element) {
    Output out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"part", "to"});
    out.part = ReadPartName(element, "part");
    out.to = ReadPartName(element, "to");
    reader_.ReadChildren(element, {});
    return out;
  }

  xml::ElementReader& reader_;
};

class Checker {
 public:
  Checker(const Document& document, xml::ElementReader* reader) : document_(document), reader_(*reader) {}

  void Check() {
    Unique(document_.messages, "message", [](const Message& m) -> const Text& { return m.name; });
    Unique(document_.processes, "process", [](const Process& p) -> const Text& { return p.name; });
    for (const Message& message : document_.messages) {
      messages_.emplace(message.name.value, &message);
      Unique(message.parts, "part", [](const Part& p) -> const Text& { return p.name; });
    }
    for (const Process& process : document_.processes) CheckProcess(process);
  }

 private:
  template <typename T, typename NameOf>
  void Unique(const std::vector<T>& things, std::string_view what, NameOf name_of) {
    std::map<std::string, int> lines;
    for (const T& thing : things) {
      const Text& name = name_of(thing);
      if (name.empty()) continue;
      auto [it, is_new] = lines.emplace(name.value, name.span.line);
      if (!is_new) {
        reader_.Error(name.span, Concat(what, " ", name.value, " stands twice"),
                      absl::StrCat("the first is in line ", it->second));
      }
    }
  }

  const Message* MessageOf(const Text& name) {
    if (!name.given()) return nullptr;
    auto it = messages_.find(name.value);
    if (it != messages_.end()) return it->second;
    if (reader_.full(Diagnostic::Severity::kError)) return nullptr;
    std::vector<std::string> known;
    for (const auto& [message, unused] : messages_) known.push_back(message);
    reader_.Error(name.span, Concat("there is no message ", name.value),
                  reader_.DidYouMean(name.value, known,
                                     known.empty() ? "the document has no messages"
                                                   : Concat("there are: ", xml::ListOf(known))));
    return nullptr;
  }

  // Names that an input may take: the process's input parts, and results of groups of invokes before.
  void CheckProcess(const Process& process) {
    const Message* input = MessageOf(process.input);
    const Message* output = MessageOf(process.output);
    std::set<std::string> known, made_here;
    if (input != nullptr) {
      for (const Part& part : input->parts) known.insert(part.name.value);
    }
    bool open = !process.input.given();  // without a message, unknown names become inputs
    for (const Invoke& invoke : process.invokes) {
      if (!invoke.parallel) known.merge(made_here);
      Unique(invoke.inputs, "input", [](const Input& i) -> const Text& { return i.part; });
      Unique(invoke.outputs, "output", [](const Output& o) -> const Text& { return o.part; });
      for (const Input& i : invoke.inputs) {
        if (!i.from.given()) continue;
        if (made_here.contains(i.from.value) && !known.contains(i.from.value)) {
          reader_.Error(i.from.span, Concat(i.from.value, " is made by an invoke that runs at the same time"),
                        "take ext:parallel away from this invoke");
        } else if (!open && input != nullptr && !known.contains(i.from.value)) {
          std::vector<std::string> names(known.begin(), known.end());
          reader_.Error(i.from.span,
                        Concat("nothing gives ", i.from.value, ": it is neither a part of message ",
                               process.input.value, " nor the result of an invoke before"),
                        reader_.DidYouMean(i.from.value, names,
                                           names.empty() ? "" : Concat("there are: ", xml::ListOf(names))));
        }
      }
      for (const Output& o : invoke.outputs) made_here.insert(o.to.value);
    }
    CheckTogether(process);
    known.merge(made_here);
    if (output == nullptr) return;
    for (const Part& part : output->parts) {
      if (known.contains(part.name.value)) continue;
      reader_.Error(
          process.output.span,
          Concat("nothing gives part ", part.name.value, " of the output message ", output->name.value),
          Concat("write <output part=\"…\" to=\"", part.name.value, "\"/> in an invoke"));
    }
  }

  // One robot serves the whole process: the same operation twice at the same time is a mistake.
  void CheckTogether(const Process& process) {
    std::set<std::string> group;
    for (const Invoke& invoke : process.invokes) {
      if (!invoke.parallel) group.clear();
      if (invoke.operation.empty() || group.insert(invoke.operation.value).second) continue;
      Diagnostic& report =
          reader_.Warning(invoke.operation.span,
                          Concat("process ", process.name.value, " invokes ", invoke.operation.value,
                                 " twice at the same time, of one robot"),
                          "take ext:parallel away from this invoke");
      report.rule = "robot-race";
    }
  }

  const Document& document_;
  xml::ElementReader& reader_;
  std::map<std::string, const Message*> messages_;
};

}  // namespace

ParsedRsel ParseRsel(std::string_view text, const std::string& file, const Limits& limits) {
  ParsedRsel out;
  xml::ParsedXml parsed = xml::ParseXml(text, file, limits);
  if (parsed.root == nullptr) {
    out.diagnostics = std::move(parsed.diagnostics);
    return out;
  }
  auto document = std::make_shared<Document>();
  document->file = file;
  document->source = text;
  xml::ElementReader reader(document->source, file, kExtensionNs, parsed.root.get());
  if (absl::EqualsIgnoreCase(parsed.root->name, "rsel")) {
    DocumentReader(&reader).Read(*parsed.root, document.get());
    Checker(*document, &reader).Check();
    out.document = std::move(document);
  } else {
    reader.Error(parsed.root->name_span, Concat("<", parsed.root->name, "> is not an RSEL document"),
                 "its root element is <rsel>");
  }
  out.diagnostics = reader.TakeDiagnostics();
  return out;
}

}  // namespace docent::rsel
