#include "workflow/cawl/condition_reader.h"

#include <string>

#include "absl/strings/numbers.h"
#include "graph/base/text.h"
#include "workflow/cawl/time_reader.h"
#include "workflow/cawl/word_reader.h"

namespace docent::cawl {
namespace {

std::optional<Expression> ReadExpression(const Text& text, const Limits& limits, xml::ElementReader* reader) {
  if (!text.given()) return std::nullopt;
  return ParseExpression(text, limits.query_nesting, reader);
}

Rule ReadRule(const xml::Element& element, const Limits& limits, xml::ElementReader* reader) {
  Rule out;
  out.span = element.span;
  reader->CheckAttributes(element, {"name", "expression"}, {"for"});
  out.name = reader->OptionalName(element, "name");
  out.for_text = reader->Extension(element, "for");
  out.at_least_ms = reader->Duration(element, "for");
  out.expression_text = reader->Attribute(element, "expression");
  out.expression = ReadExpression(out.expression_text, limits, reader);
  reader->ReadChildren(
      element,
      {{"constraint",
        [&](const xml::Element& child) { out.constraints.push_back(ReadConstraint(child, reader)); }},
       {"time", [&](const xml::Element& child) { ReadTime(child, reader, &out); }}});
  return out;
}

Context ReadContext(const xml::Element& element, const Limits& limits, xml::ElementReader* reader) {
  Context out;
  out.span = element.span;
  reader->CheckAttributes(element, {"name", "priority"});
  out.name = reader->OptionalName(element, "name");
  out.priority_text = reader->Attribute(element, "priority");
  if (out.priority_text.given() && !absl::SimpleAtoi(out.priority_text.value, &out.priority)) {
    reader->Error(out.priority_text.span,
                  Concat("priority \"", out.priority_text.value, "\" is not a whole number"),
                  "lower numbers are tried first");
  }
  reader->ReadChildren(
      element,
      {{"rule", [&](const xml::Element& child) { out.rules.push_back(ReadRule(child, limits, reader)); }},
       {"time", [&](const xml::Element& child) {
          // a rule of its own
          Rule& rule = out.rules.emplace_back();
          rule.span = child.span;
          ReadTime(child, reader, &rule);
        }}});
  return out;
}

Case ReadCase(const xml::Element& element, const Limits& limits, xml::ElementReader* reader) {
  Case out;
  out.span = element.span;
  reader->CheckAttributes(element, {"name", "expression"});
  out.name = reader->OptionalName(element, "name");
  out.expression_text = reader->Attribute(element, "expression");
  out.expression = ReadExpression(out.expression_text, limits, reader);
  reader->ReadChildren(element, {{"event", [&](const xml::Element& child) {
                                    reader->CheckAttributes(child, {"operation"});
                                    out.events.push_back({reader->Name(child, "operation"), child.span});
                                    reader->ReadChildren(child, {});
                                  }}});
  if (out.events.empty()) {
    reader->Error(element.name_span, "<case> has no <event>", "write <event operation=\"…\"/>");
  }
  return out;
}

}  // namespace

Constraint ReadConstraint(const xml::Element& element, xml::ElementReader* reader) {
  Constraint out;
  out.span = element.span;
  reader->CheckAttributes(element, {"name"}, {"for"});
  if (const Text time = reader->Extension(element, "for"); time.given()) {
    reader->Error(time.span, "for stands at a <constraint>",
                  "write it at the <rule>, which may have this constraint alone");
  }
  out.name = reader->OptionalName(element, "name");
  int subjects = 0, verbs = 0, objects = 0;
  auto once = [&](int* count, Word* word, WordRole role) {
    return [count, word, role, reader, &element](const xml::Element& child) {
      if ((*count)++ > 0) {
        reader->Error(child.name_span, Concat("a second <", child.name, "> in a <constraint>"),
                      "one constraint is one subject, verb and object; write another constraint");
        return;
      }
      *word = ReadWord(child, role, reader);
      for (const auto& grandchild : child.children) {
        if (grandchild->name == "documentation" || reader->IsForeign(*grandchild)) continue;
        reader->UnknownChild(child, *grandchild, {});
      }
    };
  };
  reader->ReadChildren(element, {{"subject", once(&subjects, &out.subject, WordRole::kSubject)},
                                 {"verb", once(&verbs, &out.verb, WordRole::kVerb)},
                                 {"object", once(&objects, &out.object, WordRole::kObject)}});
  if (subjects == 0) reader->Error(element.name_span, "<constraint> has no <subject>");
  if (verbs == 0) reader->Error(element.name_span, "<constraint> has no <verb>");
  if (objects == 0) reader->Error(element.name_span, "<constraint> has no <object>");
  return out;
}

Condition ReadCondition(const xml::Element& element, const Limits& limits, xml::ElementReader* reader) {
  Condition out;
  out.span = element.span;
  reader->CheckAttributes(element, {"expression"}, {"timeout"});
  out.expression_text = reader->Attribute(element, "expression");
  out.expression = ReadExpression(out.expression_text, limits, reader);
  out.timeout_text = reader->Extension(element, "timeout");
  out.timeout_ms = reader->Timeout(element);
  reader->ReadChildren(
      element,
      {{"case",
        [&](const xml::Element& child) {
          if (!out.cases.empty()) {
            reader->Error(child.name_span, "a second <case> in a <condition>",
                          "put its events into the first and say how they belong together in its expression");
          }
          out.cases.push_back(ReadCase(child, limits, reader));
        }},
       {"context",
        [&](const xml::Element& child) { out.contexts.push_back(ReadContext(child, limits, reader)); }}});
  return out;
}

}  // namespace docent::cawl
