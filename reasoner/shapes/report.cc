#include "reasoner/shapes/report.h"

#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/cut_text.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::shapes {
namespace {

std::string Joined(const Path& path, std::string_view separator, const Dictionary& dictionary) {
  std::string out;
  for (const Path& child : path.children) {
    if (!out.empty()) out += separator;
    const bool group = child.kind == Path::Kind::kSequence || child.kind == Path::Kind::kAlternative;
    out += group ? Concat("(", PathText(child, dictionary), ")") : PathText(child, dictionary);
  }
  return out;
}

// The child path, in brackets if an operator before or after it would bind to a part of it.
std::string Grouped(const Path& child, const Dictionary& dictionary) {
  std::string text = PathText(child, dictionary);
  return child.kind == Path::Kind::kPredicate ? text : Concat("(", text, ")");
}

std::string SeverityText(TermId severity, const Dictionary& dictionary) {
  const std::string iri = dictionary.Decode(severity).lexical;
  if (iri == Shacl("Warning")) return "warning";
  if (iri == Shacl("Info")) return "info";
  return iri == Shacl("Violation") ? "violation" : ToDisplay(Term::Iri(iri));
}

// The message for a reader of English: an English text, else one without language, else the first.
std::string MessageText(const std::vector<Term>& messages) {
  const auto english = [](const Term& message) { return SameLanguage(message.language.substr(0, 2), "en"); };
  const Term* best = &messages[0];
  for (const Term& message : messages) {
    if (message.language.empty() && !english(*best)) best = &message;
    if (english(message)) best = &message;
  }
  return best->lexical;
}

void AddDetails(const ValidationResult& result, const Dictionary& dictionary, int depth,
                std::vector<std::string>* out) {
  constexpr size_t kMost = 20;
  for (const ValidationResult& detail : result.details) {
    if (out->size() >= kMost) return;
    const ResultText text = Describe(detail, dictionary, nullptr, nullptr);
    std::string line(static_cast<size_t>(depth) * 2, ' ');
    absl::StrAppend(&line, text.focus, text.path.empty() ? "" : " ", text.path, text.value.empty() ? "" : " ",
                    text.value, ": ", text.message);
    out->push_back(std::move(line));
    AddDetails(detail, dictionary, depth + 1, out);
  }
}

// The report's triples.
class RdfReport {
 public:
  RdfReport(const Dictionary& dictionary, const std::string& label_prefix)
      : dictionary_(dictionary), label_prefix_(label_prefix) {}

  std::vector<TermQuad> Write(const ValidationReport& report) {
    const Term root = NewNode();
    Say(root, std::string(kRdfType), Term::Iri(Shacl("ValidationReport")));
    Say(root, Shacl("conforms"), Term::Boolean(report.conforms()));
    for (const ValidationResult& result : report.results) Say(root, Shacl("result"), Write(result));
    return std::move(quads_);
  }

 private:
  Term NewNode() { return Term::Blank(absl::StrCat(label_prefix_, ++count_)); }
  void Say(const Term& subject, const std::string& predicate, Term object) {
    quads_.push_back({subject, Term::Iri(predicate), std::move(object), Term()});
  }

  Term Write(const ValidationResult& result) {
    const Term node = NewNode();
    Say(node, std::string(kRdfType), Term::Iri(Shacl("ValidationResult")));
    Say(node, Shacl("focusNode"), dictionary_.Decode(result.focus));
    if (result.has_path) Say(node, Shacl("resultPath"), Write(result.path));
    if (const auto value = ValueOf(result, dictionary_)) Say(node, Shacl("value"), *value);
    Say(node, Shacl("resultSeverity"),
        result.severity == kAbsentTerm ? Term::Iri(Shacl("Violation")) : dictionary_.Decode(result.severity));
    Say(node, Shacl("sourceConstraintComponent"),
        result.component == Component::kOwn ? dictionary_.Decode(result.own_component)
                                            : Term::Iri(ComponentIri(result.component)));
    if (!result.constraint.IsNone())
      Say(node, Shacl("sourceConstraint"), dictionary_.Decode(result.constraint));
    Say(node, Shacl("sourceShape"), dictionary_.Decode(result.shape));
    for (const Term& message : result.messages) Say(node, Shacl("resultMessage"), message);
    for (const ValidationResult& detail : result.details) Say(node, Shacl("detail"), Write(detail));
    return node;
  }

  Term Write(const Path& path) {
    static constexpr const char* kWords[] = {
        "", "inversePath", "", "alternativePath", "zeroOrMorePath", "oneOrMorePath", "zeroOrOnePath"};
    switch (path.kind) {
      case Path::Kind::kPredicate:
        return dictionary_.Decode(path.predicate);
      case Path::Kind::kSequence:
        return WriteList(path.children);
      default:
        break;
    }
    const Term node = NewNode();
    const Term value =
        path.kind == Path::Kind::kAlternative ? WriteList(path.children) : Write(path.children[0]);
    Say(node, Shacl(kWords[static_cast<size_t>(path.kind)]), value);
    return node;
  }

  Term WriteList(const std::vector<Path>& members) {
    Term rest = Term::Iri(Concat(kRdfNs, "nil"));
    for (auto it = members.rbegin(); it != members.rend(); ++it) {
      const Term cell = NewNode();
      Say(cell, Concat(kRdfNs, "first"), Write(*it));
      Say(cell, Concat(kRdfNs, "rest"), std::move(rest));
      rest = cell;
    }
    return rest;
  }

  const Dictionary& dictionary_;
  const std::string label_prefix_;
  std::vector<TermQuad> quads_;
  uint64_t count_ = 0;
};

void SetPlace(const SourcePlace* place, std::string* file, int* line, int* column) {
  if (place == nullptr) return;
  *file = place->file;
  *line = place->span.line;
  *column = place->span.column;
}

// The place of the value, else of the node's property, else of the node's description.
const SourcePlace* PlaceOf(const ValidationResult& result, const SourceMap& data) {
  const bool simple = result.has_path && result.path.kind == Path::Kind::kPredicate;
  const SourcePlace* place = nullptr;
  if (simple && !result.value.IsNone()) place = data.Find(result.focus, result.path.predicate, result.value);
  if (place == nullptr && simple) place = data.Find(result.focus, result.path.predicate);
  return place == nullptr ? data.Find(result.focus) : place;
}

}  // namespace

std::optional<Term> ValueOf(const ValidationResult& result, const Dictionary& dictionary) {
  if (result.computed) return result.computed;
  if (result.value.IsNone()) return std::nullopt;
  return dictionary.Decode(result.value);
}

std::string PathText(const Path& path, const Dictionary& dictionary) {
  switch (path.kind) {
    case Path::Kind::kPredicate:
      return path.predicate.IsNone() ? "" : ToDisplay(dictionary.Decode(path.predicate));
    case Path::Kind::kInverse:
      return Concat("^", Grouped(path.children[0], dictionary));
    case Path::Kind::kSequence:
      return Joined(path, "/", dictionary);
    case Path::Kind::kAlternative:
      return Joined(path, "|", dictionary);
    case Path::Kind::kZeroOrMore:
      return Concat(Grouped(path.children[0], dictionary), "*");
    case Path::Kind::kOneOrMore:
      return Concat(Grouped(path.children[0], dictionary), "+");
    case Path::Kind::kZeroOrOne:
      return Concat(Grouped(path.children[0], dictionary), "?");
  }
  return "";
}

ResultText Describe(const ValidationResult& result, const Dictionary& dictionary, const SourceMap* data,
                    const SourceMap* shapes) {
  ResultText text;
  if (data != nullptr) SetPlace(PlaceOf(result, *data), &text.file, &text.line, &text.column);
  if (shapes != nullptr) {
    SetPlace(shapes->Find(result.shape), &text.shape_file, &text.shape_line, &text.shape_column);
  }
  text.severity = result.severity == kAbsentTerm ? "violation" : SeverityText(result.severity, dictionary);
  text.focus = ToDisplay(dictionary.Decode(result.focus));
  if (result.has_path) text.path = PathText(result.path, dictionary);
  const std::optional<Term> value = ValueOf(result, dictionary);
  if (value && (result.has_path || result.computed || result.value != result.focus))
    text.value = ToDisplay(*value);
  text.shape = ToDisplay(dictionary.Decode(result.shape));
  text.component = result.component == Component::kOwn ? ToDisplay(dictionary.Decode(result.own_component))
                                                       : Concat("sh:", ParameterName(result.component));
  text.message = MessageText(result.messages);
  AddDetails(result, dictionary, 0, &text.details);
  return text;
}

std::string Render(const ResultText& result) {
  std::string out;
  if (!result.file.empty()) absl::StrAppend(&out, result.file, ":", result.line, ":", result.column, ": ");
  absl::StrAppend(&out, result.severity, ": ", result.focus, result.path.empty() ? "" : " ", result.path,
                  result.value.empty() ? "" : " ", result.value, ": ", OneLine(result.message), "\n");
  for (const std::string& detail : result.details) absl::StrAppend(&out, "    ", detail, "\n");
  absl::StrAppend(&out, "  shape ", result.shape, ", ", result.component);
  if (!result.shape_file.empty()) {
    absl::StrAppend(&out, " (", result.shape_file, ":", result.shape_line, ":", result.shape_column, ")");
  }
  return out + "\n";
}

std::string Summary(const ValidationReport& report, const Dictionary& dictionary) {
  const std::string checked =
      absl::StrCat(" (", report.focus_nodes, report.focus_nodes == 1 ? " node checked)" : " nodes checked)");
  if (report.conforms()) return Concat("conforms", checked);
  std::map<std::string, uint64_t> counts;
  for (const ValidationResult& result : report.results) {
    ++counts[result.severity == kAbsentTerm ? "violation" : SeverityText(result.severity, dictionary)];
  }
  std::string out;
  for (const auto& [severity, count] : counts) {
    absl::StrAppend(&out, out.empty() ? "" : ", ", count, " ", severity, count == 1 ? "" : "s");
  }
  if (report.total > report.results.size()) {
    absl::StrAppend(&out, " shown of ", report.total, " results (the limit validation_results)");
  }
  return out + checked;
}

std::vector<TermQuad> ToRdf(const ValidationReport& report, const Dictionary& dictionary,
                            const std::string& label_prefix) {
  return RdfReport(dictionary, label_prefix).Write(report);
}

}  // namespace docent::shapes
