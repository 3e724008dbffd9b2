// The whole guide robot, commanded over gRPC, with a fake server as its server. Runs at 50 times real
// time.
#include "robot_adapters/sim/guide_robot.h"

#include <grpcpp/grpcpp.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "docent/v1/robot_adapter.grpc.pb.h"
#include "gmock/gmock.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"
#include "tests/robot_adapters/sdk/fake_server.h"

namespace docent::robot {
namespace {

using testing::HasSubstr;

const std::string kExpo = "https://w3id.org/docent/expo#";
const std::string kRobot = kExpo + "R01";

class GuideRobotTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto layout = maps::HallLayout::FromFile(DOCENT_SOURCE_DIR "/scenarios/s01_booth_guide/hall.ttl");
    ASSERT_TRUE(layout.ok()) << layout.status();
    layout_ = new maps::HallLayout(*std::move(layout));
    auto model = maps::HallModel::FromLayout(*layout_);
    ASSERT_TRUE(model.ok()) << model.status();
    model_ = new std::shared_ptr<const maps::HallModel>(*std::move(model));
  }
  static void TearDownTestSuite() {
    delete model_;
    delete layout_;
  }

  GuideRobotTest() {
    folder_ = testing::TempDir() + "guide_" + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
  }

  GuideRobotOptions Options() {
    GuideRobotOptions options;
    options.adapter.robot = kRobot;
    options.adapter.label = "R01";
    options.adapter.server = server_.address();
    options.folder = folder_;
    options.speed = 50;
    options.seed = 2;
    options.pictures = DOCENT_SOURCE_DIR "/scenarios/s01_booth_guide/pictures";
    return options;
  }
  void StartRobot() {
    auto robot = GuideRobot::Start(Options(), *layout_, *model_);
    ASSERT_TRUE(robot.ok()) << robot.status();
    robot_ = *std::move(robot);
    stub_ =
        v1::RobotAdapter::NewStub(grpc::CreateChannel(robot_->address(), grpc::InsecureChannelCredentials()));
  }

  v1::Feedback Command(const std::string& id, const std::string& operation, const std::string& part,
                       const std::string& value) {
    v1::InvokeRequest request;
    v1::NamedTerm* argument = request.add_arguments();
    argument->set_name(part);
    argument->mutable_value()->set_iri(value);
    return Send(id, operation, std::move(request));
  }

  v1::Feedback Command(const std::string& id, const std::string& operation, const Term& text) {
    v1::InvokeRequest request;
    v1::NamedTerm* argument = request.add_arguments();
    argument->set_name("text");
    argument->mutable_value()->mutable_literal()->set_lexical(text.lexical);
    argument->mutable_value()->mutable_literal()->set_language(text.language);
    return Send(id, operation, std::move(request));
  }

  v1::Feedback Send(const std::string& id, const std::string& operation, v1::InvokeRequest request) {
    request.set_command_id(id);
    request.set_operation(operation);
    grpc::ClientContext context;
    auto reader = stub_->Invoke(&context, request);
    v1::Feedback feedback;
    while (reader->Read(&feedback)) {
    }
    grpc::Status status = reader->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    return feedback;
  }

  static maps::HallLayout* layout_;
  static std::shared_ptr<const maps::HallModel>* model_;
  std::string folder_;
  FakeServer server_;
  std::unique_ptr<GuideRobot> robot_;
  std::unique_ptr<v1::RobotAdapter::Stub> stub_;
};

maps::HallLayout* GuideRobotTest::layout_ = nullptr;
std::shared_ptr<const maps::HallModel>* GuideRobotTest::model_ = nullptr;

TEST_F(GuideRobotTest, GuidesThenShowsAndSpeaks) {
  server_.AnswerRow("John", {"", "", kExpo + "Entrance"});
  server_.AnswerRow("B03", {"B03", "A robot that climbs stairs.", "Stairlark Robotics", "Up", "Carrier",
                            "stairlark_carrier.svg"});
  StartRobot();
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("localised"), "true"));
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("isAt"), kExpo + "RobotDock"));

  EXPECT_EQ(Command("c/1", "moveToUser", "user", kExpo + "John").state(), v1::Feedback::SUCCEEDED);
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("isAt"), kExpo + "Entrance"));
  EXPECT_EQ(Command("c/2", "moveToBooth", "booth", kExpo + "B03").state(), v1::Feedback::SUCCEEDED);
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("isAt"), kExpo + "B03"));
  EXPECT_NEAR(std::stod(server_.Value(kRobot, DocentIri("x"))), 15, 0.2);

  const v1::Feedback shown = Command("c/3", "displayBoothInfo", "booth", kExpo + "B03");
  ASSERT_EQ(shown.state(), v1::Feedback::SUCCEEDED) << shown.message();
  EXPECT_EQ(shown.results(0).value().iri(), robot_->screen_address() + "B03");
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("screenPage"), robot_->screen_address() + "B03"));
  std::ostringstream page;
  page << std::ifstream(folder_ + "/screen_B03.html").rdbuf();
  EXPECT_THAT(page.str(), HasSubstr("src=\"data:image/svg+xml;base64,"));

  const v1::Feedback spoken = Command("c/4", "briefBoothInfo", "booth", kExpo + "B03");
  if (spoken.message().find("not installed") == std::string::npos) {
    ASSERT_EQ(spoken.state(), v1::Feedback::SUCCEEDED) << spoken.message();
    EXPECT_GT(std::filesystem::file_size(folder_ + "/briefing_B03.wav"), 100'000u);
    EXPECT_TRUE(
        server_.AwaitValue(kRobot, DocentIri("spokenFile"), spoken.results(0).value().literal().lexical()));
  }
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Standby")));

  auto error = robot_->WriteReportNow();
  ASSERT_TRUE(error.ok()) << error.status();
  EXPECT_LE(error->rmse_mm, 22);
  EXPECT_LE(error->rmse_deg, 0.3);
  EXPECT_TRUE(std::filesystem::exists(folder_ + "/path.png"));
}

TEST_F(GuideRobotTest, FailsWithReasonsThatSayWhatToDo) {
  StartRobot();
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("localised"), "true"));
  const v1::Feedback unknown_place = Command("c/1", "moveToBooth", "booth", kExpo + "B99");
  EXPECT_EQ(unknown_place.state(), v1::Feedback::FAILED);
  EXPECT_THAT(unknown_place.message(), HasSubstr("no region <" + kExpo + "B99>"));
  server_.AnswerRow("Jane", {"", "", ""});
  EXPECT_THAT(Command("c/2", "moveToUser", "user", kExpo + "Jane").message(),
              HasSubstr("does not say where"));
  EXPECT_THAT(Command("c/3", "displayBoothInfo", "booth", kExpo + "B99").message(),
              HasSubstr("knows the booth"));
  EXPECT_THAT(Command("c/4", "moveToUser", "user", "no iri> } #").message(), HasSubstr("has to be an IRI"));
  EXPECT_THAT(Command("c/5", "driveTo", "place", kExpo + "B99").message(),
              HasSubstr("no region <" + kExpo + "B99>"));
  EXPECT_THAT(Command("c/6", "say", "text", kExpo + "B99").message(), HasSubstr("has to be a text"));
}

TEST_F(GuideRobotTest, DrivesToAPlaceAndTellsATextInItsLanguage) {
  StartRobot();
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("localised"), "true"));
  EXPECT_EQ(Command("c/1", "driveTo", "place", kExpo + "Entrance").state(), v1::Feedback::SUCCEEDED);
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("isAt"), kExpo + "Entrance"));
  const Term text = Term::LangString("Guten Tag <Johann>!", "de");
  const v1::Feedback shown = Command("c/2", "showText", text);
  ASSERT_EQ(shown.state(), v1::Feedback::SUCCEEDED) << shown.message();
  std::ifstream page(folder_ + "/screen_text.html");
  const std::string html(std::istreambuf_iterator<char>(page), {});
  EXPECT_THAT(html, HasSubstr("<h1 lang=\"de\">Guten Tag &lt;Johann&gt;!</h1>"));
  const v1::Feedback spoken = Command("c/3", "say", text);
  if (spoken.message().find("not installed") == std::string::npos) {
    ASSERT_EQ(spoken.state(), v1::Feedback::SUCCEEDED) << spoken.message();
    EXPECT_GT(std::filesystem::file_size(folder_ + "/said_1.wav"), 10'000u);
    EXPECT_THAT(Command("c/4", "say", Term::LangString("?", "xx-none")).message(),
                HasSubstr("does not speak \"xx-none\""));
  }
}

TEST_F(GuideRobotTest, StandsWhereItWasLeftWhenItsProgramIsRestarted) {
  StartRobot();
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("localised"), "true"));
  ASSERT_EQ(Command("c/1", "moveToBooth", "booth", kExpo + "B09").state(), v1::Feedback::SUCCEEDED);
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("isAt"), kExpo + "B09"));
  robot_.reset();
  FakeServer other;
  GuideRobotOptions options = Options();
  options.adapter.server = other.address();
  auto again = GuideRobot::Start(options, *layout_, *model_);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_TRUE(other.AwaitValue(kRobot, DocentIri("isAt"), kExpo + "B09"));
}

TEST_F(GuideRobotTest, TwoDrivesAtOnceAreRefused) {
  server_.AnswerRow("John", {"", "", kExpo + "Entrance"});
  GuideRobotOptions options = Options();
  options.speed = 1;
  auto robot = GuideRobot::Start(options, *layout_, *model_);
  ASSERT_TRUE(robot.ok()) << robot.status();
  robot_ = *std::move(robot);
  stub_ =
      v1::RobotAdapter::NewStub(grpc::CreateChannel(robot_->address(), grpc::InsecureChannelCredentials()));
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("localised"), "true"));
  std::thread first([this] {
    EXPECT_EQ(Command("c/1", "moveToBooth", "booth", kExpo + "B07").state(), v1::Feedback::CANCELLED);
  });
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Busy")));
  // Growing progress shows that it is on its way.
  for (std::string progress; progress.empty() || progress == "0.0"; absl::SleepFor(absl::Milliseconds(5))) {
    progress = server_.Value(kRobot, DocentIri("progress"));
  }
  EXPECT_THAT(Command("c/3", "moveToUser", "user", kExpo + "John").message(),
              HasSubstr("driving for another command"));
  grpc::ClientContext context;
  v1::CancelRequest cancel;
  cancel.set_command_id("c/1");
  v1::CancelReply reply;
  EXPECT_TRUE(stub_->Cancel(&context, cancel, &reply).ok());
  first.join();
}

TEST_F(GuideRobotTest, BadOptionsAreOneClearError) {
  GuideRobotOptions options = Options();
  options.speed = 0;
  EXPECT_TRUE(absl::IsInvalidArgument(GuideRobot::Start(options, *layout_, *model_).status()));
  options = Options();
  options.folder = "/proc/nowhere";
  EXPECT_TRUE(absl::IsInvalidArgument(GuideRobot::Start(options, *layout_, *model_).status()));
  options = Options();
  options.start = maps::Pose2{0.5, 11, 0};  // in the stair tower
  EXPECT_TRUE(absl::IsInvalidArgument(GuideRobot::Start(options, *layout_, *model_).status()));
}

TEST(DockTest, IsTheRegionNamedSo) {
  auto layout = maps::HallLayout::FromFile(DOCENT_SOURCE_DIR "/scenarios/s01_booth_guide/hall.ttl");
  ASSERT_TRUE(layout.ok());
  auto dock = DockOf(*layout);
  ASSERT_TRUE(dock.ok());
  EXPECT_EQ((*dock)->service_point->x_m, 9.6);
  EXPECT_FALSE(DockOf({}).ok());
}

}  // namespace
}  // namespace docent::robot
