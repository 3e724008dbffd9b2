// A YAML document as a tree whose values know their places. It has what maps of other systems need: no anchors, aliases
// and tags, one document a file. yaml-cpp is used in the .cc file only. Values and pure functions; any thread.
#ifndef DOCENT_MAPS_IMPORT_YAML_DOCUMENT_H_
#define DOCENT_MAPS_IMPORT_YAML_DOCUMENT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/base/map_limits.h"

namespace docent::maps {

struct YamlValue {
  enum class Kind { kNull, kText, kList, kMap };
  Kind kind = Kind::kNull;
  std::string text;               // kText: as written, without quotes
  std::vector<YamlValue> items;   // of a list, or the values of a mapping
  std::vector<std::string> keys;  // of a mapping, one for each of `items`
  SourceSpan span;

  bool IsMap() const { return kind == Kind::kMap; }
  bool IsList() const { return kind == Kind::kList; }
  // The value of a key; nullptr if this is no mapping or has no such key.
  const YamlValue* Find(std::string_view key) const;
};

// nullopt: what is wrong stands in `diagnostics`, with its place: no YAML, a tab for indentation, an anchor or alias, a key
// that stands twice, a limit.
std::optional<YamlValue> ParseYaml(std::string_view text, const std::string& file, Diagnostics* diagnostics,
                                   const MapLimits& limits = kMapLimits);

// Readers of values that add to `diagnostics` what is wrong with them.
class YamlFields {
 public:
  YamlFields(std::string file, Diagnostics* diagnostics)
      : file_(std::move(file)), diagnostics_(diagnostics) {}

  // Beyond document_diagnostics, mistakes are not kept, but for the first error.
  void Error(const SourceSpan& span, std::string message, std::string hint = "");
  void Warning(const SourceSpan& span, std::string message, std::string hint = "");
  // Nothing further will be shown, and the document is refused.
  bool full() const { return HasMany() && HasErrors(*diagnostics_); }
  // The value of a key of `map`, which has to be there.
  const YamlValue* Need(const YamlValue& map, std::string_view key);
  // A finite number. `what` names it in messages.
  std::optional<double> Number(const YamlValue& value, std::string_view what);
  // A whole number from 0 below `end`.
  std::optional<size_t> Index(const YamlValue& value, std::string_view what, size_t end);
  // A text that is not empty.
  std::optional<std::string> Text(const YamlValue& value, std::string_view what);

 private:
  bool HasMany() const { return diagnostics_->size() >= Limits().document_diagnostics; }

  const std::string file_;
  Diagnostics* diagnostics_;
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_YAML_DOCUMENT_H_
