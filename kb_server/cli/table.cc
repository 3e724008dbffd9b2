#include "kb_server/cli/table.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "kb_server/cli/display_width.h"

namespace docent::server {
namespace {

constexpr size_t kGap = 2;  // columns between two cells

// A column of width 0 is not there.
size_t Sum(const std::vector<size_t>& widths, size_t limit) {
  size_t sum = 0;
  for (const size_t width : widths) sum += width == 0 ? 0 : std::min(width, limit) + kGap;
  return sum - std::min(sum, kGap);
}

// Of columns without a text: none is there.
constexpr size_t kAbsent = 0;

// The widest give way.
void CutTo(size_t columns, std::vector<size_t>* all) {
  std::vector<size_t>& widths = *all;
  size_t limit =
      std::max(Table::kNarrowest, std::min(columns, *std::max_element(widths.begin(), widths.end())));
  while (limit > Table::kNarrowest && Sum(widths, limit) > columns) --limit;
  // What the limit leaves over goes to the first columns that can use it.
  size_t left = columns - std::min(columns, Sum(widths, limit));
  for (size_t& width : widths) {
    if (width <= limit) continue;
    width = limit + (left > 0 ? 1 : 0);
    left -= std::min<size_t>(left, 1);
  }
}

}  // namespace

Table::Table(std::vector<std::string> header) : header_(std::move(header)) {
  for (std::string& name : header_) name = Printable(name);
}

void Table::Add(std::vector<Cell> row) {
  for (Cell& cell : row) cell.text = Printable(cell.text);
  row.resize(header_.size(), Cell(""));
  rows_.push_back(std::move(row));
}

std::vector<size_t> Table::Widths(size_t columns) const {
  std::vector<size_t> widths;
  for (size_t i = 0; i < header_.size(); ++i) {
    size_t width = DisplayWidth(header_[i]);
    for (const auto& row : rows_) width = std::max(width, DisplayWidth(row[i].text));
    widths.push_back(width);
  }
  if (columns != 0 && Sum(widths, SIZE_MAX) > columns) Narrow(columns, &widths);
  return widths;
}

void Table::Narrow(size_t columns, std::vector<size_t>* all) const {
  std::vector<size_t>& widths = *all;
  std::vector<size_t> whole(widths.size(), kAbsent);
  if (!whole_.empty()) {
    for (size_t i = 0; i < widths.size(); ++i) {
      const bool empty =
          std::all_of(rows_.begin(), rows_.end(), [i](const auto& row) { return row[i].text.empty(); });
      if (empty) widths[i] = kAbsent;
    }
    for (const size_t i : whole_) std::swap(whole[i], widths[i]);  // set aside
    const size_t kept = Sum(whole, SIZE_MAX) + kGap;
    for (size_t i = widths.size(); i > 0 && kept + Sum(widths, kNarrowest) > columns; --i)
      widths[i - 1] = kAbsent;
    columns -= std::min(columns, kept);
  }
  if (Sum(widths, SIZE_MAX) > columns) CutTo(columns, &widths);
  for (size_t i = 0; i < widths.size(); ++i) widths[i] = std::max(widths[i], whole[i]);
}

bool Table::LeavesOut(const std::vector<size_t>& widths) const {
  for (size_t i = 0; i < widths.size(); ++i) {
    const auto has_text = [i](const auto& row) { return !row[i].text.empty(); };
    if (widths[i] == kAbsent && std::any_of(rows_.begin(), rows_.end(), has_text)) return true;
  }
  return false;
}

std::string Table::Render(const Terminal& terminal) const {
  const std::vector<size_t> widths = Widths(terminal.columns);
  std::string out;
  const auto line = [&](const auto& cells, const auto& text_of, const auto& style_of) {
    std::string gap;
    for (size_t i = 0; i < widths.size(); ++i) {
      if (widths[i] == kAbsent) continue;
      const std::string text = CutToWidth(text_of(cells[i]), widths[i]);
      if (!text.empty()) absl::StrAppend(&out, gap, terminal.In(style_of(cells[i]), text));
      if (!text.empty()) gap.clear();
      gap.append(widths[i] - DisplayWidth(text) + kGap, ' ');
    }
    out += '\n';
  };
  const auto itself = [](const std::string& text) -> const std::string& { return text; };
  line(header_, itself, [](const std::string&) { return Style::kStrong; });
  if (LeavesOut(widths)) out.insert(out.size() - 1, "  …");
  std::vector<std::string> rules;
  for (const size_t width : widths) rules.emplace_back(width, '-');
  line(rules, itself, [](const std::string&) { return Style::kFaint; });
  for (const auto& row : rows_) {
    line(
        row, [](const Cell& cell) -> const std::string& { return cell.text; },
        [](const Cell& cell) { return cell.style; });
  }
  return out;
}

}  // namespace docent::server
