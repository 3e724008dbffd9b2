// A query's answer on standard output: a table, one of the result formats, Turtle, or yes and no. One thread.
#ifndef DOCENT_KB_SERVER_CLI_ANSWER_PRINTER_H_
#define DOCENT_KB_SERVER_CLI_ANSWER_PRINTER_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/term.h"
#include "graph/sparql/results/results.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/table.h"

namespace docent::server {

class AnswerPrinter {
 public:
  // `format`: json, csv, tsv or xml; anything else is a table for people.
  AnswerPrinter(const std::string& format, const Presenter& presenter)
      : format_(sparql::ResultFormatOfName(format)), presenter_(presenter) {}

  // The first of an answer: its variables (SELECT; none of a graph), or a truth value.
  void Begin(std::vector<std::string> variables);
  void Boolean(bool value) { boolean_ = value; }
  // In a result format a row is printed at once.
  void Row(const std::vector<std::optional<Term>>& terms);
  void Triple(TermQuad triple) { triples_.push_back(std::move(triple)); }
  // Prints the rest, and how many rows of which revision to standard error. The exit code (client.h).
  int End(uint64_t revision);
  // Instead of End, where the answer did not come whole: what is printed cannot be taken for all of it.
  void BreakOff();

 private:
  void PrintTable() const;
  // The prefixes that the triples use.
  PrefixList UsedPrefixes() const;

  const std::optional<sparql::ResultFormat> format_;
  std::string text_;  // made by writer_ and not printed yet
  std::unique_ptr<sparql::ResultWriter> writer_;
  const Presenter& presenter_;
  std::optional<Table> table_;
  size_t rows_ = 0;
  std::optional<bool> boolean_;
  std::vector<TermQuad> triples_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_ANSWER_PRINTER_H_
