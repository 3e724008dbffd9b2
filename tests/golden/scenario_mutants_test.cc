// Scenarios with one mistake each: `check` finds it, at its line. And nothing is found where there is no mistake.
#include "tests/golden/documents_in_tree.h"
#include "tests/golden/scenario_check.h"

namespace docent::golden {
namespace {

constexpr char kGuide[] = "scenarios/s01_booth_guide/booth_guide.cawl.xml";
constexpr char kServices[] = "scenarios/s01_booth_guide/booth_guide.rsel.xml";
constexpr char kTour[] = "scenarios/s04_museum_day/tour.cawl.xml";
constexpr char kJohn[] = "scenarios/s03_johns_service/johns_service.cawl.xml";
constexpr char kTalk[] = "scenarios/s03_johns_service/talk.rsel.xml";
constexpr char kDelivery[] = "scenarios/s05_hospital_round/delivery.cawl.xml";
constexpr char kNight[] = "scenarios/s05_hospital_round/night_round.cawl.xml";
constexpr char kCare[] = "scenarios/s05_hospital_round/care.rsel.xml";
constexpr char kDoors[] = "scenarios/s02_real_robot_log/s02.cawl.xml";

struct Mutant {
  const char* file;
  const char* after;  // the change is made behind this text; empty: at the first place
  const char* from;
  const char* to;
  const char* message;  // part of what is said
  const char* at =
      "";  // stands in the line where it is said, in what became of the file; empty: the line of the change
};

const Mutant kMutants[] = {
    // ---- s01, the workflow: elements and attributes
    {kGuide, "", "<CAWL name=\"BoothGuide\"", "<CAWL", "needs the attribute name"},
    {kGuide, "<CAWL", "version=", "vresion=", "unknown attribute vresion"},
    {kGuide, "", "<ontology location", "<ontologi location", "unknown element <ontologi>"},
    {kGuide, "", "<service operation=\"briefInformation\"", "<servce operation=\"briefInformation\"",
     "unknown element <servce>"},
    {kGuide, "", "<activate flow=", "<activate flows=", "unknown attribute flows"},
    {kGuide, "", "priority=\"1\"", "priority=\"first\"", "is not a whole number"},
    {kGuide, "", "<source name=\"Arrived\"", "<source nme=\"Arrived\"", "unknown attribute nme"},
    {kGuide, "", "state=\"deActivate\"", "state=\"deactivate\"", "state \"deactivate\" is unknown"},
    {kGuide, "<node", "<invoke operation=\"moveToUser\"", "<invoke operaton=\"moveToUser\"",
     "unknown attribute operaton"},
    {kGuide, "", "<sink name=\"Presented\"/>", "", "<flow> has no <sink", "<flow name=\"BoothGuide\">"},
    {kGuide, "", "</flow>", "</flows>", "XML:"},
    {kGuide, "", "expo:BoothGuideService</object>", "expo:BoothGuideService</objekt>", "XML:"},
    {kGuide, "", "<documentation>One", "One <documentation>", "text in <activator>"},
    {kGuide, "", "<node name=\"Move2Booth\"", "<node name=\"Move2Booth\" ext:timeout=\"soon\"",
     "is not a duration"},
    // ---- names
    {kGuide, "", "<activate flow=\"BoothGuide\"", "<activate flow=\"BoothGiude\"",
     "there is no flow BoothGiude"},
    {kGuide, "", "<variable name=\"user\"", "<variable name=\"usr\"", "variable $user is not declared",
     "<subject>$user</subject>"},
    {kGuide, "", "<node name=\"Move2User\"", "<node name=\"Move2Booth\"", "node Move2Booth stands twice",
     "<node name=\"Move2Booth\" state=\"deActivate\">\n      <documentation>The robot has come"},
    {kGuide, "", "<node name=\"InfoBooth\"", "<node name=\"InfoBoth\"", "there is no node InfoBooth",
     "<link from=\"Move2Booth\" to=\"InfoBooth\"/>"},
    {kGuide, "", "<source name=\"Arrived\"", "<source name=\"Arived\"", "there is no node Arrived",
     "<link from=\"Arrived\""},
    {kGuide, "", "<subject>$user</subject>", "<subject>$usr</subject>", "variable $usr is not declared"},
    {kGuide, "", "?userRegion", "?user-Region", "is not a variable's name"},
    {kGuide, "", "<rule name=\"selection\"", "<rule name=\"together\"", "rule together stands twice"},
    {kGuide, "", "robotThere and userThere", "robotThere and userTher", "the expression names userTher"},
    {kGuide, "", "robotThere and userThere", "robotThere and", "expression"},
    {kGuide, "", "robotThere and userThere", "robotThere", "userThere is not in the expression",
     "<constraint name=\"userThere\">"},
    {kGuide, "", "<invoke operation=\"moveToUser\"", "<invoke subflow=\"moveToUser\"",
     "there is no flow or deployed workflow moveToUser"},
    // ---- links
    {kGuide, "", "to=\"Move2User\"", "to=\"Move2Usr\"", "there is no node Move2Usr"},
    {kGuide, "", "<link from=\"Move2User\" to=\"Move2Booth\"/>", "", "node Move2User has no path to the sink",
     "<node name=\"Move2User\""},
    {kGuide, "", "<link from=\"Arrived\" to=\"Move2User\"/>", "<link from=\"Arrived\" to=\"Move2Booth\"/>",
     "node Move2User cannot be reached", "<node name=\"Move2User\""},
    {kGuide, "", "<link from=\"InfoBooth\" to=\"Presented\"/>", "<link from=\"InfoBooth\" to=\"Move2User\"/>",
     "node InfoBooth has no path to the sink", "<node name=\"InfoBooth\""},
    {kGuide, "", "<link from=\"InfoBooth\" to=\"Presented\"/>",
     "<link from=\"InfoBooth\" to=\"Presented\"/><link from=\"InfoBooth\" to=\"Move2User\"/>",
     "cycle without while"},
    {kGuide, "", "<link from=\"InfoBooth\" to=\"Presented\"/>",
     "<link from=\"InfoBooth\" to=\"Presented\"/><link from=\"InfoBooth\" to=\"Presented\"/>",
     "a second link"},
    {kGuide, "", "<link from=\"Arrived\"", "<link from=\"Presented\"", "is the sink"},
    // ---- words
    {kGuide, "", "xmlns:expo=", "xmlns:exp=", "unknown prefix expo:", "<object>expo:BoothGuideService"},
    {kGuide, "", "docent:chose", "docen:chose", "unknown prefix docen:"},
    {kGuide, "", "docent:chose", "docent:chosen", "the ontology has no property"},
    {kGuide, "", "type=\"docent:Visitor\">?user", "type=\"docent:Vistor\">?user",
     "the ontology has no class"},
    {kGuide, "", "docent:Standby", "docent:StandBy", "the ontology has no word"},
    {kGuide, "", "docent:status", "docent:staus", "the ontology has no property"},
    {kGuide, "", "docent:localised", "docent:localized", "the ontology has no property"},
    {kGuide, "", "type=\"docent:Booth\">?booth", "type=\"docent:Both\">?booth", "the ontology has no class"},
    {kGuide, "", "<variable name=\"robot\" type=\"docent:Robot\"",
     "<variable name=\"robot\" type=\"docent:Roboter\"", "the ontology has no class"},
    {kGuide, "<node", "docent:isAt", "docent:isat", "the ontology has no property"},
    // ---- operations
    {kGuide, "", "<service operation=\"moveToUser\"", "<service operation=\"moveToUsr\"",
     "no robot offers operation moveToUsr"},
    {kGuide, "<node", "<invoke operation=\"moveToUser\"", "<invoke operation=\"moveToUsers\"",
     "no robot offers operation moveToUsers"},
    {kGuide, "", "<invoke operation=\"displayInformation\"", "<invoke operation=\"briefInformation\"",
     "invokes briefInformation twice at the same time",
     "<invoke operation=\"briefInformation\"/>\n    </node>"},
    // ---- types, and what never or always holds
    {kGuide, "", "<object>expo:BoothGuideService", "<object>\"BoothGuideService\"",
     "are resources, and this is a literal"},
    {kGuide, "", "<object>true", "<object>\"true\"", "are of xsd:boolean"},
    {kGuide, "", "<object>true", "<object>1", "are of xsd:boolean"},
    {kGuide, "", "<object>true", "<object>docent:Standby", "are literals, and this is a resource"},
    {kGuide, "", "type=\"docent:Visitor\">?user", "type=\"docent:Robot\">?user", "which are disjoint"},
    {kGuide, "", "<variable name=\"user\" type=\"docent:Visitor\"",
     "<variable name=\"user\" type=\"docent:Robot\"", "takes user of docent:Visitor",
     "<invoke operation=\"moveToUser\"/>"},
    {kGuide, "", "<variable name=\"booth\" type=\"docent:Booth\"",
     "<variable name=\"booth\" type=\"xsd:string\"", "takes booth of docent:Booth",
     "<invoke operation=\"moveToBooth\"/>"},
    {kGuide, "\"together\"", "docent:isAt", "docent:x", "?meeting would have to be a literal",
     "<object>?meeting</object>\n            </constraint>\n          </rule>"},
    {kGuide, "\"robotAt\"", "docent:isAt", "docent:chose", "$robot would have to be",
     "<subject>$robot</subject>\n              <verb>docent:chose"},
    {kGuide, "", "robotThere and userThere", "robotThere and userThere and not robotThere",
     "to hold and not to hold", "<constraint name=\"robotThere\">"},
    {kGuide, "", "robotThere and userThere", "robotThere or userThere or not robotThere", "always holds"},
    {kGuide, "", "type=\"docent:Booth\">?booth", "type=\"docent:Booth\">?boot",
     "variable booth is never set before", "<invoke operation=\"moveToBooth\"/>"},
    {kGuide, "", "<condition>", "<condition ext:timeout=\"1min\">", "an activator waits for ever"},
    {kGuide, "", "<invoke operation=\"moveToBooth\"",
     "<invoke operation=\"moveToBooth\" ext:timeout=\"1min\"", "the timeout of step moveToBooth"},
    // ---- s01, the robot services
    {kServices, "", "<rsel name=", "<rsel nam=", "unknown attribute nam"},
    {kServices, "", "type=\"docent:Visitor\"", "type=\"docnt:Visitor\"", "unknown prefix docnt:"},
    {kServices, "", "input=\"UserRequest\"", "input=\"UserReqest\"", "there is no message UserReqest"},
    {kServices, "", "<invoke operation=", "<invoke operaton=", "unknown attribute operaton"},
    {kServices, "", "ext:timeout=\"5min\"", "ext:timeout=\"5minutes\"", "is not a duration"},
    {kServices, "", "ext:retry=\"1\"", "ext:retry=\"one\"", "is not a number of further attempts"},
    {kServices, "", "from=\"user\"", "from=\"usr\"", "nothing gives usr"},
    {kServices, "", " from=\"user\"", "", "needs either from or value"},
    {kServices, "", "<process name=\"moveToBooth\"", "<process name=\"moveToUser\"",
     "process moveToUser stands twice"},
    {kServices, "", "ext:timeout=\"30s\"", "timeout=\"30s\"", "unknown attribute timeout"},
    {kServices, "", "<message name=\"GuideRequest\"", "<message name=\"BoothRequest\"",
     "message BoothRequest stands twice"},
    {kServices, "\"GuideRequest\"", "<part name=\"booth\"", "<part name=\"bouth\"", "booth",
     "<invoke operation=\"moveToBooth\"/>"},
    {kServices, "", "rsel-ext#", "cawl-ext#", "which has no attributes here", "ext:timeout=\"5min\""},
    {kServices, "\"BoothGuide\" input", "<invoke operation=\"moveToBooth\"",
     "<invoke ext:parallel=\"true\" operation=\"moveToUser\"", "twice at the same time"},
    // ---- s02
    {kDoors, "", "<activate flow=\"EastDoors\"", "<activate flow=\"EastDoor\"", "there is no flow EastDoor"},
    {kDoors, "", "docent:Robot\">?robot", "docent:Robots\">?robot", "the ontology has no class"},
    {kDoors, "", "docent:isAt", "docent:isAtt", "the ontology has no property"},
    {kDoors, "", "<object>s02:EastDoors", "<object>s2:EastDoors", "unknown prefix s2:"},
    {kDoors, "", "<object>s02:EastDoors", "<object>\"EastDoors\"", "are resources, and this is a literal"},
    {kDoors, "", "<variable name=\"robot\" type=\"docent:Robot\"",
     "<variable name=\"robot\" type=\"docent:Visitor\"", "$robot would have to be",
     "<subject>$robot</subject>"},
    {kDoors, "", "<object>true", "<object>tru", "neither a resource nor a literal"},
    {kDoors, "", "to=\"Seen\"", "to=\"Sean\"", "there is no node Sean"},
    {kDoors, "", "<node name=\"Arrived\"", "<node name=\"Arrived\" ext:timeout=\"1min\"",
     "prefix ext: of attribute timeout is not declared"},
    {kDoors, "", "docent:Region\">?region", "docent:Regoin\">?region", "the ontology has no class"},
    {kDoors, "", "<sink name=\"Seen\"", "<sink name=\"Entered\"", "source and sink have the same name"},
    // ---- s04
    {kTour, "name=\"Choose\"", "museum:toSee", "museum:toSe", "the ontology has no property"},
    {kTour, "", "Show or Lost or HandOver", "Show or Last or HandOver", "joinCondition names Last"},
    {kTour, "name=\"Meet\"", "<invoke operation=\"meetGroup\"", "<invoke operation=\"meetGruop\"",
     "meetGruop"},
    {kTour, "", "<object>museum:GuideRequest", "<object>museum:GuideRequst", "the ontology has no"},
    {kTour, "", "from=\"Lost\" to=\"Wait\" ext:while=\"$request museum:toSee ?more\"",
     "from=\"Lost\" to=\"Wait\"", "a cycle without while"},
    {kDoors, "", "<context name=\"Entered\"", "<contxt name=\"Entered\"", "XML:", "</context>"},
    // ---- s03
    {kJohn, "", "<invoke subflow=\"BoothGuide\"", "<invoke subflow=\"BoothGiude\"",
     "there is no flow or deployed workflow BoothGiude"},
    {kJohn, "", "<link from=\"Answer\" to=\"NoAnswer\"", "<link from=\"Answer\" to=\"NoAnswr\"",
     "there is no node NoAnswr"},
    {kJohn, "", "docent:suits", "docent:suit", "the ontology has no property"},
    {kJohn, "", "expression=\"$places - 1\"", "expression=\"$plces - 1\"", "plces"},
    {kJohn, "", "$user docent:hasSeen $shown", "$user docent:hasSeen $show", "variable $show"},
    {kJohn, "", "variable=\"guide\"/>\n      </invoke>", "variable=\"gide\"/>\n      </invoke>", "gide"},
    {kJohn, "", "ext:while=\"$user docent:wouldSee", "ext:while=\"$user docent:wouldsee",
     "the ontology has no property"},
    {kTalk, "", "from=\"text\"", "from=\"txt\"", "nothing gives txt"},
    // ---- s05
    {kDelivery, "", "ext:compensate=\"bringBack\"", "ext:compensate=\"bringBak\"",
     "no robot offers operation bringBak"},
    {kDelivery, "", "ext:onFailure=\"incident\"", "ext:onFailure=\"incidents\"", "incidents"},
    {kDelivery, "<case name=\"answered\"", "taken or refused", "taken or refusd",
     "the expression names refusd"},
    {kDelivery, "", "<verb>care:via", "<verb>care:vai", "the ontology has no property"},
    {kDelivery, "", "ext:while=\"?floor care:isQuiet true\"", "ext:while=\"?floor care:isQuiet 1\"",
     "are of xsd:boolean"},
    {kDelivery, "", "SELECT ?receiver", "SELECT ?reciever", "reciever"},
    {kNight, "", "at=\"02:30\"", "at=\"25:30\"", "25:30"},
    {kNight, "", "Europe/Zurich", "Europe/Zürich", "Europe/Zürich"},
    {kCare, "", "from=\"via\"", "from=\"way\"", "nothing gives way"},
};
static_assert(std::size(kMutants) >= 60);

size_t LineOf(const std::string& text, size_t offset) {
  return 1 + static_cast<size_t>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(offset), '\n'));
}

class ScenarioMutants : public testing::TestWithParam<Mutant> {};

TEST_P(ScenarioMutants, AreFoundAtTheirLine) {
  const Mutant& mutant = GetParam();
  std::string text = ReadFile(InTree(mutant.file));
  const size_t after = text.find(mutant.after);
  ASSERT_NE(after, std::string::npos);
  const size_t place = text.find(mutant.from, after);
  ASSERT_NE(place, std::string::npos);
  text.replace(place, std::string_view(mutant.from).size(), mutant.to);
  const std::string_view at = mutant.at;
  const size_t told = at.empty() ? place : text.find(at);
  ASSERT_NE(told, std::string::npos);
  const Diagnostics diagnostics = CheckScenarioFile(mutant.file, text);
  const bool found = std::any_of(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& d) {
    return static_cast<size_t>(d.span.line) == LineOf(text, told) &&
           d.message.find(mutant.message) != std::string::npos;
  });
  EXPECT_TRUE(found) << "line " << LineOf(text, told) << ": " << mutant.from << " -> " << mutant.to << "\n"
                     << Render(diagnostics, text);
}

INSTANTIATE_TEST_SUITE_P(All, ScenarioMutants, testing::ValuesIn(kMutants),
                         [](const auto& info) { return std::to_string(info.index); });

TEST(Scenarios, NothingIsFoundInThem) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(InTree("scenarios"))) {
    const std::string file = std::filesystem::relative(entry.path(), InTree(".")).string();
    if (!file.ends_with(".cawl.xml") && !file.ends_with(".rsel.xml")) continue;
    const std::string text = ReadFile(entry.path());
    const Diagnostics diagnostics = CheckScenarioFile(file, text);
    EXPECT_TRUE(diagnostics.empty()) << file << "\n" << Render(diagnostics, text);
  }
}

// A document stands for itself there: the robots that it needs are not described.
TEST(Scenarios, NothingIsFoundInTheDocumentation) {
  const cawl::QuadEnvironment ontologies = Ontologies(
      {"scenarios/s01_booth_guide", "scenarios/s03_johns_service", "scenarios/s05_hospital_round"});
  for (const TreeDocument& document : DocumentsInTree("CAWL")) {
    if (!document.shipped) continue;
    for (const cawl::QuadEnvironment* environment :
         {static_cast<const cawl::QuadEnvironment*>(nullptr), &ontologies}) {
      Diagnostics diagnostics = cawl::CheckDocument(document.text, "f", environment).diagnostics;
      std::erase_if(diagnostics, [](const Diagnostic& d) { return d.rule == "unknown-operation"; });
      EXPECT_TRUE(diagnostics.empty()) << document.place << "\n" << Render(diagnostics, document.text);
    }
  }
  for (const TreeDocument& document : DocumentsInTree("rsel")) {
    if (!document.shipped) continue;
    const Diagnostics diagnostics = rsel::ParseRsel(document.text, "f").diagnostics;
    EXPECT_TRUE(diagnostics.empty()) << document.place << "\n" << Render(diagnostics, document.text);
  }
}

}  // namespace
}  // namespace docent::golden
