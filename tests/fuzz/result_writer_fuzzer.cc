// Any bytes as the terms of solutions: the output of each result writer is read back as the same solutions.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/results/results.h"
#include "tests/conformance/sparql/result_files.h"
#include "tests/fuzz/fuzz_check.h"

namespace docent {
namespace {

using sparql::ResultFormat;

// A cell is a byte for its kind, and text up to the next '|'.
std::optional<Term> CellOf(char kind, std::string text) {
  static constexpr std::string_view kTypes[] = {"",         kXsdInteger, kXsdDecimal,
                                                kXsdDouble, kXsdBoolean, kXsdDate};
  switch (static_cast<unsigned char>(kind) % 10) {
    case 0:
      return std::nullopt;
    case 1:
      for (char& c : text) {
        if (static_cast<unsigned char>(c) <= 0x20 ||
            std::string_view("<>\"{}|^`\\").find(c) != std::string_view::npos)
          c = '-';
      }
      return Term::Iri("urn:x:" + text);
    case 2:
      for (char& c : text) {
        if (!std::isalnum(static_cast<unsigned char>(c))) c = 'x';
      }
      return Term::Blank("b" + text);
    case 3:
      return Term::LangString(text, "en-gb");
    default:
      return Term::Literal(text, std::string(kTypes[static_cast<unsigned char>(kind) % 6]));
  }
}

// True if XML 1.0 (section 2.2) can express every character; others become U+FFFD there.
bool FitsXml(const std::string& text) {
  for (size_t i = 0; i < text.size(); ++i) {
    const unsigned char c = static_cast<unsigned char>(text[i]);
    if (c < 0x20 && c != '\n' && c != '\t' && c != '\r') return false;
    if (text.compare(i, 3, "\xEF\xBF\xBE") == 0 || text.compare(i, 3, "\xEF\xBF\xBF") == 0) return false;
  }
  return true;
}

std::string Show(const Answer& answer) {
  std::string out;
  for (const std::string& v : answer.variables) out += v + " ";
  for (const auto& row : answer.rows) {
    out += "\n";
    for (const auto& [name, term] : row) out += name + "=" + ToNTriples(term) + " ";
  }
  return out;
}

void CheckOne(std::string_view text) {
  if (FindInvalidUtf8(text) != std::string_view::npos) return;
  Answer answer;
  answer.variables = {"a", "b"};
  bool xml = true;
  std::vector<std::optional<Term>> cells;
  while (!text.empty()) {
    const size_t end = std::min(text.find('|'), text.size());
    const std::string_view piece = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    cells.push_back(piece.empty() || static_cast<unsigned char>(piece[0]) >= 0x80
                        ? std::nullopt
                        : CellOf(piece[0], std::string(piece.substr(1))));
    if (cells.back()) xml = xml && FitsXml(cells.back()->lexical);
    if (cells.size() % 2 != 0) continue;
    auto& row = answer.rows.emplace_back();
    for (size_t i = 0; i < 2; ++i) {
      if (cells[cells.size() - 2 + i]) row[answer.variables[i]] = *cells[cells.size() - 2 + i];
    }
  }
  for (const ResultFormat format : {ResultFormat::kJson, ResultFormat::kXml, ResultFormat::kTsv}) {
    if (format == ResultFormat::kXml && !xml) continue;
    std::string out;
    const auto writer = sparql::ResultWriter::Make(format, &out);
    writer->Begin(answer.variables);
    for (size_t i = 0; i + 1 < cells.size(); i += 2) writer->Row({&cells[i], 2});
    writer->End();
    const Answer back = format == ResultFormat::kJson  ? ReadJsonResult(out)
                        : format == ResultFormat::kXml ? ReadXmlResult(out)
                                                       : ReadTsvResult(out);
    fuzz::Require(Show(back) == Show(answer),
                  "read back otherwise:\n" + out + "\n" + Show(answer) + "\n" + Show(back));
  }
}

}  // namespace
}  // namespace docent

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  docent::CheckOne(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
}
