#include "graph/rdf/hidden_character.h"

#include <algorithm>
#include <array>

namespace docent {
namespace {

struct Range {
  char32_t first, last;
};

// DerivedCoreProperties.txt of Unicode 15, Default_Ignorable_Code_Point, with the controls, the separators of lines and
// paragraphs, and the anchors of annotations. In order.
constexpr std::array<Range, 21> kHidden = {
    {{0x0, 0x1F},           {0x7F, 0x9F},       {0xAD, 0xAD},       {0x34F, 0x34F},     {0x61C, 0x61C},
     {0x115F, 0x1160},      {0x17B4, 0x17B5},   {0x180B, 0x180F},   {0x200B, 0x200F},   {0x2028, 0x202E},
     {0x2060, 0x206F},      {0x3164, 0x3164},   {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF},   {0xFFA0, 0xFFA0},
     {0xFFF0, 0xFFFB},      {0x13430, 0x1343F}, {0x1BCA0, 0x1BCA3}, {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF},
     {0x110000, 0xFFFFFFFF}}};

}  // namespace

bool IsHiddenCharacter(char32_t c) {
  const auto range = std::lower_bound(kHidden.begin(), kHidden.end(), c,
                                      [](const Range& one, char32_t sought) { return one.last < sought; });
  return range != kHidden.end() && range->first <= c;
}

bool IsJoiner(char32_t c) {
  return c == 0x200C || c == 0x200D || c == 0xFE0E || c == 0xFE0F;
}

}  // namespace docent
