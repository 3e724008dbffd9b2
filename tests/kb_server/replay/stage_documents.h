// Workflows of the recorded stage that random ones would seldom be: each goes by something that a replay has to know.
#ifndef DOCENT_TESTS_KB_SERVER_REPLAY_STAGE_DOCUMENTS_H_
#define DOCENT_TESTS_KB_SERVER_REPLAY_STAGE_DOCUMENTS_H_

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"

namespace docent::server::test {

inline const std::vector<std::string>& StageWorkflowNames() {
  static const auto* names =
      new std::vector<std::string>{"Seize", "Linger", "Turns", "Watch", "Window", "Parent", "Tree"};
  return *names;
}

inline std::vector<std::string> StageWorkflows() {
  const auto rule = [](const std::string& constraint, const std::string& attributes = "") {
    return absl::StrCat("<context name=\"c\"><rule", attributes, ">", constraint, "</rule></context>");
  };
  const auto fact = [](const std::string& s, const std::string& v, const std::string& o,
                       const std::string& name = "c") {
    return absl::StrCat("<constraint name=\"", name, "\"><subject>", s, "</subject><verb>", v,
                        "</verb><object>", o, "</object></constraint>");
  };
  const auto workflow = [](const std::string& name, const std::string& nodes, const std::string& links,
                           const std::string& activator = "") {
    return absl::StrCat("<CAWL name=\"", name,
                        "\" xmlns:w=\"urn:w:\" xmlns:docent=\"https://w3id.org/docent#\" "
                        "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">",
                        activator, "<flow name=\"", name, "\"><source name=\"s\"/>", nodes,
                        "<sink name=\"t\"/>", links, "</flow></CAWL>");
  };
  const auto link = [](const std::string& from, const std::string& to) {
    return absl::StrCat("<link from=\"", from, "\" to=\"", to, "\"/>");
  };
  const std::string one = link("s", "N") + link("N", "t");
  return {
      // takes away the fact on which it opens, whoever told it
      workflow("Seize",
               absl::StrCat("<node name=\"N\"><condition>", rule(fact("w:Job", "w:is", "w:Ready")),
                            "</condition><ext:withdraw source=\"any\">w:Job w:is w:Ready</ext:withdraw>"
                            "<ext:tell>w:Job w:was w:Seized</ext:tell></node>"),
               one),
      // waits while the way is blocked, and not for long
      workflow("Linger",
               absl::StrCat("<node name=\"N\"><condition ext:timeout=\"6s\">",
                            rule(fact("w:Way", "w:blocked", "true"), " expression=\"not c\" ext:for=\"2s\""),
                            "</condition></node>"),
               one),
      // any robot will do, the one that rested the longest first
      workflow("Turns", "<node name=\"N\"><invoke operation=\"say\"/></node>", one),
      // goes by what other runs do, and starts by itself
      workflow("Watch",
               absl::StrCat("<node name=\"N\"><condition ext:timeout=\"20s\">",
                            rule(fact("?run", "docent:runState", "\"failed\"")),
                            "</condition><ext:tell lifetime=\"5s\">w:Way w:blocked true</ext:tell></node>"),
               one,
               absl::StrCat("<activator name=\"A\"><activate flow=\"Watch\"/><condition>",
                            rule(fact("?robot", "docent:heldBy", "?holder"), " ext:for=\"3s\""),
                            "</condition></activator>")),
      // at times of day
      workflow("Window",
               "<node name=\"N\"><condition ext:timeout=\"30s\"><context><ext:time "
               "between=\"22:13-22:14\"/></context>"
               "</condition></node><node name=\"M\"><condition ext:timeout=\"30s\"><context><ext:time "
               "after=\"7s\"/>"
               "</context></condition></node>",
               link("s", "N") + link("N", "M") + link("M", "t")),
      // of sub-flows that may be undeployed, paused or disabled
      workflow("Parent",
               absl::StrCat("<node name=\"N\"><invoke subflow=\"Seize\"/></node><node name=\"M\" "
                            "ext:onFailure=\"incident\">"
                            "<condition ext:timeout=\"20s\">",
                            rule(fact("w:Door", "w:is", "w:Open")),
                            "</condition><invoke subflow=\"Turns\"/></node>"),
               link("s", "N") + link("N", "M") + link("M", "t")),
      // once for each, with what undoes it
      workflow(
          "Tree",
          absl::StrCat("<node name=\"N\" ext:forEach=\"?who\" ext:compensate=\"wave\"><condition>",
                       rule(fact("?who", "w:wants1", "?what")),
                       "</condition><invoke operation=\"drive\" ext:retry=\"1\" ext:timeout=\"9s\"/></node>"
                       "<node name=\"M\"><condition ext:timeout=\"12s\">",
                       rule(fact("w:Job", "w:was", "w:Seized")),
                       "</condition><invoke operation=\"show\"/></node>"),
          link("s", "N") + link("N", "M") + link("M", "t")),
  };
}

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_REPLAY_STAGE_DOCUMENTS_H_
