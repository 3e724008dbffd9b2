// A table for people: a header, aligned columns, cut to the width of the terminal. Value; one thread.
#ifndef DOCENT_KB_SERVER_CLI_TABLE_H_
#define DOCENT_KB_SERVER_CLI_TABLE_H_

#include <string>
#include <utility>
#include <vector>

#include "kb_server/cli/terminal.h"

namespace docent::server {

class Table {
 public:
  struct Cell {
    std::string text;
    Style style = Style::kPlain;

    Cell(std::string t, Style s = Style::kPlain)
        : text(std::move(t)), style(s) {}                                // NOLINT: a text is a cell
    Cell(const char* t, Style s = Style::kPlain) : text(t), style(s) {}  // NOLINT: likewise
  };

  explicit Table(std::vector<std::string> header);

  // One cell a column.
  void Add(std::vector<Cell> row);
  size_t rows() const { return rows_.size(); }

  // Where the table is wider than the terminal, these columns are not cut. Columns without a text are left out then, and the
  // last ones that have no room at all: "…" stands in their place in the header.
  void KeepWhole(std::vector<size_t> columns) { whole_ = std::move(columns); }

  // Header, rule and rows, a line each. Where they are wider than the terminal, the widest columns give way: their cells
  // are cut, and end in "…". No column becomes narrower than kNarrowest.
  std::string Render(const Terminal& terminal) const;
  static constexpr size_t kNarrowest = 8;

 private:
  std::vector<size_t> Widths(size_t columns) const;
  void Narrow(size_t columns, std::vector<size_t>* widths) const;
  // Whether a column with texts has no room.
  bool LeavesOut(const std::vector<size_t>& widths) const;

  std::vector<std::string> header_;
  std::vector<size_t> whole_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_TABLE_H_
