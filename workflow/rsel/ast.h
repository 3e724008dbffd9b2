// The syntax tree of an RSEL document (Robot Service Execution Language; Choi et al., IJDSN 2014): robot services
// made of operations that robots offer. One struct an element; its concrete syntax stands above it.
//
// Made by ParseRsel, then never changed; held by DocumentPtr. Any thread.
#ifndef DOCENT_WORKFLOW_RSEL_AST_H_
#define DOCENT_WORKFLOW_RSEL_AST_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/term.h"
#include "workflow/xml/xml_document.h"

namespace docent::rsel {

using xml::Text;

// Attributes in this namespace are Docent's extensions: parallel, retry, timeout, onFailure.
inline constexpr std::string_view kExtensionNs = "https://w3id.org/docent/rsel-ext#";

// <part name="booth" type="docent:Booth"/>
struct Part {
  Text name;
  Text type;  // a class or datatype as prefix:local
  SourceSpan span;
  std::optional<Term> type_term = {};  // its IRI
};

// <message name="BoothRequest"> part* </message>
struct Message {
  Text name;
  std::vector<Part> parts;
  SourceSpan span;
};

// <input part="booth" from="selectedBooth"/>  the invoked operation's part takes this process's part or result
// <input part="speed" value="0.5"/>           or a constant: prefix:local, <iri>, "text", a number, true, false
struct Input {
  Text part;
  Text from;
  Text value_text;
  std::optional<Term> value;
  SourceSpan span;
};

// <output part="pose" to="lastPose"/>  keeps a result of the operation under a name that later inputs may use
struct Output {
  Text part;
  Text to;
  SourceSpan span;
};

// <invoke operation="moveToBooth" service="navigation"> input* output* </invoke>
// `operation`: a process of this or another registered document, or else an operation of the robot. A process that
// invokes its own name means the robot's operation of that name. Without any `input` a nested process takes the
// parts of the same names, an operation all parts of this process's input message (none without such a message).
struct Invoke {
  enum class OnFailure {
    kFail,      // the process fails
    kContinue,  // the process goes on as if it had succeeded, without its results
  };
  Text operation;
  Text service;  // for people: the robot's service that has the operation
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  bool parallel = false;  // ext:parallel="true": starts together with the invoke before it
  int retry = 0;          // ext:retry: further attempts after a failure
  Text timeout_text;
  std::optional<int64_t> timeout_ms;        // ext:timeout: of each attempt
  OnFailure on_failure = OnFailure::kFail;  // ext:onFailure="fail|continue"
  SourceSpan span;
};

// <process name="BoothGuide" input="GuideRequest" output="GuideReply"> invoke+ </process>
// `input`, `output`: names of messages, optional. Without `input`, the process takes what its invokes use and
// nothing before them makes.
struct Process {
  Text name;
  Text input;
  Text output;
  std::vector<Invoke> invokes;
  SourceSpan span;
};

// <rsel name="BoothServices" namespace="…" version="1.0"> message* process+ </rsel>
struct Document {
  std::string file;
  std::string source;
  Text name;
  Text namespace_iri;
  Text version;
  std::vector<Message> messages;
  std::vector<Process> processes;
  SourceSpan span;

  const Message* FindMessage(std::string_view message_name) const;
  const Process* FindProcess(std::string_view process_name) const;
};

using DocumentPtr = std::shared_ptr<const Document>;

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_AST_H_
