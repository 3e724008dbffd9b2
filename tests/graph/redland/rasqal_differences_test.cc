// Checks rasqal_differences.txt against both engines.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "tests/graph/redland/two_engines.h"

namespace docent::redland {
namespace {

constexpr char kData[] = R"(
ex:g1 { ex:a ex:p 1, 2, 3 ; ex:name "Anna"@en, "Anna"@de, "Anna" . ex:b ex:p 10 ; ex:q ex:a }
ex:g2 { ex:b ex:q ex:a }
ex:m ex:v 2, 10, 2.5, "ten", "one", ex:a, "eins"@de ; ex:w 1, 2 .
)";

struct Difference {
  std::string title, query, docent, rasqal;
};

std::vector<Difference> Read() {
  std::ifstream file(DOCENT_SOURCE_DIR "/tests/graph/redland/rasqal_differences.txt");
  EXPECT_TRUE(file);
  std::vector<Difference> differences;
  for (std::string line; std::getline(file, line);) {
    if (absl::StartsWith(line, "## ")) {
      differences.push_back({line.substr(3), "", "", ""});
    } else if (absl::StartsWith(line, "docent: ")) {
      differences.back().docent = line.substr(8);
    } else if (absl::StartsWith(line, "rasqal: ")) {
      differences.back().rasqal = line.substr(8);
    } else if (!line.empty() && line[0] != '#') {
      differences.back().query = line;
    }
  }
  return differences;
}

// "7 to 14"
bool ReadRange(const std::string& text, int* least, int* most) {
  const std::vector<std::string> ends = absl::StrSplit(text, " to ");
  return ends.size() == 2 && absl::SimpleAtoi(ends[0], least) && absl::SimpleAtoi(ends[1], most);
}

TEST(RasqalDifferencesTest, TheListIsWhatTheEnginesDo) {
  const TwoEngines engines(kData);
  const std::vector<Difference> differences = Read();
  EXPECT_GT(differences.size(), 10u);
  for (const Difference& d : differences) {
    SCOPED_TRACE(d.title + "\n" + d.query);
    const std::string rasqal = engines.Rasqal(d.query);
    if (absl::StartsWith(d.title, "refused: ")) {
      EXPECT_TRUE(absl::StartsWith(rasqal, d.rasqal) && absl::StartsWith(rasqal, "error: ")) << rasqal;
      if (engines.Parse(d.query).form == sparql::Query::Form::kDescribe) continue;
      EXPECT_EQ(engines.Docent(d.query), d.docent);
      continue;
    }
    EXPECT_EQ(engines.Docent(d.query), d.docent);
    int least = 0, most = 0, number = 0;
    if (ReadRange(d.rasqal, &least, &most)) {
      EXPECT_TRUE(absl::SimpleAtoi(rasqal, &number) && least <= number && number <= most) << rasqal;
      continue;
    }
    EXPECT_EQ(rasqal, d.rasqal);
    EXPECT_NE(d.docent, d.rasqal) << "no difference: take it out";
  }
}

}  // namespace
}  // namespace docent::redland
