#include "graph/sparql/syntax/builtins.h"

#include <iterator>
#include <limits>

#include "graph/sparql/values/text.h"

namespace docent::sparql {
namespace {

constexpr int kAny = std::numeric_limits<int>::max();

// In the order of enum Builtin: NameOf indexes it.
constexpr BuiltinInfo kBuiltins[] = {
    {"STR", Builtin::kStr, 1, 1},
    {"LANG", Builtin::kLang, 1, 1},
    {"LANGMATCHES", Builtin::kLangMatches, 2, 2},
    {"DATATYPE", Builtin::kDatatype, 1, 1},
    {"BOUND", Builtin::kBound, 1, 1},
    {"IRI", Builtin::kIri, 1, 1},
    {"BNODE", Builtin::kBnode, 0, 1},
    {"RAND", Builtin::kRand, 0, 0},
    {"ABS", Builtin::kAbs, 1, 1},
    {"CEIL", Builtin::kCeil, 1, 1},
    {"FLOOR", Builtin::kFloor, 1, 1},
    {"ROUND", Builtin::kRound, 1, 1},
    {"CONCAT", Builtin::kConcat, 0, kAny},
    {"STRLEN", Builtin::kStrlen, 1, 1},
    {"UCASE", Builtin::kUcase, 1, 1},
    {"LCASE", Builtin::kLcase, 1, 1},
    {"ENCODE_FOR_URI", Builtin::kEncodeForUri, 1, 1},
    {"CONTAINS", Builtin::kContains, 2, 2},
    {"STRSTARTS", Builtin::kStrStarts, 2, 2},
    {"STRENDS", Builtin::kStrEnds, 2, 2},
    {"STRBEFORE", Builtin::kStrBefore, 2, 2},
    {"STRAFTER", Builtin::kStrAfter, 2, 2},
    {"YEAR", Builtin::kYear, 1, 1},
    {"MONTH", Builtin::kMonth, 1, 1},
    {"DAY", Builtin::kDay, 1, 1},
    {"HOURS", Builtin::kHours, 1, 1},
    {"MINUTES", Builtin::kMinutes, 1, 1},
    {"SECONDS", Builtin::kSeconds, 1, 1},
    {"TIMEZONE", Builtin::kTimezone, 1, 1},
    {"TZ", Builtin::kTz, 1, 1},
    {"NOW", Builtin::kNow, 0, 0},
    {"UUID", Builtin::kUuid, 0, 0},
    {"STRUUID", Builtin::kStrUuid, 0, 0},
    {"MD5", Builtin::kMd5, 1, 1},
    {"SHA1", Builtin::kSha1, 1, 1},
    {"SHA256", Builtin::kSha256, 1, 1},
    {"SHA384", Builtin::kSha384, 1, 1},
    {"SHA512", Builtin::kSha512, 1, 1},
    {"COALESCE", Builtin::kCoalesce, 0, kAny},
    {"IF", Builtin::kIf, 3, 3},
    {"STRLANG", Builtin::kStrLang, 2, 2},
    {"STRDT", Builtin::kStrDt, 2, 2},
    {"sameTerm", Builtin::kSameTerm, 2, 2},
    {"isIRI", Builtin::kIsIri, 1, 1},
    {"isBLANK", Builtin::kIsBlank, 1, 1},
    {"isLITERAL", Builtin::kIsLiteral, 1, 1},
    {"isNUMERIC", Builtin::kIsNumeric, 1, 1},
    {"REGEX", Builtin::kRegex, 2, 3},
    {"SUBSTR", Builtin::kSubstr, 2, 3},
    {"REPLACE", Builtin::kReplace, 3, 4},
};
static_assert(std::size(kBuiltins) == static_cast<size_t>(Builtin::kReplace) + 1);

constexpr std::string_view kAggregates[] = {"COUNT", "SUM", "MIN", "MAX", "AVG", "SAMPLE", "GROUP_CONCAT"};

}  // namespace

const BuiltinInfo* FindBuiltin(std::string_view keyword) {
  if (EqualsIgnoreCase(keyword, "URI")) keyword = "IRI";
  if (EqualsIgnoreCase(keyword, "isURI")) keyword = "isIRI";
  for (const BuiltinInfo& info : kBuiltins) {
    if (EqualsIgnoreCase(info.name, keyword)) return &info;
  }
  return nullptr;
}

std::string_view NameOf(Builtin builtin) {
  return kBuiltins[static_cast<size_t>(builtin)].name;
}

std::optional<Aggregate::Function> FindAggregate(std::string_view keyword) {
  for (size_t i = 0; i < std::size(kAggregates); ++i) {
    if (EqualsIgnoreCase(kAggregates[i], keyword)) return static_cast<Aggregate::Function>(i);
  }
  return std::nullopt;
}

std::string_view NameOf(Aggregate::Function function) {
  return kAggregates[static_cast<size_t>(function)];
}

std::vector<std::string> BuiltinNames() {
  std::vector<std::string> names;
  for (const BuiltinInfo& info : kBuiltins) names.emplace_back(info.name);
  for (const std::string_view name : kAggregates) names.emplace_back(name);
  return names;
}

}  // namespace docent::sparql
