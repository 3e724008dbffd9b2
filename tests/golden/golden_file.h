// Golden files: one folder for each case, with the input and the expected output in expected.txt.
// DOCENT_UPDATE_GOLDEN=1 rewrites expected.txt; read the difference before committing it.
#ifndef DOCENT_TESTS_GOLDEN_GOLDEN_FILE_H_
#define DOCENT_TESTS_GOLDEN_GOLDEN_FILE_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace docent::golden {

inline std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// Names of the case folders beneath tests/golden/<kind>.
inline std::vector<std::string> Cases(const std::string& kind) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(DOCENT_SOURCE_DIR) /
                                                               "tests/golden" / kind)) {
    if (entry.is_directory()) out.push_back(entry.path().filename().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The input of a case: input.xml, or the file of the repository that source.txt names.
inline std::string Input(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder / "input.xml")) return ReadFile(folder / "input.xml");
  std::string path = ReadFile(folder / "source.txt");
  path.erase(path.find_last_not_of(" \n\r") + 1);
  return ReadFile(std::filesystem::path(DOCENT_SOURCE_DIR) / path);
}

inline void Compare(const std::filesystem::path& folder, const std::string& actual) {
  const char* update = std::getenv("DOCENT_UPDATE_GOLDEN");
  if (update != nullptr && std::string(update) == "1") {
    std::ofstream(folder / "expected.txt", std::ios::binary) << actual;
  }
  EXPECT_EQ(actual, ReadFile(folder / "expected.txt")) << "in " << folder;
}

}  // namespace docent::golden

#endif  // DOCENT_TESTS_GOLDEN_GOLDEN_FILE_H_
