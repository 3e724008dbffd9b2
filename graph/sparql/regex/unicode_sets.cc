#include "graph/sparql/regex/unicode_sets.h"

#include <unicode/uchar.h>
#include <unicode/uset.h>

#include <algorithm>
#include <map>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/utf8.h"
#include "graph/sparql/values/case_map.h"

namespace docent::sparql {
namespace {

using Range = CharacterSet::Range;
using Ranges = std::vector<Range>;

CharacterSetPtr Shared(CharacterSet set) {
  return std::make_shared<const CharacterSet>(std::move(set));
}

void Append(const CharacterSet& set, Ranges* out) {
  out->insert(out->end(), set.ranges().begin(), set.ranges().end());
}

struct Category {
  std::string_view name;
  UCharCategory category;
};
// Without Cs: surrogates are not characters.
constexpr Category kCategories[] = {
    {"Lu", U_UPPERCASE_LETTER},
    {"Ll", U_LOWERCASE_LETTER},
    {"Lt", U_TITLECASE_LETTER},
    {"Lm", U_MODIFIER_LETTER},
    {"Lo", U_OTHER_LETTER},
    {"Mn", U_NON_SPACING_MARK},
    {"Mc", U_COMBINING_SPACING_MARK},
    {"Me", U_ENCLOSING_MARK},
    {"Nd", U_DECIMAL_DIGIT_NUMBER},
    {"Nl", U_LETTER_NUMBER},
    {"No", U_OTHER_NUMBER},
    {"Pc", U_CONNECTOR_PUNCTUATION},
    {"Pd", U_DASH_PUNCTUATION},
    {"Ps", U_START_PUNCTUATION},
    {"Pe", U_END_PUNCTUATION},
    {"Pi", U_INITIAL_PUNCTUATION},
    {"Pf", U_FINAL_PUNCTUATION},
    {"Po", U_OTHER_PUNCTUATION},
    {"Zs", U_SPACE_SEPARATOR},
    {"Zl", U_LINE_SEPARATOR},
    {"Zp", U_PARAGRAPH_SEPARATOR},
    {"Sm", U_MATH_SYMBOL},
    {"Sc", U_CURRENCY_SYMBOL},
    {"Sk", U_MODIFIER_SYMBOL},
    {"So", U_OTHER_SYMBOL},
    {"Cc", U_CONTROL_CHAR},
    {"Cf", U_FORMAT_CHAR},
    {"Co", U_PRIVATE_USE_CHAR},
    {"Cn", U_UNASSIGNED},
};

UBool CollectCategory(const void* context, UChar32 start, UChar32 limit, UCharCategory category) {
  auto& by_category = *static_cast<std::vector<Ranges>*>(const_cast<void*>(context));
  by_category[static_cast<size_t>(category)].push_back(
      {static_cast<char32_t>(start), static_cast<char32_t>(limit - 1)});
  return true;
}

using NamedSets = std::map<std::string, CharacterSetPtr, std::less<>>;

const NamedSets& Categories() {
  static const NamedSets* const sets = [] {
    std::vector<Ranges> by_category(U_CHAR_CATEGORY_COUNT);
    u_enumCharTypes(CollectCategory, &by_category);
    std::map<std::string, Ranges> groups;
    auto* made = new NamedSets;
    for (const Category& c : kCategories) {
      const Ranges& ranges = by_category[c.category];
      Ranges& group = groups[std::string(c.name.substr(0, 1))];
      group.insert(group.end(), ranges.begin(), ranges.end());
      made->emplace(c.name, Shared(CharacterSet::Of(ranges)));
    }
    for (auto& [name, ranges] : groups) made->emplace(name, Shared(CharacterSet::Of(std::move(ranges))));
    return made;
  }();
  return *sets;
}

// A block's name in Blocks.txt without spaces, from ICU's name for it. ICU writes '_' for spaces and hyphens,
// and a capital at the beginning of each word: Latin_1_Supplement, Greek_And_Coptic.
std::string SpelledAsInBlocksTxt(std::string_view icu_name) {
  std::string out;
  std::string_view before;  // the word before
  while (!icu_name.empty()) {
    const size_t end = std::min(icu_name.find('_'), icu_name.size());
    const std::string_view word = icu_name.substr(0, end);
    icu_name.remove_prefix(std::min(end + 1, icu_name.size()));
    const bool part_letter =
        word.size() == 1 && icu_name.empty() && before != "Extension" && before != "Linear";
    if (part_letter || word == "1" || word == "Pa" || word == "Minoan") out += '-';
    if (word == "And" || word == "For" || word == "Pa") {
      out += static_cast<char>(word[0] | 0x20);
      out += word.substr(1);
    } else {
      out += word;
    }
    before = word;
  }
  return out;
}

using BlockNumbers = std::map<std::string, int32_t, std::less<>>;

const BlockNumbers& Blocks() {
  static const BlockNumbers* const blocks = [] {
    auto* made = new BlockNumbers;
    const int32_t last = u_getIntPropertyMaxValue(UCHAR_BLOCK);
    for (int32_t block = UBLOCK_NO_BLOCK + 1; block <= last; ++block) {
      const char* name = u_getPropertyValueName(UCHAR_BLOCK, block, U_LONG_PROPERTY_NAME);
      if (name != nullptr) made->emplace(SpelledAsInBlocksTxt(name), block);
    }
    made->emplace("Greek", UBLOCK_GREEK);
    made->emplace("CombiningMarksforSymbols", UBLOCK_COMBINING_MARKS_FOR_SYMBOLS);
    made->emplace("CyrillicSupplementary", UBLOCK_CYRILLIC_SUPPLEMENT);
    return made;
  }();
  return *blocks;
}

// The groups of characters that are case variants of each other, as a table of each character's variants.
using Variants = absl::flat_hash_map<char32_t, std::vector<char32_t>>;

const Variants& CaseVariants() {
  static const Variants* const variants = [] {
    constexpr char32_t kEnd = 0x20000;                              // no letters with case in later planes
    std::map<char32_t, std::pair<std::string, std::string>> cased;  // lower and upper case
    const auto add = [&cased](char32_t c) {
      std::string text;
      AppendUtf8(c, &text);
      auto& [lower, upper] = cased[c];
      lower = LowerCase(text);
      upper = UpperCase(text);
      std::vector<char32_t> mapped;
      for (const std::string& to : {lower, upper}) {
        size_t at = 0;
        const char32_t first = NextCodePoint(to, &at);
        if (at == to.size()) mapped.push_back(first);
      }
      return mapped;
    };
    for (char32_t c = 0; c < kEnd; ++c) {
      const auto code = static_cast<UChar32>(c);
      if (!u_hasBinaryProperty(code, UCHAR_CHANGES_WHEN_LOWERCASED) &&
          !u_hasBinaryProperty(code, UCHAR_CHANGES_WHEN_UPPERCASED)) {
        continue;
      }
      for (const char32_t mapped : add(c)) add(mapped);
    }
    std::map<std::string, std::vector<char32_t>> by_lower, by_upper;
    for (const auto& [c, cases] : cased) {
      by_lower[cases.first].push_back(c);
      by_upper[cases.second].push_back(c);
    }
    auto* made = new Variants;
    for (const auto& [c, cases] : cased) {
      std::vector<char32_t> others = by_lower[cases.first];
      others.insert(others.end(), by_upper[cases.second].begin(), by_upper[cases.second].end());
      std::erase(others, c);
      if (!others.empty()) made->emplace(c, std::move(others));
    }
    return made;
  }();
  return *variants;
}

// NameStartChar and the other characters of NameChar (XML 1.0, fifth edition, 2.3).
CharacterSet NameStartCharacters() {
  return CharacterSet::Of({{':', ':'},
                           {'A', 'Z'},
                           {'_', '_'},
                           {'a', 'z'},
                           {0xC0, 0xD6},
                           {0xD8, 0xF6},
                           {0xF8, 0x2FF},
                           {0x370, 0x37D},
                           {0x37F, 0x1FFF},
                           {0x200C, 0x200D},
                           {0x2070, 0x218F},
                           {0x2C00, 0x2FEF},
                           {0x3001, 0xD7FF},
                           {0xF900, 0xFDCF},
                           {0xFDF0, 0xFFFD},
                           {0x10000, 0xEFFFF}});
}

CharacterSet NameCharacters() {
  Ranges ranges = {{'-', '.'}, {'0', '9'}, {0xB7, 0xB7}, {0x300, 0x36F}, {0x203F, 0x2040}};
  Append(NameStartCharacters(), &ranges);
  return CharacterSet::Of(std::move(ranges));
}

// All characters except punctuation, separators and others.
CharacterSet WordCharacters() {
  Ranges ranges;
  for (const char* const name : {"P", "Z", "C"}) Append(*CategorySet(name), &ranges);
  return CharacterSet::Of(std::move(ranges)).Complement();
}

const std::map<char32_t, CharacterSetPtr>& Escapes() {
  static const auto* const escapes = [] {
    auto* made = new std::map<char32_t, CharacterSetPtr>;
    const auto add = [made](char lower, const CharacterSet& set) {
      made->emplace(lower, Shared(set));
      made->emplace(lower & ~0x20, Shared(set.Complement()));
    };
    add('s', CharacterSet::Of({{' ', ' '}, {'\t', '\n'}, {'\r', '\r'}}));
    add('d', *CategorySet("Nd"));
    add('w', WordCharacters());
    add('i', NameStartCharacters());
    add('c', NameCharacters());
    made->emplace('.', Shared(CharacterSet::Of({{'\n', '\n'}, {'\r', '\r'}}).Complement()));
    return made;
  }();
  return *escapes;
}

}  // namespace

CharacterSetPtr CategorySet(std::string_view name) {
  const auto it = Categories().find(name);
  return it == Categories().end() ? nullptr : it->second;
}

CharacterSetPtr BlockSet(std::string_view name) {
  // Three blocks had this name; one of them remains under another name.
  if (name == "PrivateUse") {
    return Shared(CharacterSet::Of({{0xE000, 0xF8FF}, {0xF0000, 0xFFFFD}, {0x100000, 0x10FFFD}}));
  }
  const auto it = Blocks().find(name);
  if (it == Blocks().end()) return nullptr;
  UErrorCode error = U_ZERO_ERROR;
  const std::unique_ptr<USet, decltype(&uset_close)> set(uset_openEmpty(), uset_close);
  uset_applyIntPropertyValue(set.get(), UCHAR_BLOCK, it->second, &error);
  Ranges ranges;
  for (int32_t i = 0, n = uset_getItemCount(set.get()); i < n; ++i) {
    UChar32 first = 0, last = 0;
    if (uset_getItem(set.get(), i, &first, &last, nullptr, 0, &error) == 0) {
      ranges.push_back({static_cast<char32_t>(first), static_cast<char32_t>(last)});
    }
  }
  return U_SUCCESS(error) ? Shared(CharacterSet::Of(std::move(ranges))) : nullptr;
}

std::vector<std::string> BlockNames() {
  std::vector<std::string> names = {"PrivateUse"};
  for (const auto& [name, number] : Blocks()) names.push_back(name);
  return names;
}

CharacterSetPtr EscapeSet(char32_t letter) {
  const auto it = Escapes().find(letter);
  return it == Escapes().end() ? nullptr : it->second;
}

CharacterSet WithCaseVariants(const CharacterSet& set) {
  const Variants& table = CaseVariants();
  Ranges ranges = set.ranges();
  size_t characters = 0;
  for (const Range& range : set.ranges()) characters += range.last - range.first + 1;
  const auto add = [&ranges](const std::vector<char32_t>& variants) {
    for (const char32_t variant : variants) ranges.push_back({variant, variant});
  };
  if (characters < table.size()) {
    for (const Range& range : set.ranges()) {
      for (char32_t c = range.first; c <= range.last; ++c) {
        if (const auto it = table.find(c); it != table.end()) add(it->second);
      }
    }
  } else {
    for (const auto& [c, variants] : table) {
      if (set.Contains(c)) add(variants);
    }
  }
  return CharacterSet::Of(std::move(ranges));
}

bool AreCaseVariants(char32_t a, char32_t b) {
  const auto it = CaseVariants().find(a);
  return it != CaseVariants().end() && std::find(it->second.begin(), it->second.end(), b) != it->second.end();
}

}  // namespace docent::sparql
