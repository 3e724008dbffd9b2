#include "kb_server/cli/answer_printer.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include "graph/rdf/serializer.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/cli/client.h"

namespace docent {
namespace {

size_t Width(const std::string& text) {
  return std::count_if(text.begin(), text.end(),
                       [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

}  // namespace

void AnswerPrinter::Begin(std::vector<std::string> variables) {
  if (variables.empty()) return;
  if (format_) {
    writer_ = sparql::ResultWriter::Make(*format_, &text_);
    writer_->Begin(variables);
    return;
  }
  for (std::string& name : variables) name.insert(0, "?");
  table_.push_back(std::move(variables));
}

void AnswerPrinter::Row(const std::vector<std::optional<Term>>& terms) {
  ++rows_;
  if (writer_) {
    writer_->Row(terms);
    std::cout << text_;
    text_.clear();
    return;
  }
  std::vector<std::string> cells;
  for (const auto& term : terms) cells.push_back(term ? OneLine(ToDisplay(*term), 120) : "");
  table_.push_back(std::move(cells));
}

int AnswerPrinter::End(uint64_t revision) {
  if (boolean_) {
    std::cout << (format_ ? sparql::WriteBoolean(*boolean_, *format_) : *boolean_ ? "yes\n" : "no\n");
    return *boolean_ ? kExitOk : kExitNegative;
  }
  if (writer_) {
    writer_->End();
    std::cout << text_;
  } else if (!triples_.empty()) {
    std::vector<std::pair<std::string, std::string>> prefixes(kWellKnownPrefixes.begin(),
                                                              kWellKnownPrefixes.end());
    auto turtle = SerializeRdf(triples_, RdfFormat::kTurtle, prefixes);
    if (!turtle.ok()) return Fail(turtle.status());
    std::cout << *turtle;
  } else if (!table_.empty()) {
    PrintTable();
    std::cerr << rows_ << (rows_ == 1 ? " row" : " rows") << ", revision " << revision << "\n";
  }
  return kExitOk;
}

void AnswerPrinter::BreakOff() {
  if (rows_ == 0) return;
  if (!writer_) PrintTable();
  std::cout.flush();  // before what went wrong is said
  std::cerr << "the answer is not whole: " << rows_ << (rows_ == 1 ? " row" : " rows") << " of it came\n";
}

void AnswerPrinter::PrintTable() const {
  std::vector<size_t> widths(table_[0].size(), 0);
  for (const auto& row : table_) {
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], Width(row[i]));
  }
  for (size_t r = 0; r < table_.size(); ++r) {
    std::string line;
    for (size_t i = 0; i < table_[r].size(); ++i) {
      line += table_[r][i];
      if (i + 1 < table_[r].size()) line += std::string(widths[i] - Width(table_[r][i]) + 2, ' ');
    }
    std::cout << line << "\n";
    if (r > 0) continue;
    std::string rule;
    for (size_t i = 0; i < widths.size(); ++i) {
      rule += std::string(widths[i], '-') + (i + 1 < widths.size() ? "  " : "");
    }
    std::cout << rule << "\n";
  }
}

}  // namespace docent
