#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "graph/base/gzip.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/formats/parser.h"
#include "kb_server/replay/case_file.h"
#include "kb_server/replay/json_place.h"
#include "kb_server/replay/saved_words.h"

namespace docent::server {
namespace {

using Json = nlohmann::ordered_json;

// The format version whose files have facts, changes of facts, and which robots others held, in place of a state and batches.
constexpr uint64_t kOfWorlds = 1;

class Decoder {
 public:
  Decoder(const std::string& file, const ReplayLimits& limits) : file_(file), limits_(limits) {}

  absl::StatusOr<RunCase> Decode(const std::string& text) {
    Json json;
    try {
      json = Json::parse(text);
    } catch (const nlohmann::json::exception& error) {
      return absl::InvalidArgumentError(absl::StrCat(file_, " is no saved run, or damaged: ", error.what(),
                                                     "; save the run again with `docent runs save`"));
    }
    const JsonPlace root(&json, "", &wrong_);
    if (!json.is_object() || json.value("format", Json()) != kCaseFormat) {
      return absl::InvalidArgumentError(absl::StrCat(file_, " is no saved run: it has no \"format\": \"",
                                                     kCaseFormat,
                                                     "\"; `docent runs save` makes such a file"));
    }
    const uint64_t version = root.At("formatVersion").Number();
    if (wrong_.ok() && version > kCaseVersion) {
      return absl::InvalidArgumentError(absl::StrCat(file_, " is of format version ", version,
                                                     ", and this program reads up to ", kCaseVersion,
                                                     "; use the newer docent that saved it"));
    }
    version_ = version;
    RunCase saved = ReadCase(root);
    if (wrong_.ok()) return saved;
    return absl::Status(wrong_.code(), absl::StrCat(file_, ": ", wrong_.message(),
                                                    "; save the run again with `docent runs save`"));
  }

 private:
  RunCase ReadCase(const JsonPlace& root) {
    RunCase saved;
    const JsonPlace run = root.At("run");
    saved.run = RunId(run.At("id").Text());
    saved.number = run.At("number").Number();
    saved.workflow = run.At("workflow").Text();
    saved.flow = run.At("flow").Text();
    saved.asked = run.At("startedBy").Text() == "request";
    saved.values = ReadValues(run.At("values"));
    saved.last_turn = run.At("lastTurn").Number();
    saved.ended = run.At("ended").IsTrue();
    saved.document = ReadDocument(root.At("document"));
    if (version_ == kOfWorlds) {
      for (const JsonPlace& document : root.At("documents").Items())
        saved.documents.push_back(ReadDocument(document));
      saved.facts = ReadFacts(root.At("facts"));
      saved.held = ReadHolds(root.At("held"));
    } else {
      for (const auto& [run, path] : root.At("nested").Members()) saved.nested[RunId(run)] = path.Text();
      saved.state = ReadPacked(root.At("state"));
    }
    for (const JsonPlace& turn : root.At("turns").Items()) ReadTurn(turn, &saved);
    if (saved.turns.empty()) root.At("turns").Wrong("has no turn");
    const JsonPlace course = root.At("course");
    for (const JsonPlace& decision : course.At("decisions").Items())
      saved.course.decisions.push_back(ReadDecision(decision));
    saved.course.state = course.At("state").Text();
    saved.course.reason = course.At("reason").TextOr("");
    for (auto& [name, value] : ReadValues(course.At("variables")))
      saved.course.variables.emplace(name, value);
    for (auto& [name, value] : ReadValues(course.At("results"))) saved.course.results.emplace(name, value);
    return saved;
  }

  Document ReadDocument(const JsonPlace& place) {
    Document document;
    document.kind = ReadWord<Document::Kind>(place.At("kind"));
    document.name = place.At("name").Text();
    if (place.At("removed").IsTrue()) document.action = Document::Action::kRemove;
    document.text = place.At("text").Lines();
    return document;
  }

  template <typename Value>
  Value ReadWord(const JsonPlace& place) {
    const std::string word = place.Text();
    const std::optional<Value> value = ValueOfWord<Value>(word);
    if (!value) place.Wrong(absl::StrCat("is \"", word, "\", which means nothing here"));
    return value.value_or(Value());
  }

  TimeMicros ReadTime(const JsonPlace& place) {
    const std::string text = place.Text();
    const TimeMicros time_us = MicrosOfDateTime(text);
    if (time_us == 0) place.Wrong(absl::StrCat("is \"", text, "\", no time like 2026-01-31T12:00:00Z"));
    return time_us;
  }

  // `signed_lines`: "+ " or "- " stands before each.
  std::vector<TermQuad> ReadFacts(const JsonPlace& place, bool signed_lines = false) {
    if (!wrong_.ok()) return {};
    std::string text;
    const std::vector<JsonPlace> lines = place.Items();
    if ((facts_ += lines.size()) > limits_.replay_facts) {
      wrong_ = absl::ResourceExhaustedError(
          absl::StrCat("it has more than ", limits_.replay_facts, " facts; the limit is replay_facts"));
      return {};
    }
    for (const JsonPlace& line : lines) {
      std::string fact = line.Text();
      if (signed_lines && !fact.starts_with("+ ") && !fact.starts_with("- "))
        line.Wrong("begins neither with \"+ \" nor with \"- \"");
      absl::StrAppend(&text, signed_lines ? fact.substr(std::min<size_t>(2, fact.size())) : fact, "\n");
    }
    if (!wrong_.ok()) return {};
    ParseRdfOptions options;
    options.file = place.place();
    ParsedRdf parsed = ParseRdf(text, RdfFormat::kNQuads, options);
    if (!parsed.ok()) {
      const SourceSpan span = parsed.diagnostics.empty() ? SourceSpan() : parsed.diagnostics.front().span;
      place.Wrong(absl::StrCat("has no fact in N-Quads at [", span.line - 1,
                               "]: ", parsed.diagnostics.empty() ? "" : parsed.diagnostics.front().message));
      return {};
    }
    if (parsed.quads.size() != lines.size()) place.Wrong("has not one fact a line");
    return std::move(parsed.quads);
  }

  Term ReadTerm(const JsonPlace& place) {
    const std::string text = place.Text();
    if (!wrong_.ok()) return Term();
    ParsedRdf parsed = ParseRdf(absl::StrCat("<urn:s> <urn:p> ", text, " .\n"), RdfFormat::kNQuads);
    if (parsed.ok() && parsed.quads.size() == 1) return std::move(parsed.quads[0].object);
    place.Wrong(absl::StrCat("is ", text, ", no term of N-Triples such as <urn:a> or \"1\"^^<…#integer>"));
    return Term();
  }

  NamedTerms ReadValues(const JsonPlace& place) {
    NamedTerms values;
    for (const auto& [name, value] : place.Members()) values.emplace_back(name, ReadTerm(value));
    return values;
  }

  Holds ReadHolds(const JsonPlace& place) {
    Holds holds;
    for (const auto& [robot, run] : place.Members()) holds[RobotId(robot)] = RunId(run.Text());
    return holds;
  }

  CommandReport ReadReport(const JsonPlace& place) {
    CommandReport report;
    report.command = CommandId(place.At("command").Text());
    report.outcome = ReadWord<CommandReport::Outcome>(place.At("outcome"));
    report.message = place.At("message").TextOr("");
    report.progress = place.At("progress").Fraction();
    report.incarnation = place.At("incarnation").TextOr("");
    report.results = ReadValues(place.At("results"));
    return report;
  }

  RunRequest ReadRequest(const JsonPlace& place) {
    RunRequest request;
    request.kind = ReadWord<RunRequest::Kind>(place.At("kind"));
    request.target = place.At("target").TextOr("");
    request.node = place.At("node").TextOr("");
    request.robot = place.At("robot").TextOr("");
    request.reason = place.At("reason").TextOr("");
    request.arguments = ReadValues(place.At("values"));
    request.cancels_commands = place.At("cancelsCommands").IsTrue();
    request.compensates = place.At("compensates").IsTrue();
    return request;
  }

  // Of a file of worlds: about the run at a path, or about the workflow.
  RunRequest ReadRequestOfWorld(const JsonPlace& place, RunCase* saved) {
    using Kind = RunRequest::Kind;
    RunRequest request = ReadRequest(place);
    if (request.kind == Kind::kPauseWorkflow || request.kind == Kind::kResumeWorkflow) {
      request.target = saved->workflow;
    } else if (request.kind != Kind::kCancelCommands) {
      const std::string path = place.At("run").TextOr("");
      request.target = path.empty() ? saved->run.value() : path;
      if (!path.empty()) saved->nested[RunId(path)] = path;
    }
    return request;
  }

  SensorReading ReadReading(const JsonPlace& place) {
    SensorReading reading;
    reading.sensor = place.At("sensor").Text();
    reading.value = ReadTerm(place.At("value"));
    if (place.At("time").there()) reading.time_us = ReadTime(place.At("time"));
    return reading;
  }

  std::string ReadPacked(const JsonPlace& place) {
    std::string text, packed;
    for (const JsonPlace& line : place.Items()) text += line.Text();
    if (!wrong_.ok()) return "";
    absl::StatusOr<std::string> bytes = absl::InvalidArgumentError("");
    if (absl::Base64Unescape(text, &packed) && IsGzip(packed))
      bytes = Gunzip(packed, limits_.saved_run_bytes, "saved_run_bytes");
    if (absl::IsResourceExhausted(bytes.status())) wrong_ = bytes.status();
    if (!bytes.ok()) place.Wrong("is no packed state");
    return bytes.ok() ? *std::move(bytes) : "";
  }

  std::vector<QuadOperation> ReadOperations(const JsonPlace& place) {
    std::vector<QuadOperation> operations;
    for (TermQuad& quad : ReadFacts(place, true))
      operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    size_t at = 0;
    if (!wrong_.ok()) return operations;
    for (const JsonPlace& line : place.Items()) {
      if (line.Text().starts_with("- ")) operations[at].kind = QuadOperation::Kind::kRemove;
      ++at;
    }
    return operations;
  }

  void ReadBatch(const JsonPlace& place, RunCase* saved, CaseTurn* turn) {
    WriteBatch& batch = turn->batch;
    batch.source = place.At("source").TextOr("");
    if (place.At("loads").IsTrue()) batch.mode = WriteBatch::Mode::kLoad;
    if (place.At("lifetimeMs").there()) batch.lifetime_ms = place.At("lifetimeMs").Number();
    batch.clock_tick = place.At("tick").IsTrue();
    batch.time_us = turn->time_us;
    for (const JsonPlace& reading : place.At("readings").Items())
      batch.readings.push_back(ReadReading(reading));
    for (const JsonPlace& document : place.At("documents").Items())
      batch.documents.push_back(ReadDocument(document));
    for (const JsonPlace& report : place.At("reports").Items()) batch.reports.push_back(ReadReport(report));
    for (const JsonPlace& request : place.At("requests").Items())
      batch.run_requests.push_back(version_ == kOfWorlds ? ReadRequestOfWorld(request, saved)
                                                         : ReadRequest(request));
    if (version_ != kOfWorlds) {
      batch.operations = ReadOperations(place.At("facts"));
      return;
    }
    batch.mode = WriteBatch::Mode::kLoad;
    for (const auto& [name, kind] :
         {std::pair("remove", QuadOperation::Kind::kRemove), std::pair("add", QuadOperation::Kind::kAdd)}) {
      for (TermQuad& quad : ReadFacts(place.At(name))) batch.operations.push_back({kind, std::move(quad)});
    }
  }

  void ReadTurn(const JsonPlace& place, RunCase* saved) {
    CaseTurn turn;
    turn.offset = place.At("turn").Number();
    turn.time_us = ReadTime(place.At("time"));
    const bool later = saved->turns.empty() || (turn.offset > saved->turns.back().offset &&
                                                turn.time_us >= saved->turns.back().time_us);
    if (turn.offset == 0 || !later) place.Wrong("does not come after the turn before it");
    ReadBatch(place, saved, &turn);
    if (place.At("due").there()) turn.due_us = static_cast<TimeMicros>(place.At("due").Number());
    for (const JsonPlace& time : place.At("asksFor").Items()) turn.asked.push_back(time.Text());
    for (const JsonPlace& time : place.At("asksNoMore").Items()) turn.asked_no_more.push_back(time.Text());
    if (place.At("held").there()) turn.held = ReadHolds(place.At("held"));
    if (saved->turns.size() >= limits_.replay_turns && wrong_.ok()) {
      wrong_ = absl::ResourceExhaustedError(
          absl::StrCat("it has more than ", limits_.replay_turns, " turns; the limit is replay_turns"));
    }
    if (wrong_.ok()) saved->turns.push_back(std::move(turn));
  }

  Decision ReadDecision(const JsonPlace& place) {
    Decision decision;
    decision.turn = place.At("turn").Number();
    decision.time_us = ReadTime(place.At("time"));
    decision.node = place.At("node").TextOr("");
    if (place.At("cancels").there()) {
      decision.kind = Decision::Kind::kCancel;
      decision.command = CommandId(place.At("cancels").Text());
    } else if (place.At("command").there()) {
      decision.kind = Decision::Kind::kCommand;
      decision.command = CommandId(place.At("command").Text());
      decision.operation = place.At("operation").Text();
      decision.robot = RobotId(place.At("robot").Text());
      decision.arguments = ReadValues(place.At("values"));
    } else {
      decision.from = place.At("from").Text();
      decision.to = place.At("to").Text();
      decision.cause = place.At("cause").TextOr("");
    }
    return decision;
  }

  const std::string& file_;
  const ReplayLimits limits_;
  uint64_t version_ = kCaseVersion;
  size_t facts_ = 0;
  absl::Status wrong_;
};

}  // namespace

absl::StatusOr<RunCase> DecodeCase(const std::string& text, const std::string& file,
                                   const ReplayLimits& limits) {
  if (text.size() > limits.saved_run_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        file, " has ", text.size(), " bytes; the limit saved_run_bytes is ", limits.saved_run_bytes));
  }
  return Decoder(file, limits).Decode(text);
}

}  // namespace docent::server
