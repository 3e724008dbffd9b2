#include "kb_server/cli/table.h"

#include <stdlib.h>

#include "gtest/gtest.h"

namespace docent::server {
namespace {

Table Robots() {
  Table table({"robot", "state"});
  table.Add({"expo:R01", "busy"});
  table.Add({"expo:展示", {"offline", Style::kFaint}});
  return table;
}

TEST(TableTest, ColumnsAreAlignedByWhatTheyTakeOnATerminal) {
  EXPECT_EQ(Robots().Render({}),
            "robot      state\n"
            "---------  -------\n"
            "expo:R01   busy\n"
            "expo:展示  offline\n");
}

TEST(TableTest, OnlyATerminalWithColoursGetsThem) {
  Terminal terminal;
  terminal.colours = true;
  const std::string text = Robots().Render(terminal);
  EXPECT_NE(text.find("\x1b[1mrobot\x1b[0m"), std::string::npos);
  EXPECT_NE(text.find("\x1b[2moffline\x1b[0m"), std::string::npos);
  EXPECT_EQ(Robots().Render({}).find('\x1b'), std::string::npos);
}

TEST(TableTest, TheWidestColumnsGiveWayToTheTerminal) {
  Table table({"run", "reason"});
  table.Add({"BoothGuide-1", "the robot did not answer within 300 s and its command was cancelled"});
  Terminal terminal;
  terminal.columns = 40;
  EXPECT_EQ(table.Render(terminal),
            "run           reason\n"
            "------------  --------------------------\n"
            "BoothGuide-1  the robot did not answer …\n");
}

TEST(TableTest, ATerminalThatIsTooNarrowKeepsColumnsReadable) {
  Table table({"a", "b"});
  table.Add({"123456789012345", "123456789012345"});
  Terminal terminal;
  terminal.columns = 5;
  EXPECT_EQ(table.Render(terminal),
            "a         b\n"
            "--------  --------\n"
            "1234567…  1234567…\n");
}

Table Wide() {
  Table table({"robot", "state", "pose", "held by", "adapter"});
  table.Add({"expo:Robot-17", "standby", "3.10, 4.20 m, 0.00 rad", "", "127.0.0.1:7401"});
  table.KeepWhole({0, 1});
  return table;
}

TEST(TableTest, WhatIsToStayWholeStaysWholeAndWhatIsEmptyGoes) {
  Terminal terminal;
  terminal.columns = 50;
  EXPECT_EQ(Wide().Render(terminal),
            "robot          state    pose          adapter\n"
            "-------------  -------  ------------  ------------\n"
            "expo:Robot-17  standby  3.10, 4.20 …  127.0.0.1:7…\n");
  terminal.columns = 0;
  EXPECT_NE(Wide().Render(terminal).find("held by"), std::string::npos) << "there is room";
}

TEST(TableTest, TheLastColumnsGoWhereThereIsNoRoomForThem) {
  Terminal terminal;
  terminal.columns = 34;
  EXPECT_EQ(Wide().Render(terminal),
            "robot          state    pose  …\n"
            "-------------  -------  ----------\n"
            "expo:Robot-17  standby  3.10, 4.2…\n");
}

TEST(TableTest, EmptyCellsLeaveNoTrailingBlanks) {
  Table table({"a", "b", "c"});
  table.Add({"1", "", "3"});
  table.Add({"1", "", ""});
  EXPECT_EQ(table.Render({}), "a  b  c\n-  -  -\n1     3\n1\n");
}

TEST(TableTest, ACellStaysOnItsLine) {
  Table table({"a"});
  table.Add({"two\nlines\x1b[2J"});
  EXPECT_EQ(table.Render({}), "a\n-------------\ntwo lines�[2J\n");
}

TEST(TerminalTest, ColoursAreForTerminalsUnlessTheyAreAskedFor) {
  unsetenv("NO_COLOR");
  EXPECT_FALSE(Terminal::OfOutput("never").colours);
  EXPECT_TRUE(Terminal::OfOutput("always").colours);
  setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(Terminal::OfOutput("auto").colours);
  EXPECT_TRUE(Terminal::OfOutput("always").colours);  // a flag says more than an environment
  unsetenv("NO_COLOR");
}

}  // namespace
}  // namespace docent::server
