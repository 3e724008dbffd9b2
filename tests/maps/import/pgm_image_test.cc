// PGM images: raw, plain, two bytes a pixel, and what is refused.
#include "maps/import/pgm_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace docent::maps {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string Fault(const std::string& bytes, MapLimits limits = {}) {
  return std::string(ReadPgm(bytes, limits).status().message());
}

TEST(PgmImageTest, ReadsRawAndPlainWithCommentsAndAnyWhite) {
  auto image = ReadPgm(std::string("P5\n# made by hand\n3 1\n255\n\x00\x7f\xff", 30));
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 1);
  EXPECT_THAT(image->pixels, ElementsAre(0, 127, 255));
  image = ReadPgm("P2 2 2 # comment\n 4\n 0 1\n 2 4 ");
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_THAT(image->pixels, ElementsAre(0, 64, 128, 255));
  image = ReadPgm(std::string("P5 2 1 65535 \xff\xff\x80\x00", 17));
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_THAT(image->pixels, ElementsAre(255, 128));
}

TEST(PgmImageTest, RefusesWhatItIsNot) {
  EXPECT_THAT(Fault("\x89PNG\r\n"), HasSubstr("not a PGM image"));
  EXPECT_THAT(Fault("P6 1 1 255 abc"), HasSubstr("not a PGM image"));
  EXPECT_THAT(Fault(""), HasSubstr("not a PGM image"));
  EXPECT_THAT(Fault("P5 3"), HasSubstr("header"));
  EXPECT_THAT(Fault("P5 x y 255 "), HasSubstr("header"));
  EXPECT_THAT(Fault("P5 0 1 255 "), HasSubstr("0 x 1 pixels"));
  EXPECT_THAT(Fault("P5 1 1 0 a"), HasSubstr("white 0"));
  EXPECT_THAT(Fault("P5 1 1 70000 a"), HasSubstr("white 70000"));
  EXPECT_THAT(Fault("P5 2 2 255 abc"), HasSubstr("ends after 3 of 4 pixels"));
  EXPECT_THAT(Fault("P2 2 2 255 1 2 3"), HasSubstr("of 4 pixels"));
  EXPECT_THAT(Fault("P2 2 2 255 1 2 3 xxxx"), HasSubstr("ends after 3 of 4 pixels"));
}

TEST(PgmImageTest, AHeaderThatPromisesTooMuchIsRefusedBeforeMemoryIsTaken) {
  EXPECT_THAT(Fault("P5 1000000000 1000000000 255 "), HasSubstr("the limit map_image_pixels is 100000000"));
  EXPECT_THAT(Fault("P5 99999999999999999999 99999999999999999999 255 "), HasSubstr("map_image_pixels"));
  EXPECT_THAT(Fault("P2 1 100000001 255 "), HasSubstr("map_image_pixels"));
  EXPECT_THAT(Fault("P5 10000 10000 255 "), HasSubstr("ends after 0 of 100000000 pixels"));
  MapLimits limits;
  limits.map_image_pixels = 4;
  EXPECT_EQ(Fault("P5 2 2 255 abcd", limits), "");
  EXPECT_THAT(Fault("P5 5 1 255 abcde", limits), HasSubstr("the limit map_image_pixels is 4"));
}

}  // namespace
}  // namespace docent::maps
