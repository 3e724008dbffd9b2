// A small world for the tests of kb_server: one place with a door sensor, a rule, a robot service and a
// workflow that greets visitors. Terms are of the namespace urn:w: unless they are docent's.
#ifndef DOCENT_TESTS_KB_SERVER_TEST_WORLD_H_
#define DOCENT_TESTS_KB_SERVER_TEST_WORLD_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/write_batch.h"

namespace docent::server::test {

// "a" → rdf:type, "docent:x" → that property, an absolute IRI as it is, anything else → urn:w:…
inline std::string Name(const std::string& word) {
  if (word == "a") return std::string(kRdfType);
  if (word.rfind("docent:", 0) == 0) return DocentIri(word.substr(7));
  if (word.rfind("urn:", 0) == 0 || word.rfind("http", 0) == 0) return word;
  return "urn:w:" + word;
}
inline Term Iri(const std::string& word) {
  return Term::Iri(Name(word));
}

inline TermQuad Fact(const std::string& subject, const std::string& predicate, Term object) {
  return {Iri(subject), Iri(predicate), std::move(object), Term()};
}
inline TermQuad Fact(const std::string& subject, const std::string& predicate, const std::string& object) {
  return Fact(subject, predicate, Iri(object));
}

inline WriteBatch Tell(const std::vector<TermQuad>& add, const std::vector<TermQuad>& remove = {}) {
  WriteBatch batch;
  for (const TermQuad& quad : remove) batch.operations.push_back({QuadOperation::Kind::kRemove, quad});
  for (const TermQuad& quad : add) batch.operations.push_back({QuadOperation::Kind::kAdd, quad});
  return batch;
}

inline WriteBatch Put(Document::Kind kind, const std::string& name, const std::string& text) {
  WriteBatch batch;
  batch.documents.push_back({kind, Document::Action::kPut, name, text});
  return batch;
}

inline WriteBatch Start(const std::string& workflow,
                        std::vector<std::pair<std::string, Term>> arguments = {}) {
  WriteBatch batch;
  batch.run_requests.push_back({RunRequest::Kind::kStart, workflow, std::move(arguments)});
  return batch;
}

inline WriteBatch Report(const CommandId& command, CommandReport::Outcome outcome) {
  WriteBatch batch;
  batch.reports.push_back({command, outcome, "", 1, "i1", {}});
  return batch;
}

// Robots on standby that offer one operation.
inline std::vector<TermQuad> FreeRobots(const std::vector<std::string>& robots,
                                        const std::string& operation) {
  std::vector<TermQuad> facts = {Fact("docent:status", "a", "docent:StateProperty")};
  for (const std::string& robot : robots) {
    facts.push_back(Fact(robot, "a", "docent:Robot"));
    facts.push_back(Fact(robot, "docent:incarnation", Term::Literal("i1")));
    facts.push_back(Fact(robot, "docent:status", "docent:Standby"));
    facts.push_back(Fact(robot, "docent:offers", "urn:docent:operation:" + operation));
  }
  return facts;
}

// State properties, a robot that offers "greet", and the mapping of the door sensor's readings.
inline WriteBatch WorldFacts() {
  WriteBatch batch = Tell({
      Fact("docent:isAt", "a", "docent:StateProperty"),
      Fact("docent:status", "a", "docent:StateProperty"),
      Fact("R1", "a", "docent:Robot"),
      Fact("R1", "docent:incarnation", Term::Literal("i1")),
      Fact("R1", "docent:status", "docent:Standby"),
      Fact("R1", "docent:offers", "urn:docent:operation:greet"),
      Fact("R1", "docent:isAt", "Hall"),
      Fact("DoorMapping", "docent:forSensor", "Door"),
      Fact("DoorMapping", "docent:subject", "docent:readingValue"),
      Fact("DoorMapping", "docent:predicate", "docent:isAt"),
      Fact("DoorMapping", "docent:object", "Hall"),
      Fact("DoorMapping", "docent:valueMeaning", "Tag17"),
      Fact("Tag17", "docent:readingValue", Term::Literal("tag-17")),
      Fact("Tag17", "docent:means", "John"),
  });
  batch.request_id = "world";
  return batch;
}

inline WriteBatch Reading(const std::string& value) {
  WriteBatch batch;
  batch.readings.push_back({Name("Door"), Term::Literal(value), 0});
  return batch;
}

inline constexpr char kRules[] = R"(PREFIX docent: <https://w3id.org/docent#>
RULE { ?person docent:isNear ?robot } WHERE {
  ?person docent:isAt ?region . ?robot a docent:Robot ; docent:isAt ?region . FILTER(?person != ?robot)
}
)";

// One node that waits until a visitor is near the robot (a derived fact), and one that waits until the
// visitor is glad.
inline constexpr char kGreeting[] = R"(<?xml version="1.0"?>
<CAWL name="Greeting" namespace="urn:w:" version="1.0" xmlns:docent="https://w3id.org/docent#">
  <flow name="Greet">
    <variable name="person"/>
    <source name="start"/>
    <node name="Hello">
      <condition><context name="Near"><rule name="near"><constraint name="near">
        <subject>?person</subject><verb>docent:isNear</verb><object>?robot</object>
      </constraint></rule></context></condition>
      <invoke operation="greet"/>
    </node>
    <node name="Goodbye">
      <condition><context name="Glad"><rule name="glad"><constraint name="glad">
        <subject>$person</subject><verb>docent:feels</verb><object>docent:Glad</object>
      </constraint></rule></context></condition>
      <invoke operation="greet"/>
    </node>
    <sink name="end"/>
    <link from="start" to="Hello"/>
    <link from="Hello" to="Goodbye"/>
    <link from="Goodbye" to="end"/>
  </flow>
</CAWL>
)";

// The same, started by a caller: one run for each caller.
inline constexpr char kCalled[] = R"(<?xml version="1.0"?>
<CAWL name="Called" namespace="urn:w:" version="1.0" xmlns:docent="https://w3id.org/docent#">
  <activator name="OnCall">
    <activate flow="Come"/>
    <condition><context name="Call"><rule name="calls"><constraint name="calls">
      <subject>?person</subject><verb>docent:calls</verb><object>?robot</object>
    </constraint></rule></context></condition>
  </activator>
  <flow name="Come">
    <variable name="person"/>
    <variable name="robot"/>
    <source name="start"/>
    <node name="Hello"><invoke operation="greet"/></node>
    <sink name="end"/>
    <link from="start" to="Hello"/>
    <link from="Hello" to="end"/>
  </flow>
</CAWL>
)";

inline constexpr char kServices[] = R"(<?xml version="1.0"?>
<rsel name="Services" namespace="urn:w:" version="1.0">
  <process name="greetTwice">
    <invoke operation="greet"/>
    <invoke operation="greet"/>
  </process>
</rsel>
)";

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TEST_WORLD_H_
