#include "reasoner/shapes/shape_words.h"

#include <algorithm>
#include <array>

#include "reasoner/shapes/shape.h"

namespace docent::shapes {
namespace {

constexpr uint8_t Bits(std::initializer_list<NodeRole> roles) {
  uint8_t bits = 0;
  for (const NodeRole role : roles) bits |= static_cast<uint8_t>(role);
  return bits;
}
constexpr uint8_t kShape = Bits({NodeRole::kShape}), kParameter = Bits({NodeRole::kParameter}),
                  kComponent = Bits({NodeRole::kComponent}), kValidator = Bits({NodeRole::kValidator}),
                  kConstraint = Bits({NodeRole::kConstraint}), kTarget = Bits({NodeRole::kTarget}),
                  kRule = Bits({NodeRole::kRule}), kAnywhere = 0xff;

struct Word {
  std::string_view name;
  uint8_t roles;
};
// Words other than the parameters of Core at shapes. A parameter may be described like a property shape.
constexpr std::array<Word, 41> kWords = {{
    {"path", kShape | kParameter},
    {"severity", kShape},
    {"message", kShape | kConstraint | kValidator | kComponent},
    {"deactivated", kShape | kConstraint},
    {"targetNode", kShape},
    {"targetClass", kShape},
    {"targetSubjectsOf", kShape},
    {"targetObjectsOf", kShape},
    {"target", kShape},
    {"sparql", kShape},
    {"flags", kShape},
    {"ignoredProperties", kShape},
    {"qualifiedValueShape", kShape},
    {"qualifiedMinCount", kShape},
    {"qualifiedMaxCount", kShape},
    {"qualifiedValueShapesDisjoint", kShape},
    {"name", kAnywhere},
    {"description", kAnywhere},
    {"group", kShape | kParameter},
    {"order", kAnywhere},
    {"defaultValue", kShape | kParameter},
    {"select", kConstraint | kValidator | kTarget | kComponent},
    {"ask", kValidator},
    {"prefixes", kConstraint | kValidator | kTarget | kRule | kComponent},
    {"parameter", kComponent},
    {"validator", kComponent},
    {"nodeValidator", kComponent},
    {"propertyValidator", kComponent},
    {"labelTemplate", kComponent},
    {"optional", kParameter},
    // they lead to nothing that is checked, at any node
    {"declare", kAnywhere},
    {"prefix", kAnywhere},
    {"namespace", kAnywhere},
    {"inversePath", kAnywhere},
    {"alternativePath", kAnywhere},
    {"zeroOrMorePath", kAnywhere},
    {"oneOrMorePath", kAnywhere},
    {"zeroOrOnePath", kAnywhere},
    {"shapesGraph", kAnywhere},
    {"suggestedShapesGraph", kAnywhere},
    {"shapesGraphWellFormed", kAnywhere},
}};
// Words of reports, which may be in the graph of the shapes.
constexpr std::array<std::string_view, 11> kReportWords = {"conforms",
                                                           "result",
                                                           "detail",
                                                           "focusNode",
                                                           "resultPath",
                                                           "resultSeverity",
                                                           "resultMessage",
                                                           "sourceConstraint",
                                                           "sourceShape",
                                                           "value",
                                                           "sourceConstraintComponent"};
// Words of SHACL, its Advanced Features and its JavaScript extensions.
struct NotEvaluated {
  std::string_view name, advice;
};
constexpr std::string_view kSayItOtherwise = "say it with SHACL Core, with sh:sparql, or as a rule";
constexpr std::array<NotEvaluated, 23> kNotEvaluated = {{
    {"rule", "a sh:SPARQLRule is put in use by docent rules use FILE"},
    {"expression", kSayItOtherwise},
    {"values", "write a rule that infers them"},
    {"js", kSayItOtherwise},
    {"jsLibrary", kSayItOtherwise},
    {"jsLibraryURL", kSayItOtherwise},
    {"jsFunctionName", kSayItOtherwise},
    {"construct", "a sh:SPARQLRule is put in use by docent rules use FILE"},
    {"update", kSayItOtherwise},
    {"condition", "write the condition into the WHERE of its CONSTRUCT"},
    {"subject", "write the rule as a sh:SPARQLRule"},
    {"predicate", "write the rule as a sh:SPARQLRule"},
    {"object", "write the rule as a sh:SPARQLRule"},
    {"returnType", kSayItOtherwise},
    {"resultAnnotation", "write its text into sh:message"},
    {"annotationProperty", "write its text into sh:message"},
    {"annotationValue", "write its text into sh:message"},
    {"annotationVarName", "write its text into sh:message"},
    {"filterShape", kSayItOtherwise},
    {"nodes", kSayItOtherwise},
    {"intersection", kSayItOtherwise},
    {"union", kSayItOtherwise},
    {"this", kSayItOtherwise},
}};

bool IsCoreParameter(std::string_view word) {
  for (int c = 0; c <= static_cast<int>(Component::kIn); ++c) {
    if (ParameterName(static_cast<Component>(c)) == word) return true;
  }
  return false;
}

const Word* Find(std::string_view word) {
  const auto found =
      std::find_if(kWords.begin(), kWords.end(), [&](const Word& w) { return w.name == word; });
  return found == kWords.end() ? nullptr : &*found;
}
const NotEvaluated* FindNotEvaluated(std::string_view word) {
  const auto found = std::find_if(kNotEvaluated.begin(), kNotEvaluated.end(),
                                  [&](const NotEvaluated& w) { return w.name == word; });
  return found == kNotEvaluated.end() ? nullptr : &*found;
}

uint8_t RolesOf(std::string_view word) {
  if (IsCoreParameter(word)) return kShape | kParameter;
  if (std::find(kReportWords.begin(), kReportWords.end(), word) != kReportWords.end()) return kAnywhere;
  const Word* known = Find(word);
  return known == nullptr ? 0 : known->roles;
}

}  // namespace

WordUse UseOf(std::string_view word, uint8_t roles) {
  const uint8_t at = RolesOf(word);
  if (at == kAnywhere || (at & roles) != 0) return WordUse::kSays;
  if (at != 0) return WordUse::kElsewhere;
  if ((roles & kRule) != 0 && FindNotEvaluated(word) != nullptr) return WordUse::kSays;
  return FindNotEvaluated(word) != nullptr ? WordUse::kNotEvaluated : WordUse::kUnknown;
}

std::string PlaceOfWord(std::string_view word) {
  static constexpr std::array<std::pair<uint8_t, std::string_view>, 6> kPlaces = {
      {{kShape, "a shape"},
       {kConstraint, "the value of sh:sparql"},
       {kComponent, "a sh:ConstraintComponent"},
       {kParameter, "the value of sh:parameter"},
       {kValidator, "the value of sh:validator, sh:nodeValidator or sh:propertyValidator"},
       {kTarget, "the value of sh:target"}}};
  const uint8_t roles = RolesOf(word);
  std::string text;
  for (const auto& [role, place] : kPlaces) {
    if ((roles & role) == 0) continue;
    text += text.empty() ? "" : ", or ";
    text += place;
  }
  return text;
}

std::string_view AdviceFor(std::string_view word) {
  const NotEvaluated* known = FindNotEvaluated(word);
  return known == nullptr ? std::string_view() : known->advice;
}

bool MakesAShape(std::string_view word) {
  return IsCoreParameter(word) || word == "sparql" || word == "target" || word == "qualifiedValueShape";
}

const std::vector<std::string>& ShapeWords() {
  static const std::vector<std::string>* words = [] {
    auto* all = new std::vector<std::string>();
    for (const Word& word : kWords) {
      if ((word.roles & kShape) != 0) all->emplace_back(word.name);
    }
    for (int c = 0; c <= static_cast<int>(Component::kIn); ++c)
      all->push_back(ParameterName(static_cast<Component>(c)));
    return all;
  }();
  return *words;
}

}  // namespace docent::shapes
