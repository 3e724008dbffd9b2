#include "workflow/cawl/action_reader.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/assignment_reader.h"
#include "workflow/cawl/condition_reader.h"
#include "workflow/cawl/word_reader.h"

namespace docent::cawl {
namespace {

void CheckNamespace(const xml::Element& element, xml::ElementReader* reader) {
  if (element.namespace_iri == kExtensionNs) return;
  reader->Error(element.name_span, Concat("<", element.name, "> is an extension"),
                Concat("declare xmlns:ext=\"", kExtensionNs, "\" and write <ext:", element.name, ">"));
}

// An attribute of an element of the extensions, with the prefix or without.
Text Attribute(const xml::Element& element, std::string_view name, xml::ElementReader* reader) {
  const Text plain = reader->Attribute(element, name);
  return plain.given() ? plain : reader->Extension(element, name);
}

void ReadAt(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const Text at = Attribute(element, "at", reader);
  if (!at.given() || at.value == "open") return;
  const bool may_follow_failure = out->kind == Action::Kind::kTell || out->kind == Action::Kind::kWithdraw ||
                                  out->kind == Action::Kind::kNotify;
  if (at.value == "done") {
    out->when = Action::When::kDone;
  } else if (at.value == "failure" && may_follow_failure) {
    out->when = Action::When::kFailure;
  } else {
    reader->Error(at.span, Concat("at is \"", at.value, "\""),
                  Concat("write open (before the invokes of the node)",
                         may_follow_failure ? ", done (after them) or failure (when the node has failed)"
                                            : " or done (after them)"));
  }
}

void ReadLifetime(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const Text lifetime = Attribute(element, "lifetime", reader);
  if (!lifetime.given()) return;
  out->until_run_ends = lifetime.value == "run";
  if (out->until_run_ends) return;
  int64_t ms = 0;
  if (xml::ParseDurationMs(lifetime.value, &ms)) {
    out->lifetime_ms = ms;
    return;
  }
  reader->Error(lifetime.span, Concat("lifetime \"", lifetime.value, "\" is not a duration"),
                "write run, or a number above 0 and ms, s, min or h, e.g. 30s; at most 720h");
}

void ReadSource(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const Text source = Attribute(element, "source", reader);
  if (!source.given() || source.value == "own") return;
  out->any_source = source.value == "any";
  if (!out->any_source)
    reader->Error(source.span, Concat("source is \"", source.value, "\""),
                  "write own (what this run told) or any (what anybody told)");
}

// "subject verb object" on each line of the element's text.
void ReadLines(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const std::string& text = element.text.value;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    size_t first = begin, last = end;
    while (first < last && absl::ascii_isspace(static_cast<unsigned char>(text[first]))) ++first;
    while (last > first && absl::ascii_isspace(static_cast<unsigned char>(text[last - 1]))) --last;
    begin = end + 1;
    if (first == last) continue;
    const size_t from = element.text_offsets[first];
    const size_t to = last < element.text_offsets.size()
                          ? element.text_offsets[last]
                          : element.text.span.offset + element.text.span.length;
    const Text line{text.substr(first, last - first), reader->Span(from, to - from)};
    if (std::optional<Constraint> fact = ReadConstraintText(element, line, reader))
      out->facts.push_back(*std::move(fact));
  }
}

// What a fact that is told or withdrawn cannot have.
void CheckFact(const Constraint& fact, Action::Kind kind, xml::ElementReader* reader) {
  const bool tells = kind == Action::Kind::kTell;
  if (fact.object.comparison != Word::Comparison::kNone) {
    reader->Error(fact.object.span,
                  Concat("a fact to be ", tells ? "told" : "withdrawn", " has no comparison"),
                  tells ? "write the value itself" : "bind ?name in the node's condition, and compare there");
  }
  for (const Word* word : {&fact.subject, &fact.object}) {
    if (!word->type_term) continue;
    reader->Error(word->type.span, "a type has no effect here",
                  tells ? "tell it as a fact: subject a type" : "ask for it in the node's condition");
  }
}

void ReadFacts(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const bool tells = out->kind == Action::Kind::kTell;
  const std::vector<std::string> known = {"at", tells ? "lifetime" : "source"};
  reader->CheckAttributes(element, known, known);
  if (tells) ReadLifetime(element, reader, out);
  if (!tells) ReadSource(element, reader, out);
  for (const auto& child : element.children) {
    if (child->name == "documentation" || reader->IsForeign(*child)) continue;
    if (child->name == "constraint")
      out->facts.push_back(ReadConstraint(*child, reader));
    else
      reader->UnknownChild(element, *child, {"constraint"});
  }
  ReadLines(element, reader, out);
  if (out->facts.empty() && element.text.empty()) {
    reader->Error(element.name_span, Concat("<", element.name, "> has no fact"),
                  "write lines of subject verb object in it, or <constraint> elements");
  }
  for (const Constraint& fact : out->facts) CheckFact(fact, out->kind, reader);
}

// Where it may go: a webhook, a topic, or a variable that names one.
bool IsTarget(std::string_view target) {
  if (target.starts_with("$")) return xml::IsVariableName(target.substr(1));
  for (const std::string_view scheme : {"https://", "http://", "mqtt:"}) {
    if (target.starts_with(scheme) && target.size() > scheme.size()) return true;
  }
  return false;
}

void Uses(const Text& text, std::string_view name, size_t offset, xml::ElementReader* reader, Action* out) {
  out->uses.emplace_back(std::string(name), reader->Within(text, offset, name.size()));
}

void ReadNotification(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const std::vector<std::string> known = {"at", "to", "type", "subject", "variables", "wait"};
  reader->CheckAttributes(element, known, known);
  reader->ReadChildren(element, {});
  out->target = Attribute(element, "to", reader);
  if (out->target.empty()) {
    reader->Error(element.name_span, "<notify> needs the attribute to",
                  "an http or https address, or mqtt:TOPIC");
  } else if (!IsTarget(out->target.value)) {
    reader->Error(out->target.span, Concat("\"", out->target.value, "\" is no target"),
                  "write an http or https address, mqtt:TOPIC, or $name of a variable that has one");
  } else if (out->target.value.starts_with("mqtt:") &&
             out->target.value.find_first_of("+#") != std::string::npos) {
    reader->Error(out->target.span, "a topic that is published to has no wildcards",
                  "write the topic itself");
  }
  out->event_type = Attribute(element, "type", reader);
  out->event_subject = Attribute(element, "subject", reader);
  for (const Text* text : {&out->target, &out->event_subject}) {
    if (text->value.starts_with("$")) Uses(*text, std::string_view(text->value).substr(1), 1, reader, out);
  }
  const Text names = Attribute(element, "variables", reader);
  for (size_t at = 0; at < names.value.size();) {
    const size_t end = std::min(names.value.find(' ', at), names.value.size());
    if (end > at) {
      const size_t sigil = names.value[at] == '$' ? 1 : 0;
      out->data.push_back(
          {names.value.substr(at + sigil, end - at - sigil), reader->Within(names, at, end - at)});
    }
    at = end + 1;
  }
  const Text wait = Attribute(element, "wait", reader);
  out->waits = wait.value == "true";
  if (wait.given() && !out->waits && wait.value != "false")
    reader->Error(wait.span, Concat("wait is \"", wait.value, "\""), "write true or false");
  if (out->waits && out->when == Action::When::kFailure)
    reader->Error(wait.span, "a node that has failed waits for nothing", "take wait away");
}

void ReadFailure(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  reader->CheckAttributes(element, {"at", "reason"}, {"at", "reason"});
  reader->ReadChildren(element, {});
  out->reason = Attribute(element, "reason", reader);
  if (out->reason.empty()) {
    reader->Error(element.name_span, "<fail> needs the attribute reason",
                  "it says to people why the run fails; $name is the value of a variable");
  } else if (out->reason.value.starts_with("$")) {
    Uses(out->reason, std::string_view(out->reason.value).substr(1), 1, reader, out);
  }
}

// Each robot as a fact about it, so that its word is checked and has a value as in other facts.
void ReadRobots(const xml::Element& element, const char* name, xml::ElementReader* reader, Action* out) {
  const Text robots = Attribute(element, "robots", reader);
  for (size_t at = 0; at < robots.value.size();) {
    const size_t end = std::min(robots.value.find(' ', at), robots.value.size());
    if (end > at) {
      const Text word{robots.value.substr(at, end - at), reader->Within(robots, at, end - at)};
      const Text fact{Concat(word.value, " ", ToNTriples(Term::Iri(DocentIri("reservedBy"))), " ",
                             ToNTriples(Term::Iri(DocentIri("Reservation")))),
                      word.span};
      if (std::optional<Constraint> read = ReadConstraintText(element, fact, reader)) {
        read->subject.span = read->verb.span = read->object.span = word.span;
        out->facts.push_back(*std::move(read));
      }
    }
    at = end + 1;
  }
  if (!robots.given() || robots.value.find_first_not_of(' ') == std::string::npos) {
    reader->Error(robots.given() ? robots.span : element.name_span, Concat("<", name, "> names no robot"),
                  "write robots=\"$robot\", or several, separated by blanks");
  }
  if (out->facts.size() > kWorkflowLimits.reserved_robots) {
    reader->Error(
        robots.span,
        Concat("it names ", std::to_string(out->facts.size()), " robots; the limit is reserved_robots, ",
               std::to_string(kWorkflowLimits.reserved_robots)),
        "name those that the run needs at the same time");
  }
}

void ReadReservation(const xml::Element& element, xml::ElementReader* reader, Action* out) {
  const std::vector<std::string> known = {"at", "robots", "lasting", "priority"};
  reader->CheckAttributes(element, known, known);
  reader->ReadChildren(element, {});
  ReadRobots(element, "reserve", reader, out);
  out->until_run_ends = true;
  if (const Text lasting = Attribute(element, "lasting", reader); lasting.given()) {
    int64_t ms = 0;
    if (xml::ParseDurationMs(lasting.value, &ms)) {
      out->lifetime_ms = ms;
    } else {
      reader->Error(lasting.span, Concat("lasting \"", lasting.value, "\" is not a duration"),
                    "write a number above 0 and ms, s, min or h, e.g. 10min; at most 720h");
    }
  }
  if (const Text priority = Attribute(element, "priority", reader); priority.given()) {
    int value = 0;
    if (absl::SimpleAtoi(priority.value, &value) && value >= -kMaxPriority && value <= kMaxPriority) {
      out->priority = value;
    } else {
      reader->Error(priority.span, Concat("priority \"", priority.value, "\" is not a priority"),
                    "write a whole number from -1000 to 1000; only runs of a higher one take the robots");
    }
  }
}

}  // namespace

Action ReadAction(const xml::Element& element, Action::Kind kind, const Limits& limits,
                  xml::ElementReader* reader) {
  Action out;
  out.kind = kind;
  out.span = element.span;
  CheckNamespace(element, reader);
  ReadAt(element, reader, &out);
  switch (kind) {
    case Action::Kind::kAssign:
      ReadAssignment(element, limits, reader, &out);
      break;
    case Action::Kind::kNotify:
      ReadNotification(element, reader, &out);
      break;
    case Action::Kind::kReserve:
      ReadReservation(element, reader, &out);
      break;
    case Action::Kind::kRelease:
      reader->CheckAttributes(element, {"at", "robots"}, {"at", "robots"});
      reader->ReadChildren(element, {});
      if (Attribute(element, "robots", reader).given()) ReadRobots(element, "release", reader, &out);
      break;
    case Action::Kind::kFail:
      ReadFailure(element, reader, &out);
      break;
    case Action::Kind::kTell:
    case Action::Kind::kWithdraw:
      ReadFacts(element, reader, &out);
  }
  return out;
}

Input ReadInput(const xml::Element& element, const Limits& limits, xml::ElementReader* reader) {
  CheckNamespace(element, reader);
  const std::vector<std::string> known = {"part", "variable", "expression"};
  reader->CheckAttributes(element, known, known);
  reader->ReadChildren(element, {});
  Input out;
  out.part = Attribute(element, "part", reader);
  out.variable = Attribute(element, "variable", reader);
  out.span = element.span;
  const Text expression = Attribute(element, "expression", reader);
  if (out.part.empty())
    reader->Error(element.name_span, "<input> needs the attribute part",
                  "it names an input of what is invoked");
  if (expression.given() == out.variable.given()) {
    reader->Error(
        element.name_span, "<input> needs either variable or expression",
        "write variable=\"stand\" for the value of $stand, or an expression as expression='\"Hello\"'");
  } else if (expression.given()) {
    ReadExpression(element, expression, out.part, limits, reader, &out.computed);
  }
  return out;
}

Output ReadOutput(const xml::Element& element, xml::ElementReader* reader) {
  CheckNamespace(element, reader);
  reader->CheckAttributes(element, {"part", "variable"}, {"part", "variable"});
  reader->ReadChildren(element, {});
  Output out{Attribute(element, "part", reader), Attribute(element, "variable", reader), element.span};
  if (out.variable.empty())
    reader->Error(element.name_span, "<output> needs the attribute variable",
                  "it names a variable of the run");
  return out;
}

}  // namespace docent::cawl
