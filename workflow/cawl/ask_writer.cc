#include "workflow/cawl/ask_writer.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {
namespace {

// The part of PN_LOCAL (SPARQL 1.1 grammar, rule 169) that needs no thought.
bool IsPlainLocal(std::string_view local) {
  if (local.empty() || (!absl::ascii_isalnum(local[0]) && local[0] != '_')) return false;
  return std::all_of(local.begin(), local.end(),
                     [](char c) { return absl::ascii_isalnum(c) || c == '_' || c == '-'; });
}

bool IsPlainPrefix(std::string_view prefix) {
  if (prefix.empty() || !absl::ascii_isalpha(prefix[0])) return false;
  return std::all_of(prefix.begin(), prefix.end(),
                     [](char c) { return absl::ascii_isalnum(c) || c == '_' || c == '-'; });
}

std::string_view Symbol(Word::Comparison comparison) {
  switch (comparison) {
    case Word::Comparison::kNone:
    case Word::Comparison::kEqual:
      return "=";
    case Word::Comparison::kNotEqual:
      return "!=";
    case Word::Comparison::kLess:
      return "<";
    case Word::Comparison::kLessOrEqual:
      return "<=";
    case Word::Comparison::kGreater:
      return ">";
    case Word::Comparison::kGreaterOrEqual:
      return ">=";
  }
  return "=";
}

// "name.part" as the name of a SPARQL variable.
std::string VariableText(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

void AppendLine(int indent, std::string_view line, std::string* out) {
  out->append(static_cast<size_t>(indent) * 2, ' ');
  out->append(line);
  out->push_back('\n');
}

absl::Status Refused(const std::string& why) {
  return absl::InvalidArgumentError(why);
}

}  // namespace

AskWriter::AskWriter(const Document& document, const VariableValues& values, const Limits& limits)
    : values_(values), limits_(limits) {
  std::set<std::string> taken;
  auto add = [&](std::string_view prefix, std::string_view iri) {
    if (iri.find(':') == std::string_view::npos || !IsPlainPrefix(prefix) ||
        !taken.insert(std::string(prefix)).second)
      return;
    if (iri.find_first_of("<>\"{}|^`\\ \n\t\r") != std::string_view::npos) return;
    prefixes_.emplace_back(iri, prefix);
  };
  for (const auto& [prefix, iri] : document.prefixes) add(prefix, iri);
  for (const auto& [prefix, iri] : kWellKnownPrefixes) add(prefix, iri);
  std::stable_sort(prefixes_.begin(), prefixes_.end(),
                   [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
}

absl::Status AskWriter::Write(const std::vector<Conjunction>& alternatives) {
  return WriteAlternatives(alternatives, 1, /*negated=*/false, &body_);
}

std::string AskWriter::Text() const {
  std::string out;
  for (const auto& [prefix, iri] : used_prefixes_)
    absl::StrAppend(&out, "PREFIX ", prefix, ": <", iri, ">\n");
  return absl::StrCat(out, "ASK {\n", body_, "}");
}

absl::Status AskWriter::WriteAlternatives(const std::vector<Conjunction>& alternatives, int indent,
                                          bool negated, std::string* out) {
  if (alternatives.size() == 1) return WriteConjunction(alternatives[0], indent, negated, out);
  for (size_t i = 0; i < alternatives.size(); ++i) {
    AppendLine(indent, i == 0 ? "{" : "UNION {", out);
    absl::Status status = WriteConjunction(alternatives[i], indent + 1, negated, out);
    if (!status.ok()) return status;
    AppendLine(indent, "}", out);
  }
  return absl::OkStatus();
}

absl::Status AskWriter::WriteConjunction(const Conjunction& conjunction, int indent, bool negated,
                                         std::string* out) {
  Group group;
  for (const Event* event : conjunction.events) {
    AddEvent(*event, negated, &group);
    if (!negated && conjunction.events.size() > 1) Note(event->operation.value, &joint_events_);
  }
  for (const Constraint* constraint : conjunction.constraints) {
    absl::Status status = AddConstraint(*constraint, negated, &group);
    if (status.ok()) status = CheckLength(out->size() + group.bytes);
    if (!status.ok()) return status;
  }
  if (!negated) {
    TellEventsApart(conjunction, &group);
    for (const Formula& absent : conjunction.absent) AddKnownTimes(absent, &group);
  }
  for (const std::string& line : group.triples) AppendLine(indent, line, out);
  for (const std::string& line : group.filters) AppendLine(indent, line, out);
  if (absl::Status status = CheckLength(out->size()); !status.ok()) return status;
  for (const Formula& absent : conjunction.absent) {
    absl::StatusOr<std::vector<Conjunction>> inner = ToAlternatives(absent);
    if (!inner.ok()) return inner.status();
    // "Neither a nor b" is "no a" and "no b": no UNION is needed inside.
    for (const Conjunction& alternative : *inner) {
      AppendLine(indent, "FILTER NOT EXISTS {", out);
      absl::Status status = WriteConjunction(alternative, indent + 1, /*negated=*/true, out);
      if (!status.ok()) return status;
      AppendLine(indent, "}", out);
    }
  }
  return absl::OkStatus();
}

absl::Status AskWriter::CheckLength(size_t bytes) const {
  if (bytes <= limits_.query_text_bytes) return absl::OkStatus();
  return Refused(absl::StrCat("the condition as SPARQL has more than ", limits_.query_text_bytes,
                              " bytes; the limit query_text_bytes is ", limits_.query_text_bytes));
}

void AskWriter::Group::Add(std::string line, std::vector<std::string>* lines) {
  if (std::find(lines->begin(), lines->end(), line) != lines->end()) return;
  bytes += line.size();
  lines->push_back(std::move(line));
}

absl::Status AskWriter::AddConstraint(const Constraint& constraint, bool negated, Group* group) {
  absl::StatusOr<std::string> subject = Value(constraint.subject, negated);
  if (!subject.ok()) return subject.status();
  if (constraint.time == Constraint::Time::kOccurs) {
    group->AddTriple(Concat(*subject, " ", Short(constraint.verb.term.lexical), " ?",
                            EventVariable(&constraint, negated), " ."));
    return absl::OkStatus();
  }
  absl::StatusOr<std::string> verb = Value(constraint.verb, negated);
  if (!verb.ok()) return verb.status();
  if (std::optional<Term> known = ValueOf(constraint.verb); known && !known->IsIri()) {
    return Refused(Concat("$", constraint.verb.name, " is the literal ", *verb, " and cannot be a verb"));
  }
  bool compares = constraint.object.comparison != Word::Comparison::kNone;
  absl::StatusOr<std::string> object = Value(constraint.object, negated || compares);
  if (!object.ok()) return object.status();
  std::string found = *object;
  if (compares) {
    int number = compared_.emplace(&constraint, static_cast<int>(compared_.size()) + 1).first->second;
    found = absl::StrCat("?_", number);
    group->AddFilter(Concat("FILTER (", found, " ", Symbol(constraint.object.comparison), " ", *object, ")"));
  }
  group->AddTriple(Concat(*subject, " ", *verb, " ", found, " ."));
  absl::Status status = AddType(constraint.subject, *subject, group);
  if (!status.ok()) return status;
  return AddType(constraint.object, found, group);
}

absl::Status AskWriter::AddType(const Word& word, const std::string& value, Group* group) {
  if (!word.type_term) return absl::OkStatus();
  std::string type = Short(word.type_term->lexical);
  if (word.type_term->lexical.starts_with(kXsdNs)) {
    group->AddFilter(Concat("FILTER (DATATYPE(", value, ") = ", type, ")"));
  } else if (std::optional<Term> known = ValueOf(word); known && known->IsLiteral()) {
    return Refused(Concat("$", word.name, " is the literal ", value, " and cannot be of type ", type));
  } else {
    group->AddTriple(Concat(value, " ", Short(std::string(kRdfType)), " ", type, " ."));
  }
  return absl::OkStatus();
}

void AskWriter::AddEvent(const Event& event, bool negated, Group* group) {
  const std::string name = EventVariable(&event, negated);
  group->AddTriple(
      Concat("?", name, " ", Short(std::string(kRdfType)), " ", Short(DocentIri("Event")), " ."));
  group->AddTriple(Concat("?", name, " ", Short(DocentIri("operation")), " ",
                          ToNTriples(Term::Literal(event.operation.value)), " ."));
}

// A variable of a constraint that stands for an event of an operation that is waited for stands for the event that is
// counted: of several that one batch tells, each goes with what is told of itself.
void AskWriter::TellEventsApart(const Conjunction& conjunction, Group* group) {
  std::map<std::string, std::vector<std::string>> events;  // by operation: their variables
  for (const Event* event : conjunction.events)
    events[event->operation.value].push_back(absl::StrCat("?", EventVariable(event, /*negated=*/false)));
  if (events.empty()) return;
  std::vector<std::string> variables;
  for (const Constraint* constraint : conjunction.constraints) {
    for (const Word* word : {&constraint->subject, &constraint->object}) {
      if (word->comparison != Word::Comparison::kNone) continue;
      if (word->kind == Word::Kind::kFree) Note("?" + word->name, &variables);
      if (word->kind == Word::Kind::kVariable && !ValueOf(*word))
        Note(absl::StrCat("?", VariableText(word->name)), &variables);
    }
  }
  for (const auto& [operation, of_operation] : events) {
    for (const std::string& variable : variables) {
      const std::string same = of_operation.size() == 1
                                   ? Concat(variable, " = ", of_operation[0])
                                   : Concat(variable, " IN (", absl::StrJoin(of_operation, ", "), ")");
      group->AddFilter(Concat("FILTER (", same, " || NOT EXISTS { ", variable, " ",
                              Short(DocentIri("operation")), " ", ToNTriples(Term::Literal(operation)),
                              " })"));
    }
  }
}

std::string AskWriter::EventVariable(const void* event, bool negated) {
  const int number = events_.emplace(event, static_cast<int>(events_.size()) + 1).first->second;
  std::string name = absl::StrCat("_event_", number);
  if (!negated) Note(name, &event_variables_);
  return name;
}

void AskWriter::AddKnownTimes(const Formula& formula, Group* group) {
  for (const Formula& child : formula.children) AddKnownTimes(child, group);
  if (formula.kind != Formula::Kind::kConstraint) return;
  const Constraint& constraint = *formula.constraint;
  // whether a place is open is always told
  if (constraint.time != Constraint::Time::kLasts || constraint.verb.term.lexical != DocentIri("timeHolds"))
    return;
  const int number = compared_.emplace(&constraint, static_cast<int>(compared_.size()) + 1).first->second;
  group->AddTriple(Concat(Short(constraint.subject.term.lexical), " ", Short(constraint.verb.term.lexical),
                          absl::StrCat(" ?_", number), " ."));
}

std::optional<Term> AskWriter::ValueOf(const Word& word) const {
  if (word.kind == Word::Kind::kVariable) return values_(word.name);
  return word.kind == Word::Kind::kTerm ? std::optional<Term>(word.term) : std::nullopt;
}

absl::StatusOr<std::string> AskWriter::Value(const Word& word, bool negated) {
  switch (word.kind) {
    case Word::Kind::kTerm:
      return TermText(word.term);
    case Word::Kind::kFree:
      if (!negated) Note(word.name, &free_variables_);
      return "?" + word.name;
    case Word::Kind::kVariable: {
      std::optional<Term> value = ValueOf(word);
      if (value && value->IsBlank()) {
        return absl::InvalidArgumentError(
            absl::StrCat("the value of $", word.name,
                         " is a blank node, which a condition cannot name; give the thing an IRI"));
      }
      if (value) return TermText(*value);
      std::string name = VariableText(word.name);
      Note(name, &unset_);
      if (!negated) Note(name, &free_variables_);
      return "?" + name;
    }
    case Word::Kind::kMissing:
      break;
  }
  return absl::InvalidArgumentError("a word is missing in a constraint");
}

absl::StatusOr<std::string> AskWriter::TermText(const Term& term) {
  if (term.IsIri()) return Short(term.lexical);
  if (term.datatype.empty() || !term.language.empty()) return ToNTriples(term);
  xml::TermError unused;
  if (xml::ParseTerm(term.lexical, {}, &unused) == term) return term.lexical;  // 0.5, 7, true
  return Concat(ToNTriples(Term::Literal(term.lexical)), "^^", Short(term.datatype));
}

std::string AskWriter::Short(const std::string& iri) {
  for (const auto& [space, prefix] : prefixes_) {
    if (!iri.starts_with(space) || !IsPlainLocal(std::string_view(iri).substr(space.size()))) continue;
    used_prefixes_.emplace(prefix, space);
    return prefix + ":" + iri.substr(space.size());
  }
  return ToNTriples(Term::Iri(iri));
}

void AskWriter::Note(const std::string& name, std::vector<std::string>* list) {
  if (std::find(list->begin(), list->end(), name) == list->end()) list->push_back(name);
}

}  // namespace docent::cawl
