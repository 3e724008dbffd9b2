#include "maps/hall_picture.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "maps/hall_model.h"
#include "tests/maps/layout_quads.h"

namespace docent::maps {
namespace {

class HallPictureTest : public ::testing::Test {
 protected:
  HallPictureTest() { std::filesystem::create_directories(folder_); }
  ~HallPictureTest() override { std::filesystem::remove_all(folder_); }

  std::string Draw(const HallPicture& picture) {
    const std::string path = (folder_ / "hall.png").string();
    const absl::Status status = WritePng(layout_, picture, path);
    EXPECT_TRUE(status.ok()) << status;
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return std::move(bytes).str();
  }
  // Width and height out of the PNG's header (ISO/IEC 15948, 11.2.2).
  static uint32_t BigEndian(const std::string& png, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(png.at(at + i));
    return value;
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("docent_hall_picture_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
  const HallLayout layout_ = *HallLayout::FromQuads(LayoutQuads::SmallHall().quads());
};

TEST_F(HallPictureTest, WritesAPngAsWideAsAskedAndAsHighAsTheHallNeeds) {
  HallPicture picture;
  picture.width_px = 800;
  const std::string png = Draw(picture);
  ASSERT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(BigEndian(png, 16), 800u);
  EXPECT_NEAR(BigEndian(png, 20), (800 - 96) * 8 / 12.0 + 196, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "hall.png.new"));
}

TEST_F(HallPictureTest, EverythingThatIsAddedShows) {
  HallPicture picture;
  picture.width_px = 600;
  std::string before = Draw(picture);
  const auto changes = [&](const char* what) {
    const std::string after = Draw(picture);
    EXPECT_NE(before, after) << what;
    before = after;
  };
  picture.title = "A title";
  changes("title");
  picture.paths.push_back({"driven", kTruthColor, {{1, 1}, {3, 4}, {8, 5}}, false});
  changes("path");
  picture.marks.push_back({PictureMark::Kind::kRobot, {3, 4, 1}, "R01"});
  changes("mark");
  picture.highlighted.push_back(LayoutQuads::Iri("B1"));
  changes("highlight");
  const auto model = *HallModel::FromLayout(layout_);
  picture.background = &model->laser_field();
  changes("background");
}

TEST_F(HallPictureTest, RefusesWhatCannotBeDrawnOrWritten) {
  HallPicture picture;
  EXPECT_EQ(WritePng(HallLayout(), picture, "x.png").code(), absl::StatusCode::kInvalidArgument);
  picture.width_px = 100;
  EXPECT_EQ(WritePng(layout_, picture, "x.png").code(), absl::StatusCode::kInvalidArgument);
  picture.width_px = 400;
  EXPECT_EQ(WritePng(layout_, picture, "/nonexistent/x.png").code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace docent::maps
