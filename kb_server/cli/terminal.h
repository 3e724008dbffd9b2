// How results are shown to people: colours and the width of the terminal. Any thread.
#ifndef DOCENT_KB_SERVER_CLI_TERMINAL_H_
#define DOCENT_KB_SERVER_CLI_TERMINAL_H_

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace docent::server {

// A colour or weight of text.
enum class Style { kPlain, kStrong, kGood, kBad, kBusy, kFaint };

struct Terminal {
  bool colours = false;
  size_t columns = 0;  // 0: a line may be as long as it is, as it goes to a file or to another program

  // Standard output as it is. `colours`: auto, always or never. auto means on a terminal that knows colours, unless the
  // environment variable NO_COLOR is there and not empty (no-color.org). The width is the terminal's, else COLUMNS.
  static Terminal OfOutput(std::string_view colours);

  // The text in that style.
  std::string In(Style style, std::string_view text) const;
};

// While it lives, what is written to std::cout and std::cerr cannot command a terminal, wherever its text came from: see
// PrintableLines, but for the colours of Terminal::In where they are used. One at a time, around a whole program.
class SafeOutput {
 public:
  SafeOutput();
  ~SafeOutput();
  SafeOutput(const SafeOutput&) = delete;
  SafeOutput& operator=(const SafeOutput&) = delete;

 private:
  class Filter;
  const std::unique_ptr<Filter> out_, error_;
};

// A document, or rows in a result format, to standard output: as it is where a file or another program takes it, and
// safe on a terminal.
void PrintForPrograms(std::string_view text);

// A line of the progress that is shown on standard error, over the one before.
void PrintProgress(std::string_view line);

// The style of a state of a run, node, invocation or robot: "done", "failed", "offline".
Style StyleOfState(std::string_view state);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_TERMINAL_H_
