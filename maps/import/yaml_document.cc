#include "maps/import/yaml_document.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <set>
#include <streambuf>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::maps {
namespace {

// Ends the parse; what is wrong is in the diagnostics. It does not leave this file.
struct Refused {};

class Buffer : public std::streambuf {
 public:
  explicit Buffer(std::string_view text) {
    char* begin = const_cast<char*>(text.data());
    setg(begin, begin, begin + text.size());
  }
};

// The events of yaml-cpp's parser as a tree.
class TreeMaker : public YAML::EventHandler {
 public:
  TreeMaker(std::string_view text, std::string file, Diagnostics* diagnostics, const MapLimits& limits)
      : text_(text), file_(std::move(file)), diagnostics_(diagnostics), limits_(limits) {
    lines_.push_back(0);
    for (size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') lines_.push_back(i + 1);
    }
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnAnchor(const YAML::Mark&, const std::string&) override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Add(mark, anchor, YamlValue::Kind::kNull, "");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { Refuse(mark, kNoAnchors, kNoAnchorsHint); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string& value) override {
    Add(mark, anchor, YamlValue::Kind::kText, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Begin(mark, anchor, YamlValue::Kind::kList);
  }
  void OnSequenceEnd() override { End(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Begin(mark, anchor, YamlValue::Kind::kMap);
  }
  void OnMapEnd() override { End(); }

  [[noreturn]] void Refuse(const YAML::Mark& mark, std::string message, std::string hint = "") {
    diagnostics_->push_back({file_, SpanOf(mark), std::move(message), std::move(hint)});
    throw Refused();
  }

  // Why the parser has given up at `mark`: a tab in the indentation there, or what it says.
  void Explain(const YAML::Mark& mark, const std::string& said) {
    const SourceSpan span = SpanOf(mark);
    const size_t begin = span.line > 0 ? lines_[static_cast<size_t>(span.line) - 1] : text_.size();
    const size_t tab = text_.find_first_not_of(' ', begin);
    if (tab < text_.size() && text_[tab] == '\t') {
      diagnostics_->push_back(
          {file_, SpanAt(text_, tab, 1), "a tab stands in the indentation", "indent with blanks"});
    } else {
      diagnostics_->push_back({file_, span, Concat("no YAML: ", said), ""});
    }
  }

  YamlValue Take() { return std::move(root_); }

 private:
  static constexpr char kNoAnchors[] = "anchors (&) and aliases (*) are not read";
  static constexpr char kNoAnchorsHint[] = "write the value out where the alias stands";

  struct Open {
    YamlValue value;
    std::set<std::string> keys;
    bool key_comes = false;  // of a mapping
  };

  SourceSpan SpanOf(const YAML::Mark& mark) const {
    if (mark.is_null()) return {};
    const size_t line = std::min(static_cast<size_t>(std::max(mark.line, 0)), lines_.size() - 1);
    const size_t offset =
        std::min(lines_[line] + static_cast<size_t>(std::max(mark.column, 0)), text_.size());
    // The values come in order: of each line that has been counted up to one of them, the next goes on from there.
    if (line != counted_line_ || offset < counted_) {
      counted_line_ = line;
      counted_ = lines_[line];
      column_ = 0;
    }
    for (; counted_ < offset; ++counted_)
      column_ += (static_cast<unsigned char>(text_[counted_]) & 0xC0) != 0x80;
    return {static_cast<int>(line) + 1, column_ + 1, offset,
            offset < text_.size() && text_[offset] != '\n' ? size_t{1} : size_t{0}};
  }

  void Count(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) Refuse(mark, kNoAnchors, kNoAnchorsHint);
    if (++values_ > limits_.map_yaml_values) {
      Refuse(mark, absl::StrCat("too many values; the limit map_yaml_values is ", limits_.map_yaml_values));
    }
  }

  void Add(const YAML::Mark& mark, YAML::anchor_t anchor, YamlValue::Kind kind, const std::string& text) {
    Count(mark, anchor);
    if (!open_.empty() && open_.back().key_comes) {
      Open& map = open_.back();
      if (!map.keys.insert(text).second) Refuse(mark, Concat("the key ", text, " stands twice"));
      map.value.keys.push_back(text);
      map.key_comes = false;
      return;
    }
    YamlValue value;
    value.kind = kind;
    value.text = text;
    value.span = SpanOf(mark);
    Keep(std::move(value));
  }

  void Begin(const YAML::Mark& mark, YAML::anchor_t anchor, YamlValue::Kind kind) {
    Count(mark, anchor);
    if (!open_.empty() && open_.back().key_comes) Refuse(mark, "a key that is no text");
    if (open_.size() >= static_cast<size_t>(limits_.map_yaml_nesting)) {
      Refuse(mark, absl::StrCat("lists and mappings stand too deep inside each other; the limit "
                                "map_yaml_nesting is ",
                                limits_.map_yaml_nesting));
    }
    Open open;
    open.value.kind = kind;
    open.value.span = SpanOf(mark);
    open.key_comes = kind == YamlValue::Kind::kMap;
    open_.push_back(std::move(open));
  }

  void End() {
    YamlValue value = std::move(open_.back().value);
    open_.pop_back();
    Keep(std::move(value));
  }

  void Keep(YamlValue value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return;
    }
    Open& parent = open_.back();
    parent.value.items.push_back(std::move(value));
    parent.key_comes = parent.value.IsMap();
  }

  std::string_view text_;
  const std::string file_;
  Diagnostics* diagnostics_;
  const MapLimits& limits_;
  std::vector<size_t> lines_;                      // where each begins
  mutable size_t counted_line_ = 0, counted_ = 0;  // column_ characters of that line come before this offset
  mutable int column_ = 0;
  std::vector<Open> open_;
  YamlValue root_;
  size_t values_ = 0;
};

}  // namespace

const YamlValue* YamlValue::Find(std::string_view key) const {
  if (kind != Kind::kMap) return nullptr;
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<size_t>(found - keys.begin())];
}

std::optional<YamlValue> ParseYaml(std::string_view text, const std::string& file, Diagnostics* diagnostics,
                                   const MapLimits& limits) {
  if (text.size() > limits.map_yaml_bytes) {
    diagnostics->push_back({file,
                            {},
                            absl::StrCat("the text has ", text.size(), " bytes; the limit map_yaml_bytes is ",
                                         limits.map_yaml_bytes),
                            ""});
    return std::nullopt;
  }
  TreeMaker maker(text, file, diagnostics, limits);
  try {
    Buffer buffer(text);
    std::istream in(&buffer);
    YAML::Parser parser(in);
    if (!parser.HandleNextDocument(maker)) {
      diagnostics->push_back({file, {}, "the file is empty", ""});
      return std::nullopt;
    }
    return maker.Take();
  } catch (const Refused&) {
  } catch (const YAML::Exception& error) {
    maker.Explain(error.mark, error.msg);
  }
  return std::nullopt;
}

void YamlFields::Error(const SourceSpan& span, std::string message, std::string hint) {
  if (full()) return;
  diagnostics_->push_back({file_, span, std::move(message), std::move(hint)});
}

void YamlFields::Warning(const SourceSpan& span, std::string message, std::string hint) {
  if (HasMany()) return;
  diagnostics_->push_back({file_, span, std::move(message), std::move(hint), Diagnostic::Severity::kWarning});
}

const YamlValue* YamlFields::Need(const YamlValue& map, std::string_view key) {
  const YamlValue* found = map.Find(key);
  if (found == nullptr) Error(map.span, Concat("the key ", key, " is missing"));
  return found;
}

std::optional<double> YamlFields::Number(const YamlValue& value, std::string_view what) {
  double number = 0;
  if (value.kind == YamlValue::Kind::kText && absl::SimpleAtod(value.text, &number) &&
      std::isfinite(number)) {
    return number;
  }
  const std::string shown = value.kind == YamlValue::Kind::kText ? Concat(": ", value.text) : std::string();
  Error(value.span, Concat(what, " is not a finite number", shown));
  return std::nullopt;
}

std::optional<size_t> YamlFields::Index(const YamlValue& value, std::string_view what, size_t end) {
  const std::optional<double> number = Number(value, what);
  if (!number) return std::nullopt;
  if (*number >= 0 && *number < static_cast<double>(end) && *number == std::floor(*number))
    return static_cast<size_t>(*number);
  Error(value.span, absl::StrCat(ToAbsl(what), " ", value.text, " does not exist; there are ", end));
  return std::nullopt;
}

std::optional<std::string> YamlFields::Text(const YamlValue& value, std::string_view what) {
  if (value.kind == YamlValue::Kind::kText && !value.text.empty()) return value.text;
  Error(value.span, Concat(what, " is not a text"));
  return std::nullopt;
}

}  // namespace docent::maps
