// A robot's operations as functions: one for each operation of its description.
//
// The sdk runs each command on a thread of its own; an operation may therefore block, but has to look at
// `StopRequested` (or wait with `SleepFor`) often enough to end soon after it was cancelled.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_OPERATION_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_OPERATION_H_

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"

namespace docent::robot {

// Named values, in the order given.
using NamedTerms = std::vector<std::pair<std::string, Term>>;

// What an operation sees of the command that it carries out. Belongs to the operation's thread, and is valid
// until the operation returns.
class OperationContext {
 public:
  virtual ~OperationContext() = default;

  virtual const CommandId& command() const = 0;
  virtual const NamedTerms& arguments() const = 0;
  // Microseconds since 1970 after which the command counts as failed; 0: none.
  virtual TimeMicros deadline_us() const = 0;

  // True once the command was cancelled, its deadline has passed, or the adapter shuts down: return soon,
  // with any status that is not OK.
  virtual bool StopRequested() = 0;
  // Waits; false as soon as StopRequested() is true.
  virtual bool SleepFor(std::chrono::microseconds duration) = 0;
  // Tells the server how far the command is, 0..1, and what it does, for people. Cheap; may be called often.
  virtual void ReportProgress(double fraction, std::string_view message) = 0;

  // The argument's value. INVALID_ARGUMENT, naming it, if it was not given.
  absl::StatusOr<Term> Argument(std::string_view name) const;
};

// OK with named results: SUCCEEDED. An error: FAILED with its message, or CANCELLED if the server cancelled
// it.
using OperationFunction = std::function<absl::StatusOr<NamedTerms>(OperationContext&)>;

// A named value that an operation takes or gives.
struct Part {
  std::string name;
  std::string type =
      {};  // IRI of a class or datatype, or with a well-known prefix: "xsd:integer", "docent:Booth"; empty: anything
};

struct Operation {
  std::string name;
  std::vector<std::string> inputs;   // part names; each must be given in a command
  std::vector<std::string> outputs;  // part names
  bool idempotent = false;           // doing it twice does no harm: the server may repeat it when in doubt
  std::string description;           // for people
  OperationFunction run;
  // What of the robot it occupies: names that its maker chooses, e.g. {"base"} or {"screen", "voice"}. Operations that share
  // none may run beside each other. Empty: the whole robot.
  std::vector<std::string> occupies = {};
  // As `inputs` and `outputs`, with types; where given, these count, and the names need not be given twice.
  std::vector<Part> input_parts = {};
  std::vector<Part> output_parts = {};
  // Classes of operations that it is of: IRIs, or with a well-known prefix: {"docent:Navigation"}. Workflows may ask for a class.
  std::vector<std::string> capabilities = {};
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_OPERATION_H_
