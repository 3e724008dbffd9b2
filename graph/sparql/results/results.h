// Writer of SPARQL results: JSON (SPARQL 1.1 Query Results JSON Format), XML, CSV and TSV. Rows are appended
// one by one, so a large answer can be streamed. Values of one thread.
#ifndef DOCENT_GRAPH_SPARQL_RESULTS_RESULTS_H_
#define DOCENT_GRAPH_SPARQL_RESULTS_RESULTS_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/types/span.h"
#include "graph/rdf/term.h"

namespace docent::sparql {

enum class ResultFormat { kJson, kXml, kCsv, kTsv };

// "json", "xml", "csv", "tsv".
std::optional<ResultFormat> ResultFormatOfName(std::string_view name);

// Usage: writer.Begin(names); writer.Row(terms) …; writer.End(). Each appends to *out, which the caller may
// send and clear between calls.
class ResultWriter {
 public:
  static std::unique_ptr<ResultWriter> Make(ResultFormat format, std::string* out);
  virtual ~ResultWriter() = default;
  virtual void Begin(const std::vector<std::string>& variables) = 0;
  // One term for each variable; nullopt where unbound.
  virtual void Row(absl::Span<const std::optional<Term>> terms) = 0;
  virtual void End() = 0;
};

// The answer of an ASK. The standard defines no form for CSV and TSV: "true" or "false" on a line.
std::string WriteBoolean(bool value, ResultFormat format);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RESULTS_RESULTS_H_
