#include "graph/rdf/formats/xml_entities.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {
namespace {

constexpr size_t kFewBytes = 1 << 20;  // of text are taken in any case

}  // namespace

XmlEntities::XmlEntities(const DocumentLimits& limits, size_t document_bytes, size_t bytes)
    : most_nested_(limits.xml_entity_nesting),
      most_bytes_(std::min(document_bytes, std::max(kFewBytes, bytes * limits.xml_entity_growth))),
      growth_(limits.xml_entity_growth) {}

void XmlEntities::Declare(std::string_view name, std::string_view text) {
  if (!IsExternal(name)) entities_.try_emplace(std::string(name), Entity{std::string(text)});
}

void XmlEntities::DeclareExternal(std::string_view name) {
  if (!entities_.contains(ToAbsl(name))) external_.emplace(name);
}

bool XmlEntities::IsExternal(std::string_view name) const {
  return external_.contains(ToAbsl(name));
}

int XmlEntities::NestingOf(std::string_view name, int allowed, bool* known) {
  const auto found = entities_.find(ToAbsl(name));
  if (found == entities_.end()) {
    *known = false;
    return 0;
  }
  Entity& entity = found->second;
  if (entity.nesting != 0) return entity.nesting;
  if (allowed == 0) return most_nested_ + 1;
  const std::string_view text = entity.text;
  int inside = 0;
  bool all_known = true;
  for (size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
    const size_t end = text.find(';', at);
    if (end == std::string_view::npos) break;
    inside = std::max(inside, NestingOf(text.substr(at + 1, end - at - 1), allowed - 1, &all_known));
    if (inside > most_nested_) return inside;
  }
  if (all_known) entity.nesting = inside + 1;  // else it may be declared later
  *known = *known && all_known;
  return inside + 1;
}

bool XmlEntities::Use(std::string_view name, size_t bytes) {
  used_bytes_ += bytes;
  bool known = true;
  if (NestingOf(name, most_nested_, &known) > most_nested_) {
    why_ = absl::StrCat("the entity &", ToAbsl(name),
                        "; holds entities inside each other, deeper than the limit xml_entity_nesting = ",
                        most_nested_, ", or itself");
  } else if (used_bytes_ > most_bytes_) {
    why_ = absl::StrCat("the entities of this document have more than ", most_bytes_,
                        " bytes, written out: what the limits xml_entity_growth = ", growth_,
                        " and document_bytes allow");
  }
  return why_.empty();
}

}  // namespace docent
