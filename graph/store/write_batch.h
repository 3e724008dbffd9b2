// Every input that can change server state, as one type: the element of the inbox, and the recorded input in
// the log. Terms are text here; ids exist only behind the writer thread.
//
// A batch is applied whole or not at all. Value; any thread until it is in the inbox.
#ifndef DOCENT_GRAPH_STORE_WRITE_BATCH_H_
#define DOCENT_GRAPH_STORE_WRITE_BATCH_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"

namespace docent {

// Add or remove one quad.
struct QuadOperation {
  enum class Kind : uint8_t { kAdd, kRemove };
  Kind kind = Kind::kAdd;
  TermQuad quad;

  friend bool operator==(const QuadOperation&, const QuadOperation&) = default;
};

// A raw sensor reading (the paper's context: sensor, value, time). Readings become facts by the
// docent:ReadingMapping resources of the graph (ontology/sensor.ttl).
struct SensorReading {
  std::string sensor;      // IRI
  Term value;              // literal or IRI
  TimeMicros time_us = 0;  // time of the measurement; 0: the batch's time

  friend bool operator==(const SensorReading&, const SensorReading&) = default;
};

// The parse result of a document's text, made by the sender. Not recorded: replay parses the text.
struct ParsedText {
  virtual ~ParsedText() = default;
};

// A document that changes how the server behaves.
struct Document {
  enum class Kind : uint8_t { kOntology, kRules, kCawl, kRsel };
  enum class Action : uint8_t { kPut, kRemove };
  Kind kind = Kind::kOntology;
  Action action = Action::kPut;
  std::string name;  // unique within its kind; a document of the same name replaces it
  // The text as the user wrote it. For an ontology: its prefix declarations; its quads are in `operations`.
  std::string text;
  std::shared_ptr<const ParsedText> parsed;  // of `text`; null: not parsed yet
  // Of a workflow: the version that is deployed now, 0 for none, or the turn is refused; nullopt: whichever. Not in the log,
  // which has what was accepted.
  std::optional<uint32_t> replaces = std::nullopt;

  friend bool operator==(const Document& a, const Document& b) {
    return a.kind == b.kind && a.action == b.action && a.name == b.name && a.text == b.text;
  }
};

// News of a command from a robot client proxy.
struct CommandReport {
  enum class Outcome : uint8_t {
    kAccepted,     // the adapter has it and executes it
    kProgress,     // `progress` gives the fraction done
    kSucceeded,    // final
    kFailed,       // final; `message` gives the reason
    kCancelled,    // final
    kUnknown,      // final: the adapter restarted, and cannot tell whether it was executed
    kUnreachable,  // not final: the adapter cannot be reached now; the proxy retries until the deadline
    kRefused,      // not final: feedback of the adapter that cannot be about this command; `message` says why
    kNotBegun      // final: it was cancelled or called back, and no adapter has begun it
  };
  CommandId command;
  Outcome outcome = Outcome::kAccepted;
  std::string message;                                // for people; empty on success
  double progress = 0;                                // 0..1
  std::string incarnation;                            // incarnation of the reporting adapter
  std::vector<std::pair<std::string, Term>> results;  // named result values of a finished command

  friend bool operator==(const CommandReport&, const CommandReport&) = default;
};

// A request of an operator or client about workflow runs.
struct RunRequest {
  enum class Kind : uint8_t {
    kStart,
    kCancel,
    kInvokeService,
    kPause,
    kResume,
    kPauseWorkflow,
    kResumeWorkflow,
    kRetryNode,  // of a node that has an incident, as the two that follow
    kSkipNode,
    kFailNode,
    kSetVariable,
    kCancelCommands  // of a robot that is taken out of service
  };
  Kind kind = Kind::kStart;
  std::string target;  // kStart: the workflow's name (optionally "name/flow"); kInvokeService: an RSEL
                       // process; k…Workflow: its name; kCancelCommands: the robot's IRI; else a run id
  // kStart, kInvokeService, kSkipNode, kSetVariable: variable or part name → value
  std::vector<std::pair<std::string, Term>> arguments;
  std::string node{};             // k…Node: its name
  std::string robot{};            // kRetryNode: IRI of the robot to use; empty: as the document says
  std::string reason{};           // for people
  bool cancels_commands = false;  // kPause, kPauseWorkflow: what is under way does not end by itself
  bool compensates = false;       // kCancel: what done nodes did is undone

  friend bool operator==(const RunRequest&, const RunRequest&) = default;
};

struct WriteBatch {
  // Meaning of adds. kAssert: a new value of a docent:StateProperty replaces the old one of the same source.
  // kLoad: plain RDF set semantics.
  enum class Mode : uint8_t { kAssert, kLoad };

  // Chosen by the client. A repeat gets the first answer and is not applied again.
  std::string request_id;
  // Fingerprint of what the client asked for, its kind included: the same id with another one is no repeat. 0: not known,
  // as of records that older versions wrote.
  uint64_t request_digest = 0;
  std::string source;  // IRI of the sender: the graph of quads without a graph. Empty: docent:default
  Mode mode = Mode::kAssert;
  TimeMicros time_us = 0;    // set by the inbox, never decreases
  uint64_t lifetime_ms = 0;  // kAssert: the facts are withdrawn after this time unless renewed; 0: they stay

  std::vector<QuadOperation> operations;
  std::vector<SensorReading> readings;
  std::vector<Document> documents;
  std::vector<CommandReport> reports;
  std::vector<RunRequest> run_requests;
  bool clock_tick = false;  // a deadline is due; nothing else in the batch

  size_t OperationCount() const {
    return operations.size() + readings.size() + reports.size() + documents.size() + run_requests.size();
  }

  friend bool operator==(const WriteBatch&, const WriteBatch&) = default;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_WRITE_BATCH_H_
