#include "workflow/rsel/service_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "workflow/rsel/feasibility.h"
#include "workflow/rsel/generator.h"
#include "workflow/rsel/parser.h"
#include "workflow/xml/formatter.h"

namespace docent::rsel {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

DocumentPtr Parse(const std::string& text) {
  ParsedRsel parsed = ParseRsel(text, "f");
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  return parsed.document;
}

const char kLead[] =
    "<rsel name=\"lead\"><process name=\"Lead\"><invoke operation=\"move\">"
    "<input part=\"booth\" from=\"booth\"/></invoke></process></rsel>";
const char kTour[] =
    "<rsel name=\"tour\" version=\"2\"><process name=\"Tour\"><invoke operation=\"Lead\"/>"
    "<invoke operation=\"wave\"/></process></rsel>";

TEST(ServiceRegistry, ReusesProcessesOfOtherDocuments) {
  ServiceRegistry registry;
  ASSERT_THAT(registry.Put(Parse(kLead)), IsEmpty());
  ASSERT_THAT(registry.Put(Parse(kTour)), IsEmpty());
  PlanPtr tour = registry.Find("Tour");
  ASSERT_NE(tour, nullptr);
  EXPECT_THAT(tour->inputs, ElementsAre("booth"));
  ASSERT_THAT(tour->steps, SizeIs(2));
  EXPECT_EQ(tour->steps[0].path, "Lead/move");
  EXPECT_EQ(tour->version, "2");
  EXPECT_THAT(registry.ProcessNames(), ElementsAre("Lead", "Tour"));
  EXPECT_EQ(registry.version(), 2u);
}

TEST(ServiceRegistry, ARunningPlanSurvivesReplacement) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  PlanPtr before = registry.Find("Lead");
  registry.Put(
      Parse("<rsel name=\"lead\"><process name=\"Lead\"><invoke operation=\"fly\"/></process></rsel>"));
  EXPECT_EQ(before->steps[0].operation, "move");
  EXPECT_EQ(registry.Find("Lead")->steps[0].operation, "fly");
}

TEST(ServiceRegistry, AFailedPutChangesNothing) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  registry.Put(Parse(kTour));
  // Tour gives Lead a booth; a Lead that also requires a place breaks it.
  Diagnostics broken = registry.Put(
      Parse("<rsel name=\"lead\"><message name=\"M\"><part name=\"booth\"/><part name=\"place\"/>"
            "</message><process name=\"Lead\" input=\"M\"><invoke operation=\"m\"/></process>"
            "<process name=\"Tour\"><invoke operation=\"m\"/></process></rsel>"));
  ASSERT_TRUE(HasErrors(broken));
  EXPECT_THAT(broken[0].message, HasSubstr("already registered by document tour"));
  EXPECT_EQ(registry.version(), 2u);
  EXPECT_EQ(registry.Find("Lead")->steps[0].operation, "move");
}

TEST(ServiceRegistry, AChangeThatBreaksAnotherDocumentIsRefused) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  registry.Put(
      Parse("<rsel name=\"tour\"><process name=\"Tour\"><invoke operation=\"Lead\">"
            "<input part=\"booth\" from=\"first\"/></invoke></process></rsel>"));
  Diagnostics broken =
      registry.Put(Parse("<rsel name=\"lead\"><process name=\"Lead\"><invoke operation=\"move\">"
                         "<input part=\"place\" from=\"place\"/></invoke></process></rsel>"));
  ASSERT_TRUE(HasErrors(broken));
  EXPECT_THAT(broken[0].message, HasSubstr("the registered document tour would no longer work"));
}

TEST(ServiceRegistry, RemoveKeepsWhatOthersNeed) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  registry.Put(Parse(kTour));
  absl::Status refused = registry.Remove("lead");
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("part of process Tour"));
  EXPECT_TRUE(registry.Remove("tour").ok());
  EXPECT_TRUE(registry.Remove("lead").ok());
  EXPECT_EQ(registry.Remove("lead").code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(registry.Plans(), IsEmpty());
}

TEST(ServiceRegistry, CopiesAreIndependent) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  ServiceRegistry copy = registry;
  copy.Put(Parse(kTour));
  EXPECT_EQ(registry.Find("Tour"), nullptr);
  EXPECT_NE(copy.Find("Tour"), nullptr);
}

TEST(ServiceRegistry, StepsAreLimited) {
  auto text = [](int invokes) {
    std::string out = "<rsel name=\"big\"><process name=\"Ten\">";
    for (int i = 0; i < 10; ++i) out += "<invoke operation=\"x\"/>";
    out += "</process><process name=\"Big\">";
    for (int i = 0; i < invokes; ++i) out += "<invoke operation=\"Ten\"/>";
    return out + "</process></rsel>";
  };
  ServiceRegistry registry;
  EXPECT_THAT(registry.Put(Parse(text(100))), IsEmpty());
  EXPECT_THAT(registry.Find("Big")->steps, SizeIs(1000));
  Diagnostics over = registry.Put(Parse(text(101)));
  ASSERT_TRUE(HasErrors(over));
  EXPECT_THAT(over[0].message, HasSubstr("more than 1000 steps"));
}

// p0 contains p1 contains p2 …; each `times` times.
std::string Chain(int length, int times) {
  std::string text = "<rsel name=\"deep\">";
  for (int i = 0; i < length; ++i) {
    absl::StrAppend(&text, "<process name=\"p", i, "\">");
    for (int k = 0; k < times; ++k) absl::StrAppend(&text, "<invoke operation=\"p", i + 1, "\"/>");
    text += "</process>";
  }
  return text + "</rsel>";
}

TEST(ServiceRegistry, NestingIsLimited) {
  ServiceRegistry registry;
  EXPECT_THAT(registry.Put(Parse(Chain(33, 1))), IsEmpty());
  EXPECT_EQ(registry.Find("p0")->steps.size(), 1u);
  Diagnostics over = registry.Put(Parse(Chain(34, 1)));
  ASSERT_TRUE(HasErrors(over));
  EXPECT_THAT(over[0].message, HasSubstr("deeper than 32"));
}

TEST(ServiceRegistry, DoublingAndLongChainsEnd) {
  ServiceRegistry registry;
  EXPECT_TRUE(HasErrors(registry.Put(Parse(Chain(60, 2)))));
  EXPECT_TRUE(HasErrors(registry.Put(Parse(Chain(20000, 1)))));
}

TEST(ServiceRegistry, StepsAltogetherAreLimited) {
  auto text = [](int processes) {
    std::string out = "<rsel name=\"many\"><process name=\"Thousand\">";
    for (int i = 0; i < 1000; ++i) out += "<invoke operation=\"x\"/>";
    out += "</process>";
    for (int i = 0; i < processes; ++i)
      absl::StrAppend(&out, "<process name=\"p", i, "\"><invoke operation=\"Thousand\"/></process>");
    return out + "</rsel>";
  };
  ServiceRegistry registry;
  EXPECT_THAT(registry.Put(Parse(text(199))), IsEmpty());
  Diagnostics over = registry.Put(Parse(text(200)));
  ASSERT_TRUE(HasErrors(over));
  EXPECT_THAT(over[0].message, HasSubstr("more than 200000 steps"));
}

TEST(Feasibility, OneRobotMustOfferAll) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  registry.Put(Parse(kTour));
  std::vector<OfferedOperation> offered = {{RobotId("urn:r2"), "move", {"booth"}, {}, true, ""},
                                           {RobotId("urn:r1"), "move", {"booth"}, {}, true, ""},
                                           {RobotId("urn:r1"), "wave", {}, {}, true, ""}};
  EXPECT_THAT(CapableRobots(*registry.Find("Tour"), offered), ElementsAre(RobotId("urn:r1")));
  EXPECT_THAT(CapableRobots(*registry.Find("Lead"), offered),
              ElementsAre(RobotId("urn:r1"), RobotId("urn:r2")));
}

TEST(Generator, WhatItWritesParsesAndIsFeasible) {
  std::vector<OfferedOperation> offered = {
      {RobotId("urn:r1"), "moveToUser", {"user"}, {}, true, "Drives to <the> \"user\" & waits"},
      {RobotId("urn:r1"), "locate", {}, {"pose", "region"}, true, ""},
      {RobotId("urn:r2"), "moveToUser", {"user"}, {}, true, "another"},
      {RobotId("urn:r1"), "odd", {"not a name"}, {}, true, ""}};
  std::string text = GenerateRsel("R & D", offered);
  DocumentPtr document = Parse(text);
  ASSERT_NE(document, nullptr);
  EXPECT_EQ(document->name.value, "R & D");
  ServiceRegistry registry;
  EXPECT_THAT(registry.Put(document), IsEmpty());
  EXPECT_THAT(registry.ProcessNames(), ElementsAre("locate", "moveToUser"));
  EXPECT_THAT(CheckFeasibility(*document, registry, offered), IsEmpty());
  EXPECT_THAT(registry.Find("moveToUser")->inputs, ElementsAre("user"));
  EXPECT_THAT(registry.Find("locate")->outputs, SizeIs(2));
}

std::vector<OfferedOperation> TypedOperations() {
  const std::string region = DocentIri("Region"), text = std::string(kXsdString),
                    number = std::string(kXsdInteger);
  std::vector<OfferedOperation> offered(4);
  for (OfferedOperation& o : offered) o.robot = RobotId("urn:r1");
  offered[0].name = "drive";
  offered[0].inputs = {"place"};
  offered[0].outputs = {"picture"};
  offered[0].input_types = {{"place", region}};
  offered[0].output_types = {{"picture", text}};
  offered[1].name = "show";
  offered[1].inputs = {"picture", "seconds"};
  offered[1].input_types = {{"picture", text}, {"seconds", number}};
  offered[2].name = "say";
  offered[2].inputs = {"seconds", "place"};
  offered[2].outputs = {"place"};
  offered[2].input_types = {{"seconds", text}, {"place", region}};
  offered[2].output_types = {{"place", "https://example.org/things#Spot"}};
  offered[3].name = "wave";
  offered[3].robot = RobotId("urn:r2");
  return offered;
}

TEST(Generator, StepsAreMappedByNameAndType) {
  const std::vector<OfferedOperation> offered = TypedOperations();
  ServiceRegistry registry;
  const absl::StatusOr<std::string> text =
      GenerateDocument({"Tour", "tour", {"drive", "show", "say"}, RobotId()}, offered, registry);
  ASSERT_TRUE(text.ok()) << text.status();
  DocumentPtr document = Parse(*text);
  ASSERT_NE(document, nullptr) << *text;
  EXPECT_THAT(registry.Put(document), IsEmpty());
  EXPECT_THAT(CheckFeasibility(*document, registry, offered), IsEmpty()) << *text;
  const PlanPtr plan = registry.Find("tour");
  EXPECT_THAT(plan->inputs, ElementsAre("place", "seconds", "say_seconds"));
  EXPECT_EQ(plan->steps[1].inputs[0].second.slot, "1.picture")
      << "the result of a step goes into the next one";
  EXPECT_EQ(plan->steps[2].inputs[0].second.slot, "say_seconds") << "another type is another part";
  EXPECT_EQ(plan->steps[2].inputs[1].second.slot, "place");
  EXPECT_EQ(plan->input_types.at("say_seconds"), kXsdString);
  EXPECT_EQ(plan->output_types.at("say_place"), "https://example.org/things#Spot");
  EXPECT_EQ(xml::FormatXml(*text, "f").text, *text) << "docent fmt changes nothing";
  EXPECT_EQ(*GenerateDocument({"Tour", "tour", {"drive", "show", "say"}, RobotId()}, offered, registry),
            *text);
}

TEST(Generator, APartWhoseNamesAreTakenGetsTheNextNumber) {
  std::vector<OfferedOperation> offered(2);
  offered[0].robot = offered[1].robot = RobotId("urn:r1");
  offered[0].name = "measure";
  offered[0].inputs = {"a", "mix_a"};
  offered[0].input_types = {{"a", std::string(kXsdInteger)}, {"mix_a", std::string(kXsdBoolean)}};
  offered[1].name = "mix";
  offered[1].inputs = {"a"};
  offered[1].input_types = {{"a", DocentIri("Region")}};
  ServiceRegistry registry;
  const absl::StatusOr<std::string> text =
      GenerateDocument({"T", "", {"measure", "mix"}, RobotId()}, offered, registry);
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(registry.Put(Parse(*text)), IsEmpty());
  EXPECT_THAT(registry.Find("T")->inputs, ElementsAre("a", "mix_a", "a2"));
}

TEST(Generator, AnOperationWithoutInputsIsGivenNone) {
  const std::vector<OfferedOperation> offered = TypedOperations();
  ServiceRegistry registry;
  const absl::StatusOr<std::string> text =
      GenerateDocument({"T", "", {"drive", "wave"}, RobotId()}, offered, registry);
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_THAT(registry.Put(Parse(*text)), IsEmpty());
  EXPECT_THAT(registry.Find("T")->inputs, ElementsAre("place"));
  EXPECT_THAT(registry.Find("T")->steps[1].inputs, IsEmpty()) << *text;
}

TEST(Generator, SaysWhatIsNotDescribed) {
  const std::vector<OfferedOperation> offered = TypedOperations();
  ServiceRegistry registry;
  const auto message = [&](const GeneratorRequest& request) {
    return std::string(GenerateDocument(request, offered, registry).status().message());
  };
  EXPECT_THAT(message({"T", "", {"driev"}, RobotId()}), HasSubstr("did you mean drive?"));
  EXPECT_THAT(message({"T", "", {"drive"}, RobotId("urn:r2")}),
              HasSubstr("robot <urn:r2> does not describe operation drive"));
  EXPECT_THAT(message({"T", "", {}, RobotId("urn:r3")}), HasSubstr("there are <urn:r1> and <urn:r2>"));
  EXPECT_THAT(message({" ", "", {"drive"}, RobotId()}), HasSubstr("the name of the document is empty"));
  EXPECT_EQ(GenerateDocument({"T", "", {}, RobotId()}, {}, registry).status().code(),
            absl::StatusCode::kNotFound);
  registry.Put(Parse(*GenerateDocument({"Tour", "tour", {"drive"}, RobotId()}, offered, registry)));
  const absl::StatusOr<std::string> of_service =
      GenerateDocument({"U", "", {"tour", "show"}, RobotId()}, offered, registry);
  ASSERT_TRUE(of_service.ok()) << of_service.status();
  EXPECT_THAT(registry.Put(Parse(*of_service)), IsEmpty());
  EXPECT_THAT(registry.Find("U")->steps, SizeIs(2));
  EXPECT_EQ(registry.Find("U")->steps[0].path, "tour/drive");
}

TEST(ServiceRegistry, AForcedRemovalMakesTheNameAnOperation) {
  ServiceRegistry registry;
  registry.Put(Parse(kLead));
  registry.Put(Parse(kTour));
  EXPECT_EQ(registry.Remove("lead").code(), absl::StatusCode::kFailedPrecondition);
  ASSERT_TRUE(registry.Remove("lead", true).ok());
  EXPECT_EQ(registry.Find("Lead"), nullptr);
  ASSERT_NE(registry.Find("Tour"), nullptr);
  EXPECT_THAT(std::string(registry.Remove("leat").message()),
              HasSubstr("no RSEL document \"leat\" is registered"));
}

}  // namespace
}  // namespace docent::rsel
