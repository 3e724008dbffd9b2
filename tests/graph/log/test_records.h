// Records and folders for the log's tests.
#ifndef DOCENT_TESTS_GRAPH_LOG_TEST_RECORDS_H_
#define DOCENT_TESTS_GRAPH_LOG_TEST_RECORDS_H_

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "graph/log/turn_record.h"

namespace docent::log {

// A folder for one test, removed at the end. A test that opens a log thousands of times uses one in memory,
// where a sync costs nothing.
class TestFolder {
 public:
  enum class Where { kDisk, kMemory };
  explicit TestFolder(Where where = Where::kDisk) {
    const bool in_memory = where == Where::kMemory && access("/dev/shm", W_OK) == 0;
    std::string name = (in_memory ? "/dev/shm" : std::filesystem::temp_directory_path().string());
    name += "/docent_log_test_XXXXXX";
    path_ = mkdtemp(name.data());
  }
  ~TestFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

// A record with a distinct value in every field.
inline TurnRecord FullRecord() {
  const Term robot = Term::Iri("https://w3id.org/docent/expo#R01");
  const Term x = Term::Iri("https://w3id.org/docent#x");
  const Term decimal = {TermKind::kLiteral, "12.345", "http://www.w3.org/2001/XMLSchema#decimal", ""};
  const Term greeting = {TermKind::kLiteral, "Grüezi \"mitenand\"\n", "", "de-ch"};
  const Term text = {TermKind::kLiteral, std::string("cut \0 here", 10), "", ""};
  TurnRecord record;
  record.time_us = 1234567890123456;
  record.engine_version = "0.1.0";
  record.batch.request_id = "request-7";
  record.batch.source = "urn:docent:source:r01";
  record.batch.mode = WriteBatch::Mode::kLoad;
  record.batch.time_us = -5;
  record.batch.lifetime_ms = 30000;
  record.batch.clock_tick = true;
  record.batch.operations = {
      {QuadOperation::Kind::kAdd, {robot, x, decimal, Term{}}},
      {QuadOperation::Kind::kRemove, {Term::Blank("b0"), x, greeting, Term::Iri("urn:g")}},
      {QuadOperation::Kind::kAdd, {robot, x, text, Term::Iri("urn:g")}},
      {QuadOperation::Kind::kRemove, {robot, x, decimal, Term{}}},
  };
  record.batch.readings = {{"urn:sensor:door", text, 77}, {"urn:sensor:beacon", robot, 0}};
  record.batch.documents = {{Document::Kind::kRsel, Document::Action::kRemove, "guide", ""},
                            {Document::Kind::kRules, Document::Action::kPut, "near", "RULE {} WHERE {}"}};
  record.batch.reports = {{CommandId("BoothGuide-1/Move2Booth/0/0/0/0"),
                           CommandReport::Outcome::kFailed,
                           "wheel stuck",
                           0.25,
                           "inc-2",
                           {{"distance", decimal}, {"at", robot}}}};
  record.batch.run_requests = {{RunRequest::Kind::kInvokeService, "BoothGuide", {{"booth", robot}}},
                               {RunRequest::Kind::kCancel, "BoothGuide-1", {}}};
  record.transitions = {{"BoothGuide-1", "", "running", "started"},
                        {"BoothGuide-1/Move2Booth", "waiting", "running", "R01 is at B03"}};
  record.told = {{"BoothGuide-1/Move2Booth", {robot, x, greeting, Term::Iri("urn:docent:run:BoothGuide-1")}}};
  record.commands = {{CommandId("BoothGuide-1/Move2Booth/0/0/0/1"),
                      RobotId("https://w3id.org/docent/expo#R01"),
                      "moveToBooth",
                      {{"booth", robot}, {"speed", decimal}},
                      "inc-2",
                      Revision(41),
                      99887766,
                      true}};
  return record;
}

}  // namespace docent::log

#endif  // DOCENT_TESTS_GRAPH_LOG_TEST_RECORDS_H_
