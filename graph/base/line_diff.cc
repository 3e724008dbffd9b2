#include "graph/base/line_diff.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {
namespace {

constexpr size_t kMostCells = 4000000;
constexpr size_t kContext = 3;

std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    lines.push_back(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  return lines;
}

// A line of the difference: of both texts (' '), of the first ('-') or the second ('+').
struct Line {
  char kind = ' ';
  std::string_view text;
};

// Of the parts between the common beginning and end: by the longest common subsequence.
void AddMiddle(const std::vector<std::string_view>& a, const std::vector<std::string_view>& b,
               std::vector<Line>* out) {
  if (a.size() * b.size() > kMostCells) {
    for (const std::string_view line : a) out->push_back({'-', line});
    for (const std::string_view line : b) out->push_back({'+', line});
    return;
  }
  const size_t width = b.size() + 1;
  std::vector<uint32_t> common((a.size() + 1) * width, 0);
  for (size_t i = a.size(); i-- > 0;) {
    for (size_t j = b.size(); j-- > 0;) {
      common[i * width + j] = a[i] == b[j] ? common[(i + 1) * width + j + 1] + 1
                                           : std::max(common[(i + 1) * width + j], common[i * width + j + 1]);
    }
  }
  size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    if (i < a.size() && j < b.size() && a[i] == b[j]) {
      out->push_back({' ', a[i]});
      ++i, ++j;
    } else if (j == b.size() || (i < a.size() && common[(i + 1) * width + j] >= common[i * width + j + 1])) {
      out->push_back({'-', a[i++]});
    } else {
      out->push_back({'+', b[j++]});
    }
  }
}

std::vector<Line> Compare(std::vector<std::string_view> a, std::vector<std::string_view> b) {
  std::vector<Line> out;
  size_t first = 0;
  while (first < a.size() && first < b.size() && a[first] == b[first]) out.push_back({' ', a[first++]});
  std::vector<Line> end;
  while (a.size() > first && b.size() > first && a.back() == b.back()) {
    end.push_back({' ', a.back()});
    a.pop_back();
    b.pop_back();
  }
  AddMiddle({a.begin() + first, a.end()}, {b.begin() + first, b.end()}, &out);
  out.insert(out.end(), end.rbegin(), end.rend());
  return out;
}

// "12,3" of a hunk's header; the line before where there are none.
std::string Range(size_t first, size_t count) {
  if (count == 1) return absl::StrCat(first + 1);
  return absl::StrCat(count == 0 ? first : first + 1, ",", count);
}

}  // namespace

std::string LineDiff(std::string_view before, std::string_view after, const std::string& before_name,
                     const std::string& after_name) {
  const std::vector<Line> lines = Compare(LinesOf(before), LinesOf(after));
  std::string out;
  size_t line_a = 0, line_b = 0;  // that lines[i] stands at
  for (size_t i = 0; i < lines.size();) {
    const auto changed =
        std::find_if(lines.begin() + i, lines.end(), [](const Line& l) { return l.kind != ' '; });
    if (changed == lines.end()) break;
    const size_t at = changed - lines.begin();
    const size_t begin = std::max(i, at < kContext ? 0 : at - kContext);
    line_a += begin - i;
    line_b += begin - i;
    size_t end = at, last = at;  // the hunk goes on while the next change is near
    while (end < lines.size() && end - last <= 2 * kContext) {
      if (lines[end].kind != ' ') last = end;
      ++end;
    }
    end = std::min(lines.size(), last + 1 + kContext);
    std::string hunk;
    size_t count_a = 0, count_b = 0;
    for (size_t k = begin; k < end; ++k) {
      hunk += Concat(std::string_view(&lines[k].kind, 1), lines[k].text, "\n");
      count_a += lines[k].kind != '+';
      count_b += lines[k].kind != '-';
    }
    absl::StrAppend(&out, "@@ -", Range(line_a, count_a), " +", Range(line_b, count_b), " @@\n", hunk);
    line_a += count_a;
    line_b += count_b;
    i = end;
  }
  return out.empty() ? out : Concat("--- ", before_name, "\n+++ ", after_name, "\n", out);
}

}  // namespace docent
