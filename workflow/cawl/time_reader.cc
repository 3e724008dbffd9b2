#include "workflow/cawl/time_reader.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_replace.h"
#include "graph/base/text.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/cawl/formula.h"
#include "workflow/cawl/word_reader.h"

namespace docent::cawl {
namespace {

const std::vector<std::string>& Attributes() {
  static const std::vector<std::string>* const names =
      new std::vector<std::string>{"name",  "between", "days",  "from", "until", "at",
                                   "every", "aligned", "after", "open", "zone",  "missed"};
  return *names;
}

Word TermWord(Term term, const SourceSpan& span) {
  Word word;
  word.kind = Word::Kind::kTerm;
  word.term = std::move(term);
  word.span = span;
  return word;
}

class TimeReader {
 public:
  TimeReader(const xml::Element& element, xml::ElementReader* reader, Rule* rule)
      : element_(element), reader_(*reader), rule_(*rule) {}

  void Read() {
    if (element_.namespace_iri != kExtensionNs) {
      reader_.Error(
          element_.name_span, Concat("<", element_.name, "> is an extension of Docent"),
          Concat("declare xmlns:ext=\"", kExtensionNs, "\" on the root element and write <ext:time …/>"));
      return;
    }
    reader_.CheckAttributes(element_, Attributes());
    reader_.ReadChildren(element_, {});
    for (const std::string& name : Attributes()) {
      Text text = reader_.Attribute(element_, name);
      if (text.given() && name != "name") given_.emplace_back(name, std::move(text));
    }
    if (Find("after") != nullptr) return ReadAfter();
    if (Find("open") != nullptr) return ReadOpen();
    ReadSpec();
  }

 private:
  const Text* Find(const std::string& name) const {
    for (const auto& [word, text] : given_) {
      if (word == name) return &text;
    }
    return nullptr;
  }

  // False: another attribute stands beside the one that says all.
  bool Alone(const std::string& name, std::string_view hint) {
    for (const auto& [word, text] : given_) {
      if (word == name) continue;
      reader_.Error(text.span, Concat(word, " stands beside ", name), std::string(hint));
      return false;
    }
    return true;
  }

  void ReadAfter() {
    const Text& text = *Find("after");
    if (!Alone("after", "after is a time of its own; write a second <ext:time>")) return;
    if (const Text name = reader_.Attribute(element_, "name"); name.given()) {
      reader_.Error(name.span, "a time with after has a name",
                    "it cannot stand in an expression: it counts for the whole context; leave the name out");
      return;
    }
    int64_t ms = 0;
    if (!xml::ParseDurationMs(text.value, &ms)) {
      reader_.Error(text.span, Concat("after \"", text.value, "\" is not a duration"),
                    "write a number above 0 and ms, s, min or h, e.g. 30s; at most 720h");
      return;
    }
    if (rule_.after_ms && *rule_.after_ms >= ms) return;
    rule_.after_ms = ms;
    rule_.after_text = text;
  }

  void ReadOpen() {
    const Text& text = *Find("open");
    if (!Alone("open", "the opening hours say all; write a second <ext:time>")) return;
    if (text.empty()) {
      reader_.Error(text.span, "open names no place", "write a place or a variable: open=\"museum:Hall\"");
      return;
    }
    std::optional<Constraint> constraint = ReadConstraintText(
        element_, {Concat(text.value, " <", kDocentNs, "openNow> true"), text.span}, &reader_);
    if (!constraint) return;
    Add(std::move(constraint->subject), "openNow", Constraint::Time::kLasts);
  }

  void ReadSpec() {
    calendar::TimeWords words;
    for (const auto& [name, text] : given_) words.emplace(name, text.value);
    if (!words.contains("zone") && reader_.root() != nullptr) {
      const Text zone = reader_.Extension(*reader_.root(), "zone");
      if (zone.given()) words.emplace("zone", zone.value);
    }
    std::vector<calendar::TimeFault> faults;
    const std::optional<calendar::TimeSpec> spec = calendar::ParseTimeSpec(words, &faults);
    for (const calendar::TimeFault& fault : faults) Tell(fault);
    if (!spec) return;
    if (spec->is_steady() && reader_.root() != nullptr) {
      // Intervals are counted for each document by itself.
      std::string name = IriSegment(reader_.Attribute(*reader_.root(), "name").value);
      words.emplace("of", absl::StrReplaceAll(name, {{";", "%3B"}, {"=", "%3D"}}));
      words.erase("zone");
    }
    Add(TermWord(Term::Iri(calendar::TimeIri(words)), element_.name_span),
        spec->is_level() ? "timeHolds" : "occurs",
        spec->is_level() ? Constraint::Time::kLasts : Constraint::Time::kOccurs);
  }

  void Tell(const calendar::TimeFault& fault) {
    const Text* at = Find(fault.word);
    if (at == nullptr && fault.word == "zone") return;  // the root element's: CheckZone tells
    const SourceSpan span = at != nullptr ? at->span : element_.name_span;
    reader_.Error(span, fault.message,
                  fault.right.empty() || at == nullptr ? xml::Advice(fault.hint)
                                                       : xml::Advice(fault.hint, at->value, fault.right));
  }

  void Add(Word subject, std::string_view verb, Constraint::Time time) {
    Constraint constraint;
    constraint.name = reader_.OptionalName(element_, "name");
    constraint.subject = std::move(subject);
    constraint.verb = TermWord(Term::Iri(DocentIri(verb)), element_.name_span);
    constraint.object = TermWord(Term::Boolean(true), element_.name_span);
    constraint.span = element_.span;
    constraint.time = time;
    rule_.constraints.push_back(std::move(constraint));
  }

  const xml::Element& element_;
  xml::ElementReader& reader_;
  Rule& rule_;
  std::vector<std::pair<std::string, Text>> given_;
};

class TimeChecker {
 public:
  explicit TimeChecker(xml::ElementReader* reader) : reader_(*reader) {}

  void Check(const Condition& condition, bool of_activator) {
    for (const Context& context : condition.contexts) {
      for (const Rule& rule : context.rules) {
        CheckAfter(rule, condition, of_activator);
        CheckAbsent(FormulaOf(rule), false);
        for (const Constraint& constraint : rule.constraints) {
          if (constraint.time != Constraint::Time::kOccurs) continue;
          if (rule.at_least_ms) {
            reader_.Error(rule.for_text.span, "a rule with for has a time that occurs and does not last",
                          "put the time into a rule of its own");
          }
          if (of_activator) continue;
          const std::optional<calendar::TimeWords> words =
              calendar::WordsOfTimeIri(constraint.subject.term.lexical);
          const auto spec = words ? calendar::ParseTimeSpec(*words) : std::nullopt;
          if (spec && spec->is_steady()) {
            reader_.Error(constraint.subject.span, "the interval of a node's condition is not aligned",
                          "write after=\"…\" to wait so long in the node, or aligned=\"true\"");
          }
        }
      }
    }
    if (condition.expression) CheckAbsent(FormulaOf(condition), false);
  }

 private:
  void CheckAfter(const Rule& rule, const Condition& condition, bool of_activator) {
    if (!rule.after_ms) return;
    if (of_activator)
      reader_.Error(rule.after_text.span, "an activator is not entered: after has nothing to count from",
                    "write every=\"…\", or give after to the condition of a node");
    else if (condition.expression)
      reader_.Error(rule.after_text.span, "a time with after stands in a condition with an expression",
                    "leave the expression out: contexts are alternatives");
  }

  void CheckAbsent(const Formula& formula, bool absent) {
    if (formula.kind == Formula::Kind::kConstraint) {
      const Constraint& constraint = *formula.constraint;
      if (!absent || constraint.time != Constraint::Time::kOccurs || !told_.insert(&constraint).second)
        return;
      reader_.Error(constraint.subject.span, "a time that occurs stands under not",
                    "only what lasts can be absent: write between=\"…\"");
      return;
    }
    for (const Formula& child : formula.children)
      CheckAbsent(child, absent != (formula.kind == Formula::Kind::kNot));
  }

  xml::ElementReader& reader_;
  std::set<const Constraint*> told_;
};

}  // namespace

void ReadTime(const xml::Element& element, xml::ElementReader* reader, Rule* rule) {
  TimeReader(element, reader, rule).Read();
}

void CheckZone(const Text& zone, xml::ElementReader* reader) {
  std::vector<calendar::TimeFault> faults;
  if (!zone.given() || calendar::ParseTimeSpec({{"days", "Mon"}, {"zone", zone.value}}, &faults)) return;
  const calendar::TimeFault& fault = faults.front();
  reader->Error(
      zone.span, fault.message,
      fault.right.empty() ? xml::Advice(fault.hint) : xml::Advice(fault.hint, zone.value, fault.right));
}

void CheckTimes(const Document& document, xml::ElementReader* reader) {
  TimeChecker checker(reader);
  if (document.activator) checker.Check(document.activator->condition, /*of_activator=*/true);
  for (const Flow& flow : document.flows) {
    for (const Node& node : flow.nodes) {
      if (node.condition) checker.Check(*node.condition, /*of_activator=*/false);
    }
  }
}

std::vector<int64_t> DelaysOf(const Condition& condition) {
  if (condition.expression) return {};
  std::vector<const Context*> contexts;
  bool any = false;
  for (const Context& context : condition.contexts) {
    contexts.push_back(&context);
    any = any || std::any_of(context.rules.begin(), context.rules.end(),
                             [](const Rule& rule) { return rule.after_ms.has_value(); });
  }
  if (!any) return {};
  std::stable_sort(contexts.begin(), contexts.end(),
                   [](const Context* a, const Context* b) { return a->priority < b->priority; });
  std::vector<int64_t> delays;
  for (const Context* context : contexts) {
    int64_t& longest = delays.emplace_back(0);
    for (const Rule& rule : context->rules) longest = std::max(longest, rule.after_ms.value_or(0));
  }
  return delays;
}

}  // namespace docent::cawl
