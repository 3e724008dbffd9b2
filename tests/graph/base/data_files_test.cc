#include "graph/base/data_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

namespace docent {
namespace {

namespace fs = std::filesystem;

class DataFilesTest : public testing::Test {
 protected:
  void SetUp() override {
    unsetenv("DOCENT_DATA_DIR");
    fs::remove_all(root_);
  }
  void TearDown() override {
    unsetenv("DOCENT_DATA_DIR");
    fs::remove_all(root_);
  }
  void Put(const std::string& name) {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << "x";
  }
  std::string In(const std::string& name) const { return (root_ / name).string(); }

  const fs::path root_ = fs::path(testing::TempDir()) / "docent_data_files" /
                         testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(DataFilesTest, AnInstalledProgramFindsThemInShare) {
  Put("usr/share/docent/ontology/docent.ttl");
  Put("ontology/docent.ttl");
  EXPECT_EQ(FindDataFile("ontology/docent.ttl", In("usr/bin")).value(),
            In("usr/share/docent/ontology/docent.ttl"));
}

TEST_F(DataFilesTest, AProgramThatWasJustBuiltFindsThemInTheSourceTree) {
  Put("tree/ontology/docent.ttl");
  EXPECT_EQ(FindDataFile("ontology/docent.ttl", In("tree/build/dev/bin")).value(),
            In("tree/ontology/docent.ttl"));
}

TEST_F(DataFilesTest, TheEnvironmentVariableDecidesAlone) {
  Put("mine/a.ttl");
  Put("usr/share/docent/b.ttl");
  setenv("DOCENT_DATA_DIR", In("mine").c_str(), 1);
  EXPECT_EQ(FindDataFile("a.ttl", In("usr/bin")).value(), In("mine/a.ttl"));
  EXPECT_FALSE(FindDataFile("b.ttl", In("usr/bin")).ok());
}

TEST_F(DataFilesTest, AFileThatIsNowhereIsRefusedWithThePlacesThatWereLookedAt) {
  const absl::Status status = FindDataFile("ontology/docent.ttl", In("usr/bin")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr(In("usr/share/docent")));
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("DOCENT_DATA_DIR"));
}

TEST_F(DataFilesTest, ThisTestProgramFindsTheTree) {
  EXPECT_TRUE(FindDataFile("ontology/docent.ttl").ok());
}

}  // namespace
}  // namespace docent
