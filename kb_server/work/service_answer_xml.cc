#include "kb_server/work/service_answer_xml.h"

#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/formats/mistake_list.h"
#include "graph/rdf/formats/xml_reader.h"
#include "kb_server/work/service_rows.h"

namespace docent::server {
namespace {

constexpr std::string_view kResultsNs = "http://www.w3.org/2005/sparql-results#";

std::string_view ValueOf(const XmlElement& element, std::string_view name, std::string_view iri = "") {
  for (const XmlAttribute& attribute : element.attributes) {
    if (attribute.name.local == name && attribute.name.iri == iri) return attribute.value;
  }
  return "";
}

// <sparql><head><variable name="x"/></head><results><result><binding name="x"><uri>…</uri></binding></result></results>
class AnswerReader : public XmlEvents {
 public:
  AnswerReader(const Limits& limits, MemoryUse* memory) : limits_(limits), rows_(limits, memory) {}

  void SetReader(XmlReader* reader) { reader_ = reader; }

  void OnStart(const XmlElement& element) override {
    if (element.name.iri != kResultsNs) return;
    const std::string_view name = element.name.local;
    if (name == "variable") {
      Look(rows_.AddVariable(std::string(ValueOf(element, "name"))));
    } else if (name == "results") {
      is_select_ = true;
    } else if (name == "result") {
      Look(rows_.BeginRow());
    } else if (name == "binding") {
      variable_ = ValueOf(element, "name");
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
    Look(rows_.Bind(variable_, term_.IsLiteral() && term_.language.empty()
                                   ? Term::Literal(std::move(term_.lexical), std::move(term_.datatype))
                                   : std::move(term_)));
  }

  void OnText(std::string_view text) override {
    if (in_term_ && term_.lexical.size() <= limits_.term_bytes) term_.lexical.append(text);
  }
  void OnComment(std::string_view) override {}
  void OnInstruction(std::string_view, std::string_view) override {}

  absl::StatusOr<sparql::ServiceAnswer> Take() {
    if (!status_.ok()) return status_;
    if (!is_select_) return absl::UnknownError("the answer is XML, but no rows of SPARQL results");
    return rows_.Take();
  }

 private:
  // Keeps the first error, and reads no further.
  void Look(absl::Status status) {
    if (status.ok() || !status_.ok()) return;
    status_ = std::move(status);
    reader_->Stop();
  }

  const Limits& limits_;
  ServiceRows rows_;
  XmlReader* reader_ = nullptr;
  std::string variable_;  // of the binding
  Term term_;
  bool in_term_ = false, is_select_ = false;
  absl::Status status_;
};

}  // namespace

absl::StatusOr<sparql::ServiceAnswer> ReadXmlAnswer(const std::string& body, const Limits& limits,
                                                    Cancellation* cancellation, MemoryUse* memory) {
  ParseRdfOptions options;
  options.limits = limits;
  options.cancellation = cancellation;
  const std::string_view text = body.starts_with("\xEF\xBB\xBF") ? std::string_view(body).substr(3) : body;
  MistakeList mistakes(text, options);
  AnswerReader answer(limits, memory);
  XmlReader reader(text, options, &answer, &mistakes);
  answer.SetReader(&reader);
  if (absl::Status status = reader.Run(); !status.ok()) return status;
  if (mistakes.has_errors()) {
    const Diagnostic mistake = mistakes.Take().front();
    return absl::UnknownError(absl::StrCat("the answer is not XML: line ", mistake.span.line, ", column ",
                                           mistake.span.column, ": ", mistake.message));
  }
  return answer.Take();
}

}  // namespace docent::server
