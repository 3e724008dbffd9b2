#include "graph/log/data_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "graph/log/snapshot_files.h"
#include "tests/graph/log/test_records.h"

namespace docent::log {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class DataFolderTest : public ::testing::Test {
 protected:
  DataFolderTest() : outside_(folder_.File("outside")) { std::ofstream(outside_) << "precious"; }
  std::string Outside() const {
    std::ifstream file(outside_);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TestFolder folder_;
  const std::string outside_;
};

TEST_F(DataFolderTest, AFolderThatIsMadeIsForOwnerAndGroupAlone) {
  const mode_t before = umask(0);
  for (const char* name : {"a/b/data", "c/data/", "d"}) {
    const std::string path = folder_.File(name);
    ASSERT_TRUE(DataFolder::Open(path).ok());
    EXPECT_EQ(fs::status(path).permissions(), fs::perms(0750)) << name;
    EXPECT_EQ(fs::status(path + "/lock").permissions(), fs::perms(0640));
  }
  umask(077);
  ASSERT_TRUE(DataFolder::Open(folder_.File("e")).ok());
  EXPECT_EQ(fs::status(folder_.File("e")).permissions(), fs::perms(0700)) << "a stricter umask counts";
  umask(before);
}

TEST_F(DataFolderTest, ALinkInThePlaceOfTheLockOrTheMarkIsNotFollowed) {
  const std::string path = folder_.File("data");
  fs::create_directory(path);
  fs::create_symlink(outside_, path + "/lock");
  const absl::Status refused = DataFolder::Open(path).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(refused.message()), HasSubstr(path + "/lock is a symbolic link"));
  fs::create_symlink(outside_, path + "/mark");
  EXPECT_FALSE(DataFolder::WriteMark(path + "/mark", 7).ok());
  EXPECT_EQ(Outside(), "precious");
}

TEST_F(DataFolderTest, ASnapshotIsWrittenInThePlaceOfALinkAndOfWhatAKilledWriterLeft) {
  const std::string temporary = folder_.File(SnapshotFiles::kUnfinished);
  fs::create_symlink(outside_, temporary);
  SnapshotFiles files(folder_.path(), 4);
  EXPECT_TRUE(files.Put(1, ChainHash{}, "first").ok());
  std::ofstream(temporary) << "half";
  EXPECT_TRUE(files.Put(2, ChainHash{}, "second").ok());
  EXPECT_EQ(files.Offsets().value(), (std::vector<uint64_t>{1, 2}));
  EXPECT_EQ(Outside(), "precious");
}

}  // namespace
}  // namespace docent::log
