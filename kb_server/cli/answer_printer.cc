#include "kb_server/cli/answer_printer.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include "graph/rdf/formats/serializer.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/terminal.h"

namespace docent::server {

void AnswerPrinter::Begin(std::vector<std::string> variables) {
  if (variables.empty()) return;
  if (format_) {
    writer_ = sparql::ResultWriter::Make(*format_, &text_);
    writer_->Begin(variables);
    return;
  }
  for (std::string& name : variables) name.insert(0, "?");
  table_.emplace(std::move(variables));
}

void AnswerPrinter::Row(const std::vector<std::optional<Term>>& terms) {
  ++rows_;
  if (writer_) {
    writer_->Row(terms);
    PrintForPrograms(text_);
    text_.clear();
    return;
  }
  if (!table_) return;
  std::vector<Table::Cell> cells;
  for (const auto& term : terms) cells.emplace_back(term ? presenter_.Of(*term) : "");
  table_->Add(std::move(cells));
}

int AnswerPrinter::End(uint64_t revision) {
  if (boolean_) {
    std::cout << (format_ ? sparql::WriteBoolean(*boolean_, *format_) : *boolean_ ? "yes\n" : "no\n");
    return *boolean_ ? kExitOk : kExitNegative;
  }
  if (writer_) {
    writer_->End();
    PrintForPrograms(text_);
  } else if (!triples_.empty()) {
    auto turtle = SerializeRdf(triples_, RdfFormat::kTurtle, UsedPrefixes());
    if (!turtle.ok()) return Fail(turtle.status());
    PrintForPrograms(*turtle);
  } else if (table_) {
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

PrefixList AnswerPrinter::UsedPrefixes() const {
  PrefixList used;
  for (const auto& prefix : presenter_.names().prefixes()) {
    const auto names = [&](const Term& term) {
      return (term.IsIri() ? term.lexical : term.datatype).starts_with(prefix.second);
    };
    if (std::any_of(triples_.begin(), triples_.end(), [&](const TermQuad& t) {
          return names(t.subject) || names(t.predicate) || names(t.object);
        }))
      used.push_back(prefix);
  }
  return used;
}

void AnswerPrinter::PrintTable() const {
  if (table_) std::cout << table_->Render(presenter_.terminal()) << std::flush;
}

}  // namespace docent::server
