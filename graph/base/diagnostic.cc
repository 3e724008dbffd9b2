#include "graph/base/diagnostic.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace docent {
namespace {

// The text of line `line` (from 1) without its end.
std::string_view LineOf(std::string_view source, int line) {
  size_t start = 0;
  for (int i = 1; i < line; ++i) {
    size_t end = source.find('\n', start);
    if (end == std::string_view::npos) return {};
    start = end + 1;
  }
  std::string_view text = source.substr(start, source.find('\n', start) - start);
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// The part of a long line around `column` (from 1, in code points), with "…" where text is left out, and the
// position of the column in it. A line may hold a literal of a megabyte.
struct Excerpt {
  std::string text;
  int column;
};
Excerpt ExcerptOf(std::string_view line, int column) {
  constexpr int kBefore = 100, kAfter = 60;
  const int first = column > kBefore + 1 ? column - kBefore : 1;  // code points [first, last] are shown
  const int last = column + kAfter;
  Excerpt excerpt{first > 1 ? "…" : "", column - first + (first > 1 ? 2 : 1)};
  int current = 0;
  for (size_t i = 0; i < line.size(); ++i) {
    if (!IsContinuation(line[i]) && ++current > last) {
      excerpt.text += "…";
      break;
    }
    if (current >= first) excerpt.text += line[i];
  }
  return excerpt;
}

// Length of the character at `at`; 0 if no valid UTF-8 character (RFC 3629, section 4) begins there.
size_t CharacterAt(std::string_view text, size_t at) {
  const auto byte = [&](size_t i) {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
  };
  const unsigned lead = byte(0), second = byte(1);
  const size_t length = lead < 0x80                   ? 1
                        : lead >= 0xC2 && lead < 0xE0 ? 2
                        : (lead & 0xF0) == 0xE0       ? 3
                        : lead >= 0xF0 && lead < 0xF5 ? 4
                                                      : 0;
  for (size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool surrogate = lead == 0xED && second >= 0xA0, beyond = lead == 0xF4 && second >= 0x90;
  return overlong || surrogate || beyond ? 0 : length;
}

// The text made safe for terminals and HTTP clients: U+FFFD replaces invalid UTF-8 and control characters.
std::string Printable(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size();) {
    const size_t length = CharacterAt(text, i);
    const bool control =
        length == 1 && static_cast<unsigned char>(text[i]) < 0x20 && text[i] != '\n' && text[i] != '\t';
    out += length == 0 || control ? std::string_view("\uFFFD") : text.substr(i, length);
    i += std::max<size_t>(length, 1);
  }
  return out;
}

// Edits (insert, delete, replace, swap of neighbours) from `a` to `b`: the optimal string alignment distance.
size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

// Nobody writes a digit for a letter by mistake: names with other letters have the same digits.
bool MayBeSlip(std::string_view a, std::string_view b) {
  const auto only = [](std::string_view text, bool digits) {
    std::string out(text);
    std::erase_if(out, [digits](char c) { return absl::ascii_isdigit(c) != digits; });
    return out;
  };
  return only(a, true) == only(b, true) || only(a, false) == only(b, false);
}

}  // namespace

bool HasErrors(const Diagnostics& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(),
                     [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::kError; });
}

std::string Render(const Diagnostics& diagnostics, std::string_view source) {
  std::string out;
  if (source.starts_with("\xEF\xBB\xBF")) source.remove_prefix(3);  // columns do not count a byte order mark
  for (const Diagnostic& d : diagnostics) {
    if (!d.file.empty()) absl::StrAppend(&out, d.file, ":");
    if (d.span.line > 0)
      absl::StrAppend(&out, d.span.line, ":", d.span.column, ": ");
    else if (!d.file.empty())
      out += " ";
    absl::StrAppend(&out, d.severity == Diagnostic::Severity::kError ? "error: " : "warning: ", d.message,
                    "\n");
    std::string_view line = d.span.line > 0 ? LineOf(source, d.span.line) : std::string_view();
    if (!line.empty()) {
      const auto [text, caret] = ExcerptOf(line, d.span.column);
      out.append("  ").append(text).append("\n  ");
      int column = 1;
      for (size_t i = 0; i < text.size() && column < caret; ++i) {
        if (IsContinuation(text[i])) continue;
        out += text[i] == '\t' ? '\t' : ' ';
        ++column;
      }
      out += "^\n";
    }
    if (!d.hint.empty()) absl::StrAppend(&out, "  hint: ", d.hint, "\n");
  }
  return Printable(out);
}

namespace {

// Two insertions at one place do not go together either: their order would be a guess.
bool Overlap(const TextEdit& a, const TextEdit& b) {
  if (a.offset == b.offset) return true;
  return a.offset < b.offset ? a.offset + a.length > b.offset : b.offset + b.length > a.offset;
}

bool IsMade(const TextEdit& edit, const std::vector<TextEdit>& made) {
  return std::find(made.begin(), made.end(), edit) != made.end();
}

bool FitsBeside(const std::vector<TextEdit>& fix, const std::vector<TextEdit>& made, size_t size) {
  return std::all_of(fix.begin(), fix.end(), [&](const TextEdit& edit) {
    if (edit.offset > size || edit.length > size - edit.offset) return false;
    return IsMade(edit, made) || std::none_of(made.begin(), made.end(),
                                              [&](const TextEdit& other) { return Overlap(edit, other); });
  });
}

}  // namespace

std::string ApplyFixes(std::string_view source, const Diagnostics& diagnostics, size_t* applied) {
  std::vector<TextEdit> made;
  size_t fixes = 0;
  for (const Diagnostic& d : diagnostics) {
    if (d.fix.empty() || !FitsBeside(d.fix, made, source.size())) continue;
    for (const TextEdit& edit : d.fix) {
      if (!IsMade(edit, made)) made.push_back(edit);
    }
    ++fixes;
  }
  std::sort(made.begin(), made.end(),
            [](const TextEdit& a, const TextEdit& b) { return a.offset < b.offset; });
  std::string out;
  size_t at = 0;
  for (const TextEdit& edit : made) {
    out += source.substr(at, edit.offset - at);
    out += edit.replacement;
    at = edit.offset + edit.length;
  }
  out += source.substr(at);
  if (applied != nullptr) *applied = fixes;
  return out;
}

absl::Status ToStatus(const Diagnostics& diagnostics, std::string_view source) {
  if (!HasErrors(diagnostics)) return absl::OkStatus();
  return absl::InvalidArgumentError(Render(diagnostics, source));
}

SourceSpan SpanAt(std::string_view source, size_t offset, size_t length) {
  offset = std::min(offset, source.size());
  SourceSpan span{1, 1, offset, length};
  for (size_t i = 0; i < offset; ++i) {
    if (source[i] == '\n') {
      ++span.line;
      span.column = 1;
    } else if (!IsContinuation(source[i])) {
      ++span.column;
    }
  }
  return span;
}

std::string Nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  size_t best_distance = word.size() / 3 + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > word.size() + best_distance || word.size() > candidate.size() + best_distance)
      continue;
    if (!MayBeSlip(word, candidate)) continue;
    size_t distance = EditDistance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace docent
