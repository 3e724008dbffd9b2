// Presentation to visitors: page, picture, voice; and the files about the drive.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "robot_adapters/sim/booth_page.h"
#include "robot_adapters/sim/booth_picture.h"
#include "robot_adapters/sim/drive_trace.h"
#include "robot_adapters/sim/text_file.h"
#include "robot_adapters/sim/voice.h"
#include "robot_adapters/sim/world_state.h"

namespace docent::robot {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string Folder() {
  const std::string folder =
      testing::TempDir() + "presentation_" + testing::UnitTest::GetInstance()->current_test_info()->name();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

std::string ReadFile(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

maps::HallLayout TinyHall() {
  maps::HallLayout hall;
  hall.iri = "urn:hall";
  hall.name = "Hall <4>";
  hall.outline = {{0, 0}, {10, 0}, {10, 6}, {0, 6}};
  maps::Region booth;
  booth.iri = "urn:b3";
  booth.name = "B03";
  booth.is_booth = true;
  booth.outline = {{6, 3}, {9, 3}, {9, 6}, {6, 6}};
  hall.regions.push_back(booth);
  return hall;
}

TEST(BoothPageTest, PresentsTheBoothAndEscapesWhatPeopleWrote) {
  BoothInfo booth{"urn:b3",   "B03",      "Robots & <script>alert(1)</script>", "\"Stairlark\" Robotics",
                  "Up we go", {"Carrier"}};
  const std::string page = BoothPage(booth, "", TinyHall(), {5, 2, 0}, "R01");
  EXPECT_THAT(page, HasSubstr("Booth B03"));
  EXPECT_THAT(page, HasSubstr("&quot;Stairlark&quot; Robotics"));
  EXPECT_THAT(page, HasSubstr("Robots &amp; &lt;script&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<script>")));
  EXPECT_THAT(page, HasSubstr("<li>Carrier</li>"));
  EXPECT_THAT(page, HasSubstr("Hall &lt;4&gt;"));
  EXPECT_THAT(page, HasSubstr("translate(5.00 4.00)"));  // the robot on the plan, y downwards
  EXPECT_THAT(page, Not(HasSubstr("<img")));
  EXPECT_THAT(page, HasSubstr("Where you are, and booth B03."));
  EXPECT_THAT(BoothPage(booth, "", TinyHall(), {7, 4, 0}, "R01"), HasSubstr("You are here, at booth B03."));
}

TEST(BoothPageTest, KnowsNothingButAName) {
  const std::string page = BoothPage({"urn:b3", "B03", "", "", "", {}}, "", TinyHall(), {5, 2, 0}, "R01");
  EXPECT_THAT(page, HasSubstr("<h1>B03</h1>"));
  EXPECT_THAT(page, Not(HasSubstr("class=\"slogan\"")));
}

TEST(BoothPageTest, HasThePictureThatTheGraphNames) {
  const std::string folder = Folder();
  ASSERT_TRUE(WriteTextFile(folder + "/b3.SVG", "<svg/>").ok());
  for (const char* image : {"b3.SVG", "file:///home/b/pictures/b3.SVG", "../../b3.SVG"}) {
    const auto picture = PictureUri(folder, image);
    ASSERT_TRUE(picture.ok()) << picture.status();
    EXPECT_EQ(*picture, "data:image/svg+xml;base64,PHN2Zy8+");
    BoothInfo booth{"urn:b3", "B03", "", "Stairlark", "", {"\"The\" Carrier"}};
    EXPECT_THAT(
        BoothPage(booth, *picture, TinyHall(), {5, 2, 0}, "R01"),
        HasSubstr("<img alt=\"&quot;The&quot; Carrier\" src=\"data:image/svg+xml;base64,PHN2Zy8+\">"));
  }
}

TEST(BoothPageTest, WhatIsNoPictureIsNotRead) {
  const std::string folder = Folder();
  std::filesystem::create_directories(folder + "/folder.png");
  EXPECT_EQ(PictureUri(folder, "world.state").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(PictureUri(folder, "http://example.org/pictures/").status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(PictureUri(folder, ".png").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(PictureUri(folder, "absent.png").status().code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(PictureUri(folder, "folder.png").ok());
  ASSERT_TRUE(WriteTextFile(folder + "/large.png", std::string(kPictureBytes, 'x')).ok());
  EXPECT_TRUE(PictureUri(folder, "large.png").ok());
  ASSERT_TRUE(WriteTextFile(folder + "/large.png", std::string(kPictureBytes + 1, 'x')).ok());
  EXPECT_EQ(PictureUri(folder, "large.png").status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(SpokenTextTest, SaysTheBoothAsPeopleDo) {
  EXPECT_EQ(SpokenText({"", "B03", "They climb stairs.", "Stairlark", "Up", {}}),
            "Welcome to booth B 3 of Stairlark. Up. They climb stairs.");
  EXPECT_EQ(SpokenText({"", "Forum", "", "", "", {}}), "Welcome to booth Forum.");
  EXPECT_EQ(SpokenText({"", "B10", "", "", "", {}}), "Welcome to booth B 10.");
  EXPECT_EQ(SpokenText({"", "B00", "", "", "", {}}), "Welcome to booth B 0.");
}

TEST(VoiceTest, SpeaksIntoAFileOfTheRightLength) {
  const std::string file = Folder() + "/voice.wav";
  auto length = SpeakToFile("Welcome to booth B 3 of Stairlark Robotics.", file, [] { return true; });
  ASSERT_TRUE(length.ok()) << length.status();
  EXPECT_GT(length->count(), 1500);
  EXPECT_LT(length->count(), 8000);
  EXPECT_EQ(ReadFile(file).substr(0, 4), "RIFF");
  EXPECT_EQ(*PlayingTime(file), *length);
}

TEST(VoiceTest, StopsWhenTold) {
  auto length = SpeakToFile("Never heard.", Folder() + "/voice.wav", [] { return false; });
  EXPECT_FALSE(length.ok());
}

TEST(VoiceTest, PlayingTimeOfSomethingElseIsAnError) {
  const std::string folder = Folder();
  ASSERT_TRUE(WriteTextFile(folder + "/a.wav", "RIFF....WAVEfmt ").ok());
  EXPECT_TRUE(absl::IsInvalidArgument(PlayingTime(folder + "/a.wav").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(PlayingTime(folder + "/missing.wav").status()));
}

TEST(TextFileTest, FileNamesAreSafe) {
  EXPECT_EQ(FileNameOf("https://w3id.org/docent/expo#B03"), "B03");
  EXPECT_EQ(FileNameOf("urn:x/../../etc/pass wd"), "pass_wd");
  EXPECT_EQ(FileNameOf("urn:x#"), "thing");
  EXPECT_FALSE(WriteTextFile("/nonexistent/folder/file", "x").ok());
}

TEST(WorldStateTest, IsKept) {
  const std::string file = Folder() + "/world.state";
  EXPECT_FALSE(LoadWorld(file).has_value());
  ASSERT_TRUE(SaveWorld(file, {1.5, -2.25, 0.5}).ok());
  EXPECT_EQ(LoadWorld(file), (maps::Pose2{1.5, -2.25, 0.5}));
  ASSERT_TRUE(WriteTextFile(file, "pose 1 nan 2\n").ok());
  EXPECT_FALSE(LoadWorld(file).has_value());
}

TEST(DriveTraceTest, ErrorsAreRootMeanSquares) {
  std::vector<TracePoint> trace = {{0, {0, 0, 3.1}, {0.03, 0.04, -3.1}}, {1, {1, 1, 0}, {1, 1, 0}}};
  const PathError error = ErrorOf(trace);
  EXPECT_NEAR(error.rmse_mm, 50 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(error.max_error_mm, 50, 1e-9);
  EXPECT_NEAR(error.max_error_deg, (2 * M_PI - 6.2) * 180 / M_PI, 1e-6);  // across ±180 degrees
  EXPECT_EQ(ErrorOf({}).points, 0u);
}

TEST(DriveTraceTest, WritesCsvJsonAndPicture) {
  const std::string folder = Folder();
  DriveReport report;
  report.robot = "urn:r1";
  report.seed = 4;
  report.path_m = 1.25;
  report.trace = {{0, {1, 1, 0}, {1.01, 1, 0}}, {0.2, {2, 1, 0}, {2, 1.01, 0}}};
  absl::Status written = WriteReport(report, TinyHall(), folder);
  ASSERT_TRUE(written.ok()) << written;
  EXPECT_THAT(ReadFile(folder + "/report.json"), HasSubstr("\"rmse_mm\": 10.000"));
  EXPECT_THAT(ReadFile(folder + "/path.csv"), HasSubstr("0.20,2.0000,1.0000,0.0000,2.0000,1.0100,0.0000"));
  EXPECT_EQ(ReadFile(folder + "/path.png").substr(1, 3), "PNG");
  EXPECT_FALSE(WriteReport(report, TinyHall(), folder + "/missing").ok());
}

}  // namespace
}  // namespace docent::robot
