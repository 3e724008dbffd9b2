#include "kb_server/work/service_rows.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"
#include "graph/rdf/term_check.h"
#include "graph/sparql/syntax/algebra_memory.h"

namespace docent::server {
namespace {

constexpr size_t kValuesARow = 4;         // on the average, in an answer of as many rows as it may have
constexpr size_t kBytesOfVariable = 200;  // beside its name, in the answer and in the table of columns

}  // namespace

absl::Status ServiceRows::Count(size_t bytes) {
  if (kept_.Add(bytes)) return absl::OkStatus();
  return memory_.Refusal(absl::ResourceExhaustedError(absl::StrCat(
      "the answer has more than fits into the limit query_memory_bytes = ", limits_.query_memory_bytes)));
}

absl::Status ServiceRows::AddVariable(std::string name) {
  if (!answer_.rows.empty()) return absl::UnknownError("the answer names a variable after its rows");
  if (absl::Status status = Count(2 * name.size() + kBytesOfVariable); !status.ok()) return status;
  if (!columns_.emplace(name, answer_.variables.size()).second)
    return absl::UnknownError("the answer names a variable twice");
  answer_.variables.push_back(std::move(name));
  return absl::OkStatus();
}

absl::Status ServiceRows::BeginRow() {
  const size_t rows = answer_.rows.size() + 1;
  if (rows > limits_.remote_rows) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the answer has more rows than the limit remote_rows = ", limits_.remote_rows));
  }
  if (rows * answer_.variables.size() > kValuesARow * limits_.remote_rows) {
    return absl::ResourceExhaustedError(absl::StrCat("the answer has more values than ", kValuesARow,
                                                     " times the limit remote_rows = ", limits_.remote_rows));
  }
  sparql::ServiceRow row(answer_.variables.size());
  if (absl::Status status = Count(sparql::MemoryOf(row)); !status.ok()) return status;
  answer_.rows.push_back(std::move(row));
  return absl::OkStatus();
}

absl::Status ServiceRows::Bind(const std::string& variable, Term term) {
  const auto column = columns_.find(variable);
  if (column == columns_.end() || answer_.rows.empty()) return absl::OkStatus();
  const auto place = [&] {
    return absl::StrCat("row ", answer_.rows.size(), " of the answer, ?", variable, ": ");
  };
  std::optional<Term>& value = answer_.rows.back()[column->second];
  if (value) return absl::UnknownError(absl::StrCat(place(), "it is bound twice"));
  // Any text may label a blank node there: whoever takes the answer gives it a label of ours.
  const absl::Status fit = term.IsBlank() ? CheckTerm(Term::Literal(term.lexical), limits_.term_bytes)
                                          : CheckTerm(term, limits_.term_bytes);
  if (!fit.ok()) {
    const std::string message = absl::StrCat(place(), fit.message());
    return absl::IsResourceExhausted(fit)
               ? WithMessage(fit, message)
               : absl::UnknownError(absl::StrCat("the answer holds what is no RDF term: ", message));
  }
  value = std::move(term);
  return Count(sparql::TextMemory(*value));
}

}  // namespace docent::server
