// Every document of the scenarios with one mistake each, made by a table of kinds at places that a seed draws: `check` finds
// it at its line. A new scenario takes part by being there. (scenario_mutants_test.cc has chosen mistakes, and the messages.)
#include <algorithm>
#include <map>
#include <random>
#include <regex>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "tests/golden/scenario_check.h"

namespace docent::golden {
namespace {

constexpr size_t kPlaces = 3;  // of a kind in a document

struct Kind {
  const char* name;
  const char* ending;   // of the files that it is for
  const char* pattern;  // its first group is what is changed
  const char* change;   // what the group becomes; & stands for itself
  const char* message;  // part of what is said
};

const Kind kKinds[] = {
    {"element", ".xml", R"re(<(invoke|variable|part|activate) [^<>]*/>)re", "&e", "unknown element"},
    {"attribute", ".xml", R"re(<[A-Za-z:]+ (name|operation|flow|from)=")re", "&x", "unknown attribute"},
    {"close tag", ".xml", R"re(</(node|process|flow|message|activator)>)re", "&s", "XML:"},
    {"prefix", ".xml", R"re((?:<verb>|type=")(docent):)re", "&s", "unknown prefix docents:"},
    {"duration", ".xml", R"re(ext:timeout="([^"]*)")re", "soon", "is not a duration"},
    {"retries", ".xml", R"re(ext:retry="([^"]*)")re", "often", "is not a number"},
    {"second name", ".xml", R"re(<(?:node|process|message) (name="[^"]*")[^<>\n]*>)re", "& &", "XML:"},
    {"verb", ".cawl.xml", R"re(<verb>docent:([A-Za-z]+)</verb>)re", "&q", "the ontology has no property"},
    {"class", ".cawl.xml", R"re( type="docent:([A-Za-z]+)")re", "&q", "the ontology has no class"},
    {"individual", ".cawl.xml", R"re(<object>docent:([A-Za-z]+)</object>)re", "&q",
     "the ontology has no word"},
    {"variable", ".cawl.xml", R"re(>\$([A-Za-z]+)<)re", "&q", "is not declared"},
    {"link to", ".cawl.xml", R"re(<link [^>]*to="([^"]+)")re", "&q", "there is no node"},
    {"link from", ".cawl.xml", R"re(<link from="([^"]+)")re", "&q", "there is no node"},
    {"flow", ".cawl.xml", R"re(<activate flow="([^"]+)")re", "&q", "there is no flow"},
    {"sub-flow", ".cawl.xml", R"re(<invoke [^>]*subflow="([^"]+)")re", "&q",
     "there is no flow or deployed workflow"},
    {"operation", ".cawl.xml", R"re(<invoke operation="([^"]+)")re", "&q", "no robot offers operation"},
    {"offered", ".cawl.xml", R"re(<service operation="([^"]+)")re", "&q", "no robot offers operation"},
    {"expression", ".cawl.xml", R"re(<(?:rule|condition|case) [^>]*expression="([^"]+)")re", "& and nothing",
     "nothing"},
    {"half an expression", ".cawl.xml", R"re(<(?:rule|condition|case) [^>]*expression="([^"]+)")re", "& and",
     "expression"},
    {"priority", ".cawl.xml", R"re( priority="([^"]+)")re", "first", "is not a whole number"},
    {"urgency", ".cawl.xml", R"re(ext:priority="([^"]+)")re", "first", "is not a priority"},
    {"state", ".cawl.xml", R"re( state="([^"]+)")re", "asleep", "is unknown"},
    {"literal", ".cawl.xml", R"re(<object>(docent:[A-Za-z]+)</object>)re", "\"text\"",
     "are resources, and this is a literal"},
    {"truth", ".cawl.xml", R"re(<object>(true|false)</object>)re", "\"yes\"", "are of xsd:boolean"},
    {"loop", ".cawl.xml", R"re((<link from="([^"]+)" to="[^"]+"/>))re", R"(&<link from="@" to="@"/>)", ""},
    {"second link", ".cawl.xml", R"re((<link from="[^"]+" to="[^"]+"/>))re", "&&", "a second link"},
    {"input message", ".rsel.xml", R"re(<process [^>]*input="([^"]+)")re", "&q", "there is no message"},
    {"input part", ".rsel.xml", R"re(<input [^>]*from="([^"]+)")re", "&q", "nothing gives"},
    {"no operation", ".rsel.xml", R"re(<invoke (operation="[^"]+"))re", "", "needs the attribute operation"},
    {"no value", ".rsel.xml", R"re(<input part="[^"]+"( from="[^"]+"))re", "", "needs either from or value"},
};

struct GeneratedMutant {
  std::string file, kind, message, text;
  size_t line = 0;
  std::string change;
};

std::vector<std::string> ScenarioDocuments() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(InTree("scenarios"))) {
    const std::string path = entry.path().lexically_relative(InTree("")).string();
    if (path.ends_with(".cawl.xml") || path.ends_with(".rsel.xml")) files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Comments become blanks: a change of one would be none.
std::string WithoutComments(std::string text) {
  for (size_t at = text.find("<!--"); at != std::string::npos; at = text.find("<!--", at)) {
    const size_t end = text.find("-->", at) + 3;
    for (; at < end; ++at) {
      if (text[at] != '\n') text[at] = ' ';
    }
  }
  return text;
}

std::vector<GeneratedMutant> Mutants(const std::string& file) {
  const std::string original = ReadFile(InTree(file)), text = WithoutComments(original);
  std::mt19937 dice(static_cast<uint32_t>(text.size()));
  std::vector<GeneratedMutant> out;
  for (const Kind& kind : kKinds) {
    if (!file.ends_with(kind.ending)) continue;
    const std::regex pattern(kind.pattern);
    std::vector<std::smatch> places(std::sregex_iterator(text.begin(), text.end(), pattern),
                                    std::sregex_iterator());
    std::shuffle(places.begin(), places.end(), dice);
    if (places.size() > kPlaces) places.resize(kPlaces);
    for (const std::smatch& place : places) {
      const std::string old = place[1];
      const std::string changed =
          absl::StrReplaceAll(kind.change, {{"&", old}, {"@", place.size() > 2 ? place[2].str() : ""}});
      const auto at = static_cast<size_t>(place.position(1));
      GeneratedMutant mutant{file, kind.name, kind.message, original, 0, absl::StrCat(old, " -> ", changed)};
      mutant.text.replace(at, old.size(), changed);
      mutant.line = 1 + static_cast<size_t>(
                            std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
      out.push_back(std::move(mutant));
    }
  }
  return out;
}

class GeneratedMutants : public testing::TestWithParam<std::string> {};

TEST_P(GeneratedMutants, AreFoundAtTheirLine) {
  for (const GeneratedMutant& mutant : Mutants(GetParam())) {
    const Diagnostics diagnostics = CheckScenarioFile(mutant.file, mutant.text);
    const bool found = std::any_of(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& d) {
      return static_cast<size_t>(d.span.line) == mutant.line &&
             d.message.find(mutant.message) != std::string::npos;
    });
    EXPECT_TRUE(found) << mutant.kind << ", " << mutant.file << ":" << mutant.line << ": " << mutant.change
                       << "\n"
                       << Render(diagnostics, mutant.text);
  }
}

TEST_P(GeneratedMutants, NothingIsFoundInTheOriginal) {
  const std::string text = ReadFile(InTree(GetParam()));
  const Diagnostics diagnostics = CheckScenarioFile(GetParam(), text);
  EXPECT_TRUE(diagnostics.empty()) << Render(diagnostics, text);
}

INSTANTIATE_TEST_SUITE_P(All, GeneratedMutants, testing::ValuesIn(ScenarioDocuments()), [](const auto& info) {
  return std::regex_replace(info.param, std::regex("[^A-Za-z0-9]"), "_");
});

TEST(GeneratedMutantsTest, ThereAreManyOfEachKind) {
  std::map<std::string, size_t> kinds;
  size_t all = 0;
  for (const std::string& file : ScenarioDocuments()) {
    for (const GeneratedMutant& mutant : Mutants(file)) ++kinds[mutant.kind], ++all;
  }
  EXPECT_GE(all, 60u);
  EXPECT_GE(kinds.size(), 25u);
}

}  // namespace
}  // namespace docent::golden
