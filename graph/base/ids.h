// Strong id types: no bare string or integer crosses a folder border as an id. Values; any thread.
#ifndef DOCENT_GRAPH_BASE_IDS_H_
#define DOCENT_GRAPH_BASE_IDS_H_

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

namespace docent {

// A string that names one kind of thing. `Tag` keeps kinds apart at compile time.
template <typename Tag>
class NameOf {
 public:
  NameOf() = default;
  explicit NameOf(std::string value) : value_(std::move(value)) {}
  const std::string& value() const { return value_; }
  bool empty() const { return value_.empty(); }
  friend auto operator<=>(const NameOf&, const NameOf&) = default;
  template <typename H>
  friend H AbslHashValue(H h, const NameOf& id) {
    return H::combine(std::move(h), id.value_);
  }

 private:
  std::string value_;
};

// A workflow run: flow name and a number that grows within one data folder, e.g. "BoothGuide-1".
using RunId = NameOf<struct RunIdTag>;
// A robot: the IRI of the robot in the graph.
using RobotId = NameOf<struct RobotIdTag>;
// One command to one robot: run/node/iteration/invoke/step/attempt@time (adapters drop repeated ids).
using CommandId = NameOf<struct CommandIdTag>;

// The number of a published graph version = the offset of the log record that made it. 0: the empty graph.
class Revision {
 public:
  constexpr Revision() = default;
  constexpr explicit Revision(uint64_t value) : value_(value) {}
  constexpr uint64_t value() const { return value_; }
  friend constexpr auto operator<=>(Revision, Revision) = default;

 private:
  uint64_t value_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_IDS_H_
