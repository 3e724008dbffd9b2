#include "workflow/cawl/document_reader.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/cawl/action_reader.h"
#include "workflow/cawl/condition_reader.h"
#include "workflow/cawl/flow_order.h"
#include "workflow/cawl/mode_reader.h"
#include "workflow/cawl/robot_choice.h"
#include "workflow/cawl/time_reader.h"
#include "workflow/cawl/word_reader.h"

namespace docent::cawl {
namespace {

constexpr int kMostBackoff = 100;

class DocumentReader {
 public:
  DocumentReader(const Limits& limits, xml::ElementReader* reader) : limits_(limits), reader_(*reader) {}

  void Read(const xml::Element& root, Document* out) {
    out->span = root.span;
    if (root.namespaces != nullptr) out->prefixes = *root.namespaces;
    out->prefixes.erase("");
    reader_.CheckAttributes(root, {"name", "namespace", "version"}, {"zone"});
    CheckZone(reader_.Extension(root, "zone"), &reader_);
    out->name = reader_.Name(root, "name");
    out->namespace_iri = reader_.Attribute(root, "namespace");
    out->version = reader_.Attribute(root, "version");
    reader_.ReadChildren(
        root, {{"message", [&](const xml::Element& e) { out->messages.push_back(ReadMessage(e)); }},
               {"variable", [&](const xml::Element& e) { out->variables.push_back(ReadVariable(e)); }},
               {"baseOntologies", [&](const xml::Element& e) { ReadOntologies(e, out); }},
               {"serviceProvider", [&](const xml::Element& e) { out->providers.push_back(ReadProvider(e)); }},
               {"activator",
                [&](const xml::Element& e) {
                  if (out->activator) return Second(e, root);
                  out->activator = ReadActivator(e);
                }},
               {"flow", [&](const xml::Element& e) { out->flows.push_back(ReadFlow(e)); }}});
  }

 private:
  void Second(const xml::Element& element, const xml::Element& parent) {
    reader_.Error(element.name_span, Concat("a second <", element.name, "> in <", parent.name, ">"),
                  "one may stand here");
  }
  void Nothing(const xml::Element& element) { reader_.ReadChildren(element, {}); }

  // A variable's or part's name: it must be usable as $name.
  Text ReadVariableName(const xml::Element& element) {
    Text name = reader_.Name(element, "name");
    if (!name.empty() && !xml::IsVariableName(name.value)) {
      reader_.Error(name.span, Concat("\"", name.value, "\" cannot name a ", element.name),
                    "use letters (a-z), digits and _, beginning with a letter");
    }
    return name;
  }

  Message ReadMessage(const xml::Element& element) {
    Message out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name"});
    out.name = reader_.Name(element, "name");
    reader_.ReadChildren(element, {{"part", [&](const xml::Element& e) {
                                      reader_.CheckAttributes(e, {"name", "type", "element"});
                                      Part part{ReadVariableName(e), reader_.Attribute(e, "type"),
                                                reader_.Attribute(e, "element"), e.span};
                                      xml::TermError unknown;  // such a type is for people
                                      part.type_term =
                                          xml::ParseTerm(part.type.value, *e.namespaces, &unknown);
                                      out.parts.push_back(std::move(part));
                                      Nothing(e);
                                    }}});
    return out;
  }

  Variable ReadVariable(const xml::Element& element) {
    Variable out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name", "type"}, {"required"});
    out.required = reader_.Flag(element, "required");
    out.name = ReadVariableName(element);
    out.type = reader_.Attribute(element, "type");
    if (out.type.value.find(':') != std::string::npos) out.type_term = reader_.TermOf(element, out.type);
    reader_.ReadChildren(
        element,
        {{"initialize", [&](const xml::Element& e) { out.initializers.push_back(ReadInitialize(e)); }}});
    return out;
  }

  Initialize ReadInitialize(const xml::Element& element) {
    Initialize out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"part"});
    out.part = reader_.Attribute(element, "part");
    int froms = 0;
    reader_.ReadChildren(element, {{"from", [&](const xml::Element& e) {
                                      if (froms++ > 0) return Second(e, element);
                                      ReadFrom(e, &out);
                                    }}});
    if (froms == 0) {
      reader_.Error(element.name_span, "<initialize> has no <from>",
                    "write <from expression=\"…\"/> or <from variable=\"…\"/>");
    }
    return out;
  }

  void ReadFrom(const xml::Element& element, Initialize* out) {
    reader_.CheckAttributes(element, {"variable", "part", "expression"});
    out->from_variable = reader_.Attribute(element, "variable");
    out->from_part = reader_.Attribute(element, "part");
    out->from_expression = reader_.Attribute(element, "expression");
    Nothing(element);
    if (out->from_variable.given() == out->from_expression.given()) {
      reader_.Error(element.name_span, "<from> needs either variable or expression");
    } else if (out->from_variable.given()) {
      out->copy_of = out->from_variable.value;
      if (out->from_part.given()) out->copy_of += "." + out->from_part.value;
    } else if (out->from_part.given()) {
      reader_.Error(out->from_part.span, "part belongs to a variable, and <from> has an expression");
    } else if (out->from_expression.value.starts_with("$")) {
      out->copy_of = out->from_expression.value.substr(1);
    } else {
      out->value = reader_.TermOf(element, out->from_expression);
    }
  }

  void ReadOntologies(const xml::Element& element, Document* out) {
    reader_.CheckAttributes(element, {});
    reader_.ReadChildren(element, {{"ontology", [&](const xml::Element& e) {
                                      reader_.CheckAttributes(e, {"location", "namespace"});
                                      out->ontologies.push_back({reader_.Attribute(e, "location"),
                                                                 reader_.Attribute(e, "namespace"), e.span});
                                      Nothing(e);
                                    }}});
  }

  ServiceProvider ReadProvider(const xml::Element& element) {
    ServiceProvider out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name", "location"});
    out.name = reader_.Name(element, "name");
    out.location = reader_.Attribute(element, "location");
    reader_.ReadChildren(element, {{"service", [&](const xml::Element& e) {
                                      reader_.CheckAttributes(e, {"operation"});
                                      out.services.push_back({reader_.Name(e, "operation"), e.span});
                                      Nothing(e);
                                    }}});
    return out;
  }

  Activator ReadActivator(const xml::Element& element) {
    Activator out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name"}, {"mode", "max", "priority", "preempt"});
    out.name = reader_.OptionalName(element, "name");
    ReadMode(element, &reader_, &out);
    out.urgency = ReadUrgency(element);
    bool has_condition = false;
    int activates = 0;
    reader_.ReadChildren(
        element, {{"message", [&](const xml::Element& e) { out.messages.push_back(ReadMessage(e)); }},
                  {"variable", [&](const xml::Element& e) { out.variables.push_back(ReadVariable(e)); }},
                  {"activate",
                   [&](const xml::Element& e) {
                     if (activates++ > 0) return Second(e, element);
                     reader_.CheckAttributes(e, {"flow"});
                     out.flow = reader_.Required(e, "flow");
                     Nothing(e);
                   }},
                  {"condition", [&](const xml::Element& e) {
                     if (has_condition) return Second(e, element);
                     has_condition = true;
                     out.condition = ReadCondition(e, limits_, &reader_);
                   }}});
    if (activates == 0) reader_.Error(element.name_span, "<activator> has no <activate flow=\"…\"/>");
    if (!has_condition || (out.condition.contexts.empty() && out.condition.cases.empty())) {
      reader_.Error(element.name_span,
                    "<activator> has no condition: it would start its flow again and again",
                    "write a <condition> with a <context> or a <case>");
    }
    return out;
  }

  Flow ReadFlow(const xml::Element& element) {
    Flow out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name"}, {"onFailure", "priority", "preempt"});
    out.name = reader_.Name(element, "name");
    out.on_failure = ReadOnFailure(reader_.Extension(element, "onFailure"));
    out.urgency = ReadUrgency(element);
    auto end = [&](Text* name) {
      return [this, name, &element](const xml::Element& e) {
        if (name->given()) return Second(e, element);
        reader_.CheckAttributes(e, {"name"});
        *name = reader_.Name(e, "name");
        Nothing(e);
      };
    };
    reader_.ReadChildren(
        element,
        {{"message", [&](const xml::Element& e) { out.messages.push_back(ReadMessage(e)); }},
         {"variable", [&](const xml::Element& e) { out.variables.push_back(ReadVariable(e)); }},
         {"source", end(&out.source)},
         {"node", [&](const xml::Element& e) { out.nodes.push_back(ReadNode(e)); }},
         {"sink", end(&out.sink)},
         {"link", [&](const xml::Element& e) { out.links.push_back(ReadLink(e)); }},
         {"output", [&](const xml::Element& e) { out.outputs.push_back(ReadOutput(e, &reader_)); }}});
    OrderNodes(&out);
    if (!out.source.given()) reader_.Error(element.name_span, "<flow> has no <source name=\"…\"/>");
    if (!out.sink.given()) reader_.Error(element.name_span, "<flow> has no <sink name=\"…\"/>");
    return out;
  }

  std::optional<Urgency> ReadUrgency(const xml::Element& element) {
    const Text priority = reader_.Extension(element, "priority"),
               preempt = reader_.Extension(element, "preempt");
    if (!priority.given() && !preempt.given()) return std::nullopt;
    Urgency urgency;
    urgency.preempts = reader_.Flag(element, "preempt");
    const bool number =
        absl::SimpleAtoi(priority.value, &urgency.priority) && std::abs(urgency.priority) <= kMaxPriority;
    if (priority.given() && !number) {
      reader_.Error(priority.span, Concat("priority \"", priority.value, "\" is not a priority"),
                    absl::StrCat("write a whole number from -", kMaxPriority, " to ", kMaxPriority,
                                 "; the higher, the more urgent"));
    }
    return urgency;
  }

  Node ReadNode(const xml::Element& element) {
    Node out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"name", "state"},
                            {"timeout", "retry", "retry-delay", "retry-backoff", "retry-other-robot",
                             "onFailure", "compensate", "forEach", "sequential", "while-holds"});
    out.name = reader_.Name(element, "name");
    out.state = reader_.Attribute(element, "state");
    if (out.state.given() && out.state.value != "Activate" && out.state.value != "deActivate") {
      reader_.Error(
          out.state.span, Concat("state \"", out.state.value, "\" is unknown"),
          reader_.DidYouMean(out.state.value, {"Activate", "deActivate"}, "write Activate or deActivate"));
    }
    out.timeout_text = reader_.Extension(element, "timeout");
    out.timeout_ms = reader_.Timeout(element);
    out.retry = reader_.Retry(element);
    out.retry_policy = ReadRetryPolicy(element, out.retry);
    out.on_failure_text = reader_.Extension(element, "onFailure");
    out.on_failure = ReadOnFailure(out.on_failure_text);
    out.compensate = reader_.Extension(element, "compensate");
    out.for_each_text = reader_.Extension(element, "forEach");
    ReadForEach(&out);
    out.sequential = reader_.Flag(element, "sequential");
    if (out.sequential && out.for_each.empty()) {
      reader_.Error(element.name_span, "ext:sequential without ext:forEach: there is nothing to do in turn",
                    "take it away, or write ext:forEach=\"?…\"");
    }
    ReadHold(element, &out);
    const auto action = [&](Action::Kind kind) {
      return [this, kind, &out](const xml::Element& e) {
        out.actions.push_back(ReadAction(e, kind, limits_, &reader_));
      };
    };
    reader_.ReadChildren(
        element, {{"message", [&](const xml::Element& e) { out.messages.push_back(ReadMessage(e)); }},
                  {"variable", [&](const xml::Element& e) { out.variables.push_back(ReadVariable(e)); }},
                  {"wait", [&](const xml::Element& e) { ReadWait(e, &out); }},
                  {"condition",
                   [&](const xml::Element& e) {
                     if (out.condition) return Second(e, element);
                     out.condition = ReadCondition(e, limits_, &reader_);
                   }},
                  {"invoke", [&](const xml::Element& e) { out.invokes.push_back(ReadInvoke(e)); }},
                  {"tell", action(Action::Kind::kTell)},
                  {"withdraw", action(Action::Kind::kWithdraw)},
                  {"assign", action(Action::Kind::kAssign)},
                  {"notify", action(Action::Kind::kNotify)},
                  {"reserve", action(Action::Kind::kReserve)},
                  {"release", action(Action::Kind::kRelease)},
                  {"fail", action(Action::Kind::kFail)}});
    if (out.holds_condition &&
        (!out.condition || (out.condition->contexts.empty() && out.condition->cases.empty()))) {
      reader_.Error(out.hold_text.span, "while-holds=\"true\" on a node without a condition",
                    "write what has to hold: ext:while-holds=\"subject verb object\"");
    }
    return out;
  }

  OnFailure ReadOnFailure(const Text& text) {
    if (!text.given()) return OnFailure::kUnset;
    if (text.value == "incident") return OnFailure::kIncident;
    if (text.value == "fail") return OnFailure::kFail;
    reader_.Error(
        text.span, Concat("onFailure is \"", text.value, "\""),
        reader_.DidYouMean(text.value, {"incident", "fail"},
                           "write incident (an operator decides) or fail; true stands at a <link>"));
    return OnFailure::kUnset;
  }

  RetryPolicy ReadRetryPolicy(const xml::Element& element, int retry) {
    RetryPolicy out;
    out.delay_ms = reader_.Duration(element, "retry-delay");
    const Text backoff = reader_.Extension(element, "retry-backoff");
    if (backoff.given() && (!absl::SimpleAtod(backoff.value, &out.backoff) ||
                            !(out.backoff >= 1 && out.backoff <= kMostBackoff))) {
      out.backoff = 1;
      reader_.Error(backoff.span, Concat("retry-backoff \"", backoff.value, "\" is not a factor"),
                    absl::StrCat("write a number from 1 to ", kMostBackoff,
                                 ": it is the factor from one delay to the next"));
    }
    out.other_robot = reader_.Flag(element, "retry-other-robot");
    out.delay_text = reader_.Extension(element, "retry-delay");
    if (backoff.given() && !out.delay_text.given()) {
      reader_.Error(backoff.span,
                    "ext:retry-backoff without ext:retry-delay: there is no delay to be made longer",
                    "write ext:retry-delay=\"…\", or take it away");
    }
    for (const char* name : {"retry-delay", "retry-other-robot"}) {
      const Text text = reader_.Extension(element, name);
      if (!text.given() || retry > 0 || text.value == "false") continue;
      reader_.Error(text.span, Concat("ext:", name, " without ext:retry: there is no further attempt"),
                    "write ext:retry=\"…\", or take it away");
    }
    return out;
  }

  void ReadHold(const xml::Element& element, Node* node) {
    node->hold_text = reader_.Extension(element, "while-holds");
    if (!node->hold_text.given() || node->hold_text.value == "false") return;
    node->holds_condition = node->hold_text.value == "true";
    if (!node->holds_condition) node->hold = ReadConstraintText(element, node->hold_text, &reader_);
  }

  void ReadForEach(Node* node) {
    const std::string& text = node->for_each_text.value;
    for (size_t at = 0; at < text.size();) {
      size_t end = std::min(text.find(' ', at), text.size());
      std::string word = text.substr(at, end - at);
      if (word.size() > 1 && word[0] == '?' && xml::IsVariableName(word.substr(1))) {
        node->for_each.push_back(word.substr(1));
      } else if (!word.empty()) {
        reader_.Error(reader_.Within(node->for_each_text, at, word.size()),
                      Concat("forEach: ", word, " is not a free variable"), "e.g. ext:forEach=\"?booth\"");
      }
      at = end + 1;
    }
  }

  void ReadWait(const xml::Element& element, Node* node) {
    reader_.CheckAttributes(element, {"joinCondition"});
    Text text = reader_.Attribute(element, "joinCondition");
    Nothing(element);
    if (!text.given()) return;
    std::optional<Expression> join = ParseExpression(text, limits_.query_nesting, &reader_);
    if (!join) return;
    if (!node->join) {
      node->join_text = text;
      node->join = std::move(join);
      return;
    }
    Expression both;
    both.kind = Expression::Kind::kAnd;
    both.children.push_back(std::move(*node->join));
    both.children.push_back(std::move(*join));
    node->join = std::move(both);
  }

  void ReadChoose(const xml::Element& element, Invoke* out) {
    out->choose_text = reader_.Extension(element, "choose");
    if (!out->choose_text.given()) return;
    if (!out->subflow.empty()) {
      reader_.Error(out->choose_text.span, "ext:choose stands at the invoke of a sub-flow",
                    "write it at the invokes of the sub-flow that take a robot");
      return;
    }
    std::string prefixes;
    for (const auto& [prefix, iri] : *element.namespaces) {
      if (!prefix.empty() && prefix != "xml") prefixes += Concat("PREFIX ", prefix, ": <", iri, "> ");
    }
    out->choose = Concat(prefixes, out->choose_text.value);
    for (const Diagnostic& fault : ParseRobotChoice(out->choose, limits_).diagnostics) {
      if (fault.severity != Diagnostic::Severity::kError) continue;
      reader_.Error(out->choose_text.span, Concat("ext:choose: ", fault.message), fault.hint);
      break;
    }
  }

  void ReadCapability(const xml::Element& element, Invoke* out) {
    if (out->operation.value.starts_with("<")) {
      reader_.Error(out->operation.span, Concat("operation ", out->operation.value, " begins with <"),
                    "a class of operations is asked for by ext:capability");
    }
    out->capability = reader_.Extension(element, "capability");
    if (!out->capability.given()) return;
    if (!out->operation.empty() || !out->subflow.empty()) {
      reader_.Error(
          out->capability.span, "<invoke> has ext:capability beside operation or subflow",
          "write one of them: ext:capability takes an operation of the class, whatever its name is");
      return;
    }
    const std::optional<Term> term = reader_.TermOf(element, out->capability);
    if (!term) return;
    if (!term->IsIri()) {
      reader_.Error(out->capability.span, Concat("the capability ", out->capability.value, " is a literal"),
                    "write a class of operations, e.g. docent:SpeechSynthesis");
      return;
    }
    out->operation = {ToNTriples(*term), out->capability.span};
  }

  Invoke ReadInvoke(const xml::Element& element) {
    Invoke out;
    out.span = element.span;
    reader_.CheckAttributes(
        element, {"operation", "subflow"},
        {"timeout", "retry", "retry-delay", "retry-backoff", "retry-other-robot", "choose", "capability"});
    out.operation = reader_.OptionalName(element, "operation");
    out.subflow = reader_.OptionalName(element, "subflow");
    ReadCapability(element, &out);
    out.timeout_text = reader_.Extension(element, "timeout");
    out.timeout_ms = reader_.Timeout(element);
    out.retry = reader_.Retry(element);
    ReadChoose(element, &out);
    out.retry_policy = ReadRetryPolicy(element, out.retry);
    reader_.ReadChildren(
        element,
        {{"input", [&](const xml::Element& e) { out.inputs.push_back(ReadInput(e, limits_, &reader_)); }},
         {"output", [&](const xml::Element& e) { out.outputs.push_back(ReadOutput(e, &reader_)); }}});
    for (const Output& output : out.outputs) {
      if (!output.part.given())
        reader_.Error(output.span, "<output> of an <invoke> needs the attribute part", "it names the result");
    }
    if (out.operation.empty() == out.subflow.empty() && !out.capability.given()) {
      reader_.Error(element.name_span, "<invoke> needs either operation or subflow",
                    "operation: a robot service or operation; subflow: a flow or a deployed workflow; "
                    "ext:capability: a class of operations");
    }
    return out;
  }

  Link ReadLink(const xml::Element& element) {
    Link out;
    out.span = element.span;
    reader_.CheckAttributes(element, {"from", "to"}, {"onFailure", "onInterrupt", "while"});
    out.from = reader_.Required(element, "from");
    out.to = reader_.Required(element, "to");
    out.on_failure = reader_.Flag(element, "onFailure");
    out.on_interrupt = reader_.Flag(element, "onInterrupt");
    out.while_text = reader_.Extension(element, "while");
    if (out.while_text.given()) out.while_constraint = ReadConstraintText(element, out.while_text, &reader_);
    Nothing(element);
    return out;
  }

  const Limits& limits_;
  xml::ElementReader& reader_;
};

}  // namespace

bool ReadDocument(const xml::Element& root, const Limits& limits, xml::ElementReader* reader,
                  Document* document) {
  if (!absl::EqualsIgnoreCase(root.name, "cawl")) {
    reader->Error(root.name_span, Concat("<", root.name, "> is not a CAWL document"),
                  "its root element is <CAWL>");
    return false;
  }
  DocumentReader(limits, reader).Read(root, document);
  return true;
}

}  // namespace docent::cawl
