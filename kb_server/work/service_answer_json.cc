#include "kb_server/work/service_answer_json.h"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/work/json_cursor.h"
#include "kb_server/work/service_rows.h"

namespace docent::server {
namespace {

using nlohmann::json;

constexpr size_t kDepth = 64;
constexpr size_t kBytesEscaped = 6;  // \u0041

// {"head":{"vars":["x"]},"results":{"bindings":[{"x":{"type":"uri","value":"…"}}]}}
// The results may come before the head, so the text is read twice: up to the variables, and from the beginning for the rows.
class AnswerReader final : public nlohmann::json_sax<json> {
 public:
  enum class For { kVariables, kRows };

  AnswerReader(std::string_view body, const Limits& limits, Cancellation* cancellation, ServiceRows* rows)
      : body_(body),
        most_bytes_(kBytesEscaped * (limits.term_bytes + 1) + 2),
        term_bytes_(limits.term_bytes),
        cancellation_(cancellation),
        rows_(*rows) {}

  absl::Status Read(For what) {
    what_ = what;
    open_.clear();
    has_head_ = has_bindings_ = done_ = false;
    cursor_ = {body_.data(), nullptr};
    SetBound();
    const char* const end = body_.data() + body_.size();
    const bool is_json =
        json::sax_parse(JsonIterator(body_.data(), &cursor_), JsonIterator(end, &cursor_), this);
    if (!status_.ok() || done_) return status_;
    if (!is_json && cursor_.at == cursor_.bound && cursor_.bound != end) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "the answer has a text longer than the limit term_bytes = ", term_bytes_, ", or a gap as long"));
    }
    if (!is_json) return absl::UnknownError("the answer is not JSON");
    if (has_head_ && has_bindings_) return absl::OkStatus();
    return absl::UnknownError("the answer is JSON, but no rows of SPARQL results");
  }

  bool null() override { return Value(nullptr); }
  bool boolean(bool) override { return Value(nullptr); }
  bool number_integer(number_integer_t) override { return Value(nullptr); }
  bool number_unsigned(number_unsigned_t) override { return Value(nullptr); }
  bool number_float(number_float_t, const string_t&) override { return Value(nullptr); }
  bool string(string_t& text) override { return Value(&text); }
  bool binary(binary_t&) override { return true; }

  bool key(string_t& name) override {
    if (!Step()) return false;
    Level& object = open_.back();
    object.next = MemberOf(object.what, name);
    if (object.next == What::kCell) variable_ = std::move(name);
    return true;
  }
  bool start_object(size_t) override { return Open(false); }
  bool start_array(size_t) override { return Open(true); }
  bool end_object() override { return Close(); }
  bool end_array() override { return Close(); }
  bool parse_error(size_t, const std::string&, const json::exception&) override { return false; }

 private:
  // What a value is by its place.
  enum class What {
    kRoot,
    kHead,
    kVariables,
    kVariable,
    kResults,
    kBindings,
    kRow,
    kCell,
    kType,
    kValue,
    kLanguage,
    kDatatype,
    kOther
  };
  struct Level {
    What what;
    What next;  // the value that comes next in it
  };

  static What MemberOf(What object, const std::string& name) {
    switch (object) {
      case What::kRoot:
        return name == "head" ? What::kHead : name == "results" ? What::kResults : What::kOther;
      case What::kHead:
        return name == "vars" ? What::kVariables : What::kOther;
      case What::kResults:
        return name == "bindings" ? What::kBindings : What::kOther;
      case What::kRow:
        return What::kCell;
      case What::kCell:
        if (name == "type") return What::kType;
        if (name == "value") return What::kValue;
        if (name == "xml:lang") return What::kLanguage;
        return name == "datatype" ? What::kDatatype : What::kOther;
      default:
        return What::kOther;
    }
  }
  static bool IsList(What what) { return what == What::kVariables || what == What::kBindings; }
  static bool IsObject(What what) {
    return what == What::kRoot || what == What::kHead || what == What::kResults || what == What::kRow ||
           what == What::kCell;
  }

  void SetBound() {
    const size_t left = static_cast<size_t>(body_.data() + body_.size() - cursor_.at);
    cursor_.bound = cursor_.at + std::min(left, most_bytes_);
  }
  bool Step() {
    SetBound();
    if (cancellation_ != nullptr) status_ = cancellation_->Check();
    return status_.ok();
  }
  bool Fail(absl::Status status) {
    status_ = std::move(status);
    return false;
  }
  bool FailAt(What what) {
    const bool in_rows = what == What::kRow || what == What::kCell || what == What::kType ||
                         what == What::kValue || what == What::kLanguage || what == What::kDatatype;
    return Fail(absl::UnknownError(in_rows ? "the answer holds what is no RDF term"
                                           : "the answer is JSON, but no rows of SPARQL results"));
  }
  What Next() const { return open_.empty() ? What::kRoot : open_.back().next; }
  // Whether this reading is about the parts of rows.
  bool InRows() const { return what_ == For::kRows; }

  // A value that is neither object nor list; null: no text.
  bool Value(std::string* text) {
    if (!Step()) return false;
    const What what = Next();
    if (what == What::kOther) return true;
    std::optional<std::string>* const part = PartOf(what);
    if (text == nullptr || (part == nullptr && what != What::kVariable)) return FailAt(what);
    if (part != nullptr) {
      *part = std::move(*text);
    } else if (!InRows()) {
      return Take(rows_.AddVariable(std::move(*text)));
    }
    return true;
  }
  std::optional<std::string>* PartOf(What what) {
    switch (what) {
      case What::kType:
        return &type_;
      case What::kValue:
        return &value_;
      case What::kLanguage:
        return &language_;
      case What::kDatatype:
        return &datatype_;
      default:
        return nullptr;
    }
  }

  bool Open(bool is_list) {
    if (!Step()) return false;
    const What what = Next();
    if (open_.size() == kDepth)
      return Fail(absl::UnknownError(
          absl::StrCat("the answer has more than ", kDepth, " objects and lists inside each other")));
    if (what != What::kOther && (is_list ? !IsList(what) : !IsObject(what))) return FailAt(what);
    open_.push_back({what, what == What::kVariables  ? What::kVariable
                           : what == What::kBindings ? What::kRow
                                                     : What::kOther});
    has_head_ = has_head_ || what == What::kHead;
    if (what == What::kBindings && std::exchange(has_bindings_, true))
      return Fail(absl::UnknownError("the answer has its rows twice"));
    if (what == What::kRow && InRows()) return Take(rows_.BeginRow());
    if (what == What::kCell) type_ = value_ = language_ = datatype_ = std::nullopt;
    return true;
  }
  bool Close() {
    if (!Step()) return false;
    const What what = open_.back().what;
    open_.pop_back();
    if (what == What::kVariables && !InRows()) {
      done_ = true;
      return false;
    }
    return what != What::kCell || !InRows() || BindCell();
  }
  bool Take(absl::Status status) { return status.ok() || Fail(std::move(status)); }

  // An RDF term, section 3.2.2.
  bool BindCell() {
    if (!type_ || !value_) return FailAt(What::kCell);
    Term term;
    if (*type_ == "uri") {
      term = Term::Iri(*std::move(value_));
    } else if (*type_ == "bnode") {
      term = Term::Blank(*std::move(value_));
    } else if (*type_ != "literal" && *type_ != "typed-literal") {
      return FailAt(What::kCell);
    } else if (language_.value_or("").empty()) {
      term = Term::Literal(*std::move(value_), std::move(datatype_).value_or(""));
    } else {
      term = Term::LangString(*std::move(value_), *std::move(language_));
      if (datatype_ && *datatype_ != kRdfLangString) term.datatype = *std::move(datatype_);
    }
    return Take(rows_.Bind(variable_, std::move(term)));
  }

  const std::string_view body_;
  const size_t most_bytes_;  // of a text, as it is written
  const size_t term_bytes_;
  Cancellation* const cancellation_;
  ServiceRows& rows_;
  For what_ = For::kVariables;
  JsonCursor cursor_;  // its bound is how far it reads before something is told of it
  std::vector<Level> open_;
  bool has_head_ = false, has_bindings_ = false, done_ = false;
  std::string variable_;                                           // of the cell
  std::optional<std::string> type_, value_, language_, datatype_;  // of the cell
  absl::Status status_;
};

}  // namespace

absl::StatusOr<sparql::ServiceAnswer> ReadJsonAnswer(std::string_view body, const Limits& limits,
                                                     Cancellation* cancellation, MemoryUse* memory) {
  if (body.starts_with("\xEF\xBB\xBF")) body.remove_prefix(3);
  ServiceRows rows(limits, memory);
  AnswerReader reader(body, limits, cancellation, &rows);
  for (const auto what : {AnswerReader::For::kVariables, AnswerReader::For::kRows}) {
    if (absl::Status status = reader.Read(what); !status.ok()) return status;
  }
  return rows.Take();
}

}  // namespace docent::server
