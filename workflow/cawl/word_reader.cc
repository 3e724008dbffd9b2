#include "workflow/cawl/word_reader.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::cawl {
namespace {

using Place = std::function<SourceSpan(size_t offset, size_t length)>;

std::string_view RoleName(WordRole role) {
  return role == WordRole::kSubject ? "subject" : role == WordRole::kVerb ? "verb" : "object";
}

// The comparison that `text` begins with, and its length. "<" before a letter opens an IRI.
std::pair<Word::Comparison, size_t> ComparisonAt(std::string_view text) {
  using C = Word::Comparison;
  if (text.starts_with("!=")) return {C::kNotEqual, 2};
  if (text.starts_with("<=")) return {C::kLessOrEqual, 2};
  if (text.starts_with(">=")) return {C::kGreaterOrEqual, 2};
  if (text.starts_with("=")) return {C::kEqual, 1};
  if (text.starts_with(">")) return {C::kGreater, 1};
  if (text.starts_with("<") && (text.size() == 1 || !absl::ascii_isalpha(text[1]))) return {C::kLess, 1};
  return {C::kNone, 0};
}

// What other languages write for a comparison, and what is meant.
struct OtherSign {
  std::string_view sign, meant;
};

std::optional<OtherSign> OtherSignAt(std::string_view text) {
  for (const OtherSign& other : {OtherSign{"==", "="}, {"=>", ">="}, {"<>", "!="}, {"=<", "<="}}) {
    const bool opens_iri =
        other.sign == "=<" && text.size() > 2 && absl::ascii_isalpha(static_cast<unsigned char>(text[2]));
    if (text.starts_with(other.sign) && !opens_iri) return other;
  }
  return std::nullopt;
}

// "$name" or "?name" at the beginning of `text`.
void ReadVariable(std::string_view text, size_t offset, const Place& place, xml::ElementReader* reader,
                  Word* word) {
  std::string_view name = text.substr(1);
  bool is_free = text[0] == '?';
  std::string_view head = name, part;
  size_t dot = name.find('.');
  if (!is_free && dot != std::string_view::npos) {
    head = name.substr(0, dot);
    part = name.substr(dot + 1);
  }
  bool good = xml::IsVariableName(head) && (part.data() == nullptr || xml::IsVariableName(part));
  if (!good) {
    reader->Error(place(offset, text.size()), Concat(text, " is not a variable's name"),
                  is_free
                      ? "write ? and letters (a-z), digits and _, beginning with a letter"
                      : "write $name or $name.part: letters (a-z), digits and _, beginning with a letter");
    return;
  }
  word->kind = is_free ? Word::Kind::kFree : Word::Kind::kVariable;
  word->name = name;
}

Word WordOf(std::string_view text, WordRole role, const xml::Prefixes& prefixes, const Place& place,
            xml::ElementReader* reader) {
  Word word;
  size_t offset = 0;
  if (const auto other = role == WordRole::kObject ? OtherSignAt(text) : std::nullopt) {
    const std::string rest(absl::StripAsciiWhitespace(ToAbsl(text.substr(other->sign.size()))));
    reader->Error(place(0, other->sign.size()), Concat("in the object: ", other->sign, " is no comparison"),
                  xml::Advice(Concat("write ", other->meant, rest.empty() ? "" : " ", rest), other->sign,
                              std::string(other->meant)));
    return word;
  }
  if (role == WordRole::kObject) {
    std::tie(word.comparison, offset) = ComparisonAt(text);
    while (offset < text.size() && absl::ascii_isspace(text[offset])) ++offset;
  }
  std::string_view rest = text.substr(offset);
  word.span = place(offset, rest.size());
  if (rest.empty()) {
    reader->Error(place(0, text.size()),
                  text.empty() ? Concat("the ", RoleName(role), " is empty")
                               : Concat("a value is missing after ", text),
                  text.empty() ? "write $name, ?name, prefix:local, <iri> or a literal" : "e.g. > 0.5");
    return word;
  }
  if (rest[0] == '$' || rest[0] == '?') {
    ReadVariable(rest, offset, place, reader, &word);
    return word;
  }
  if (role == WordRole::kVerb && rest == "a") {
    word.kind = Word::Kind::kTerm;
    word.term = Term::Iri(std::string(kRdfType));
    return word;
  }
  xml::TermError error;
  std::optional<Term> term = xml::ParseTerm(rest, prefixes, &error);
  if (!term) {
    reader->Error(place(offset + error.offset, error.length),
                  Concat("in the ", RoleName(role), ": ", error.message),
                  xml::Advice(error.hint, error.wrong, error.right));
    return word;
  }
  if (role != WordRole::kObject && !term->IsIri()) {
    reader->Error(word.span, Concat("the ", RoleName(role), " is a literal"),
                  "a resource or a variable stands here; literals are objects");
    return word;
  }
  word.kind = Word::Kind::kTerm;
  word.term = *term;
  return word;
}

void ReadType(const xml::Element& element, xml::ElementReader* reader, Word* word) {
  word->type = reader->Attribute(element, "type");
  if (!word->type.given()) return;
  word->type_term = reader->TermOf(element, word->type);
  if (!word->type_term) return;
  bool datatype = word->type_term->lexical.starts_with(kXsdNs);
  if (!word->type_term->IsIri()) {
    reader->Error(word->type.span, "a type is a class or datatype, not a literal",
                  "e.g. docent:Robot or xsd:decimal");
    word->type_term.reset();
  } else if (word->kind == Word::Kind::kTerm && word->term.IsLiteral() != datatype) {
    reader->Error(word->type.span, Concat("type ", word->type.value,
                                          datatype ? " is a datatype but the word is a resource"
                                                   : " is a class but the word is a literal"));
    word->type_term.reset();
  } else if (datatype && word->kind == Word::Kind::kTerm) {
    word->term = Term::Literal(word->term.lexical, word->type_term->lexical);
    word->type_term.reset();
  }
}

// The next word of "subject verb object" from `at`; an object is the rest.
std::string_view NextPiece(std::string_view text, size_t* at) {
  while (*at < text.size() && absl::ascii_isspace(text[*at])) ++*at;
  size_t start = *at;
  while (*at < text.size() && !absl::ascii_isspace(text[*at])) ++*at;
  return text.substr(start, *at - start);
}

// "$n < 3", "$n != $m": a sign of a comparison where a verb stands.
bool IsComparison(std::string_view text) {
  size_t at = 0;
  const std::string_view subject = NextPiece(text, &at);
  const bool variable = subject.starts_with("$") || subject.starts_with("?");
  if (variable && subject.find_first_of("<>=") != std::string_view::npos) return true;
  const std::string_view verb = NextPiece(text, &at);
  return !verb.empty() && (OtherSignAt(verb) || ComparisonAt(verb).first != Word::Comparison::kNone);
}

}  // namespace

Word ReadWord(const xml::Element& element, WordRole role, xml::ElementReader* reader) {
  Place place = [&](size_t offset, size_t length) {
    const std::vector<size_t>& offsets = element.text_offsets;
    if (offsets.empty()) return element.name_span;
    offset = std::min(offset, offsets.size() - 1);
    size_t end = offset + length < offsets.size() ? offsets[offset + length]
                                                  : element.text.span.offset + element.text.span.length;
    return reader->Span(offsets[offset], end - offsets[offset]);
  };
  Word word = WordOf(element.text.value, role, *element.namespaces, place, reader);
  word.text = element.text;
  if (role == WordRole::kVerb) {
    reader->CheckAttributes(element, {});
  } else {
    reader->CheckAttributes(element, {"type"});
    ReadType(element, reader, &word);
  }
  return word;
}

std::optional<Constraint> ReadConstraintText(const xml::Element& element, const Text& text,
                                             xml::ElementReader* reader) {
  std::string_view value = text.value;
  size_t at = 0;
  if (IsComparison(value)) {
    reader->Error(text.span, Concat("\"", value, "\" compares two values; a pattern is needed here"),
                  "write a subject, a verb and an object, and the comparison as the object: "
                  "$user expo:visits < 3 (in XML: &lt; 3)");
    return std::nullopt;
  }
  Constraint constraint;
  constraint.span = text.span;
  Word* words[] = {&constraint.subject, &constraint.verb, &constraint.object};
  const WordRole roles[] = {WordRole::kSubject, WordRole::kVerb, WordRole::kObject};
  for (int i = 0; i < 3; ++i) {
    std::string_view piece = NextPiece(value, &at);
    if (i == 2 && !piece.empty()) piece = value.substr(piece.data() - value.data());
    size_t start = piece.empty() ? value.size() : piece.data() - value.data();
    Place place = [&](size_t offset, size_t length) { return reader->Within(text, start + offset, length); };
    *words[i] = WordOf(piece, roles[i], *element.namespaces, place, reader);
    words[i]->text = {std::string(piece), words[i]->span};
    if (words[i]->kind == Word::Kind::kMissing) return std::nullopt;
  }
  return constraint;
}

}  // namespace docent::cawl
