#include "bench/peer_process.h"

#include <stdio.h>
#include <stdlib.h>

#include <filesystem>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace docent::bench {

PeerFolder::PeerFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "docent-bench-XXXXXX").string();
  if (mkdtemp(name.data()) != nullptr) path_ = name;
}

PeerFolder::~PeerFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

bool Installed(const std::string& program) {
  return system(absl::StrCat("command -v ", program, " >/dev/null 2>&1").c_str()) == 0;
}

std::string RunAndRead(const std::string& command, int timeout_s) {
  std::string text;
  FILE* pipe = popen(absl::StrCat("timeout ", timeout_s, " ", command, " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return text;
  char buffer[4096];
  for (size_t n; (n = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) text.append(buffer, n);
  pclose(pipe);
  return text;
}

std::vector<double> NumbersAfter(const std::string& text, const std::string& word) {
  const std::string all = "\n" + text, label = "\n" + word + " ";
  std::vector<double> numbers;
  for (size_t at = all.find(label); at != std::string::npos; at = all.find(label, at + 1)) {
    const size_t start = at + label.size();
    double number = 0;
    if (absl::SimpleAtod(all.substr(start, all.find_first_of(" \n", start) - start), &number))
      numbers.push_back(number);
  }
  return numbers;
}

double NumberAfter(const std::string& text, const std::string& word) {
  const std::vector<double> numbers = NumbersAfter(text, word);
  return numbers.empty() ? -1 : numbers.back();
}

}  // namespace docent::bench
