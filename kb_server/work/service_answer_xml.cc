#include "kb_server/work/service_answer_xml.h"

#include <optional>
#include <string_view>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/mistake_list.h"
#include "graph/rdf/formats/xml_reader.h"
#include "graph/rdf/term_check.h"

namespace docent::server {
namespace {

constexpr std::string_view kResultsNs = "http://www.w3.org/2005/sparql-results#";
constexpr size_t kValuesARow = 4;  // on the average, in an answer of as many rows as it may have

std::string_view ValueOf(const XmlElement& element, std::string_view name, std::string_view iri = "") {
  for (const XmlAttribute& attribute : element.attributes) {
    if (attribute.name.local == name && attribute.name.iri == iri) return attribute.value;
  }
  return "";
}

// <sparql><head><variable name="x"/></head><results><result><binding name="x"><uri>…</uri></binding></result></results>
class AnswerReader : public XmlEvents {
 public:
  explicit AnswerReader(const Limits& limits) : limits_(limits) {}

  void OnStart(const XmlElement& element) override {
    if (element.name.iri != kResultsNs) return;
    const std::string_view name = element.name.local;
    if (name == "variable") {
      const std::string variable(ValueOf(element, "name"));
      if (!columns_.emplace(variable, answer_.variables.size()).second)
        return Fail(absl::UnknownError("the answer names a variable twice"));
      answer_.variables.push_back(variable);
    } else if (name == "results") {
      is_select_ = true;
    } else if (name == "result") {
      BeginRow();
    } else if (name == "binding") {
      const auto column = columns_.find(std::string(ValueOf(element, "name")));
      column_ = column == columns_.end() ? std::nullopt : std::optional(column->second);
    } else if (name == "uri" || name == "bnode" || name == "literal") {
      term_ = Term();
      term_.kind = name == "uri" ? TermKind::kIri : name == "bnode" ? TermKind::kBlank : TermKind::kLiteral;
      term_.datatype = ValueOf(element, "datatype");
      term_.language = ValueOf(element, "lang", kXmlNs);
      in_term_ = true;
    }
  }

  void OnEnd(const XmlName& name) override {
    if (!in_term_ || name.iri != kResultsNs) return;
    in_term_ = false;
    if (!column_ || answer_.rows.empty() || !status_.ok()) return;
    Term term = term_.IsLiteral() && term_.language.empty()
                    ? Term::Literal(std::move(term_.lexical), std::move(term_.datatype))
                    : std::move(term_);
    if (term.IsBlank()) {  // any text may be a label there
      const auto label = labels_.try_emplace(term.lexical, labels_.size()).first;
      term.lexical = absl::StrCat("x", label->second);
    }
    if (absl::Status wrong = CheckTerm(term, limits_.term_bytes); !wrong.ok()) {
      return Fail(
          absl::UnknownError(absl::StrCat("the answer holds what is no RDF term: ", wrong.message())));
    }
    answer_.rows.back()[*column_] = std::move(term);
  }

  void OnText(std::string_view text) override {
    if (in_term_ && term_.lexical.size() <= limits_.term_bytes) term_.lexical.append(text);
  }
  void OnComment(std::string_view) override {}
  void OnInstruction(std::string_view, std::string_view) override {}

  absl::StatusOr<sparql::ServiceAnswer> Take() {
    if (!status_.ok()) return status_;
    if (!is_select_) return absl::UnknownError("the answer is XML, but no rows of SPARQL results");
    return std::move(answer_);
  }

 private:
  void BeginRow() {
    const size_t rows = answer_.rows.size() + 1;
    if (rows > limits_.remote_rows) {
      return Fail(absl::ResourceExhaustedError(
          absl::StrCat("the answer has more rows than the limit remote_rows = ", limits_.remote_rows)));
    }
    if (rows * answer_.variables.size() > kValuesARow * limits_.remote_rows) {
      return Fail(
          absl::ResourceExhaustedError(absl::StrCat("the answer has more values than ", kValuesARow,
                                                    " times the limit remote_rows = ", limits_.remote_rows)));
    }
    if (status_.ok()) answer_.rows.emplace_back(answer_.variables.size());
  }
  void Fail(absl::Status status) {
    if (status_.ok()) status_ = std::move(status);
  }

  const Limits& limits_;
  sparql::ServiceAnswer answer_;
  absl::flat_hash_map<std::string, size_t> columns_;  // of the variables
  absl::flat_hash_map<std::string, size_t> labels_;   // of blank nodes
  std::optional<size_t> column_;                      // of the binding; nullopt: the head does not name it
  Term term_;
  bool in_term_ = false, is_select_ = false;
  absl::Status status_;
};

}  // namespace

absl::StatusOr<sparql::ServiceAnswer> ReadXmlAnswer(const std::string& body, const Limits& limits,
                                                    Cancellation* cancellation) {
  ParseRdfOptions options;
  options.limits = limits;
  options.cancellation = cancellation;
  const std::string_view text = body.starts_with("\xEF\xBB\xBF") ? std::string_view(body).substr(3) : body;
  MistakeList mistakes(text, options);
  AnswerReader answer(limits);
  if (absl::Status status = XmlReader(text, options, &answer, &mistakes).Run(); !status.ok()) return status;
  if (mistakes.has_errors()) {
    const Diagnostic mistake = mistakes.Take().front();
    return absl::UnknownError(absl::StrCat("the answer is not XML: line ", mistake.span.line, ", column ",
                                           mistake.span.column, ": ", mistake.message));
  }
  return answer.Take();
}

}  // namespace docent::server
