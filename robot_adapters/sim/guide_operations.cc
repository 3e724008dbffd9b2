#include "robot_adapters/sim/guide_operations.h"

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace docent::robot {
namespace {

Operation Make(const char* name, const char* description, const char* occupies, const char* capability,
               const Part& input, bool idempotent, std::vector<Part> outputs = {}) {
  Operation operation;
  operation.name = name;
  operation.description = description;
  operation.occupies = {occupies};
  operation.capabilities = {capability};
  operation.input_parts = {input};
  operation.output_parts = std::move(outputs);
  operation.idempotent = idempotent;
  return operation;
}

constexpr size_t kColumns = 7;
using Row = std::array<std::string, kColumns>;

std::string PartsText(const std::vector<Part>& parts) {
  return absl::StrJoin(parts, ", ", [](std::string* out, const Part& part) {
    absl::StrAppend(out, part.name, part.type.empty() ? "" : ": ", part.type);
  });
}

}  // namespace

std::vector<Operation> GuideOperations() {
  const Part user{"user", "docent:Person"}, booth{"booth", "docent:Region"};
  const Part page{"page", "xsd:anyURI"}, file{"file", "xsd:string"};
  const Part place{"place", "docent:Region"}, text{"text", "xsd:string"};
  return {
      Make("moveToUser", "Drives to where the user is", "base", "docent:Navigation", user, true),
      Make("moveToBooth", "Drives to the place before a booth", "base", "docent:Navigation", booth, true),
      Make("displayBoothInfo", "Shows a page about the booth", "screen", "docent:Display", booth, true,
           {page}),
      Make("briefBoothInfo", "Speaks about the booth", "voice", "docent:SpeechSynthesis", booth, false,
           {file}),
      Make("driveTo", "Drives to a place", "base", "docent:Navigation", place, true),
      Make("showText", "Shows a text", "screen", "docent:Display", text, true, {page}),
      Make("say", "Speaks a text in its language", "voice", "docent:SpeechSynthesis", text, false, {file}),
  };
}

std::string OperationsTable(const std::vector<Operation>& operations) {
  std::vector<Row> rows = {
      {"operation", "inputs", "outputs", "occupies", "idempotent", "capability", "what it does"}};
  for (const Operation& operation : operations) {
    rows.push_back({operation.name, PartsText(operation.input_parts), PartsText(operation.output_parts),
                    absl::StrJoin(operation.occupies, ", "), operation.idempotent ? "yes" : "no",
                    absl::StrJoin(operation.capabilities, ", "), operation.description});
  }
  Row::size_type widths[kColumns] = {};
  for (Row& row : rows) {
    for (size_t i = 0; i < kColumns; ++i) {
      if (row[i].empty()) row[i] = "-";
      widths[i] = std::max(widths[i], row[i].size());
    }
  }
  std::string table;
  for (const Row& row : rows) {
    for (size_t i = 0; i + 1 < kColumns; ++i)
      absl::StrAppend(&table, row[i], std::string(widths[i] + 2 - row[i].size(), ' '));
    absl::StrAppend(&table, row[kColumns - 1], "\n");
  }
  return table;
}

}  // namespace docent::robot
