// Runs a peer's program to its end, in a folder of its own.
#ifndef DOCENT_BENCH_PEER_PROCESS_H_
#define DOCENT_BENCH_PEER_PROCESS_H_

#include <string>
#include <vector>

namespace docent::bench {

// A new folder for temporary files; the destructor removes it with its content.
class PeerFolder {
 public:
  PeerFolder();
  ~PeerFolder();
  PeerFolder(const PeerFolder&) = delete;
  PeerFolder& operator=(const PeerFolder&) = delete;
  // Empty if none could be made.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// True if the shell finds a program of that name.
bool Installed(const std::string& program);

// The output of the command, which is stopped after `timeout_s` seconds.
std::string RunAndRead(const std::string& command, int timeout_s);

// The numbers after `word` and a space, for each line that begins with `word`.
std::vector<double> NumbersAfter(const std::string& text, const std::string& word);
// The last of them; negative if there is none.
double NumberAfter(const std::string& text, const std::string& word);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_PEER_PROCESS_H_
