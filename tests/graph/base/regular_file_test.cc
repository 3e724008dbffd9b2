#include "graph/base/regular_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"

namespace docent {
namespace {

class RegularFileTest : public ::testing::Test {
 protected:
  RegularFileTest() { std::filesystem::create_directories(folder_); }
  ~RegularFileTest() override { std::filesystem::remove_all(folder_); }

  const std::string folder_ =
      (std::filesystem::temp_directory_path() / absl::StrCat("docent-regular-", getpid())).string();
};

TEST_F(RegularFileTest, AFileIsReadUpToAByteMoreThanTheLimit) {
  std::ofstream(folder_ + "/a") << "12345";
  std::filesystem::create_symlink("a", folder_ + "/link");
  EXPECT_EQ(ReadRegularFile(folder_ + "/a", 5)->text, "12345");
  EXPECT_EQ(ReadRegularFile(folder_ + "/link", 3)->text, "1234");
  EXPECT_EQ(ReadRegularFile(folder_ + "/link", 3)->real_path,
            std::filesystem::canonical(folder_ + "/a").string());
  EXPECT_TRUE(CheckRegularFile(folder_ + "/link").ok());
}

TEST_F(RegularFileTest, APipeOrDeviceIsRefusedWithoutWaiting) {
  ASSERT_EQ(mkfifo((folder_ + "/pipe").c_str(), 0600), 0);
  for (const std::string& path : {folder_ + "/pipe", std::string("/dev/zero"), folder_}) {
    EXPECT_EQ(ReadRegularFile(path, 10, true).status().code(), absl::StatusCode::kInvalidArgument) << path;
    EXPECT_EQ(CheckRegularFile(path).code(), absl::StatusCode::kInvalidArgument) << path;
  }
  EXPECT_EQ(CheckRegularFile(folder_ + "/none").code(), absl::StatusCode::kNotFound);
}

// docent load <(command)
TEST_F(RegularFileTest, APipeOfTheShellIsRead) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "abc", 3), 3);
  close(ends[1]);
  const std::string path = absl::StrCat("/dev/fd/", ends[0]);
  EXPECT_EQ(ReadRegularFile(path, 10).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ReadRegularFile(path, 10, true)->text, "abc");
  close(ends[0]);
}

}  // namespace
}  // namespace docent
