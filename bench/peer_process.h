// A peer's program, run to its end in a folder of its own.
#ifndef DOCENT_BENCH_PEER_PROCESS_H_
#define DOCENT_BENCH_PEER_PROCESS_H_

#include <string>
#include <vector>

namespace docent::bench {

// A new folder for temporary files, removed with all that is in it at the end.
class PeerFolder {
 public:
  PeerFolder();
  ~PeerFolder();
  PeerFolder(const PeerFolder&) = delete;
  PeerFolder& operator=(const PeerFolder&) = delete;
  // Empty where none could be made.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Whether the shell finds a program of that name.
bool Installed(const std::string& program);

// What the command printed; it is ended after `timeout_s` seconds.
std::string RunAndRead(const std::string& command, int timeout_s);

// The numbers after `word` and a space, each time that `word` begins a line.
std::vector<double> NumbersAfter(const std::string& text, const std::string& word);
// The last of them; below zero where there is none.
double NumberAfter(const std::string& text, const std::string& word);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_PEER_PROCESS_H_
