// Runs a fuzz target without libFuzzer: first each corpus file unchanged, then seeded mutations of them.
//
//   fuzz_cawl MUTATIONS SEED PATH…     PATH: a file, or a folder with files at any depth
//                                      MUTATIONS like 600s: as many as possible in that many seconds
//
// A finding ends the program; the text that caused it is in fuzz_finding.txt in the working folder.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

namespace fs = std::filesystem;

std::string ReadFile(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> ReadCorpus(int argc, char** argv) {
  std::vector<fs::path> files;
  for (int i = 3; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(argv[i])) {
      if (entry.is_regular_file() && entry.path().filename() != "expected.txt") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> out;
  for (const fs::path& file : files) out.push_back(ReadFile(file));
  return out;
}

const std::string* running = nullptr;

// Makes only calls that are allowed in a signal handler.
void KeepFinding(int signal_number) {
  int file = open("fuzz_finding.txt", O_CREAT | O_TRUNC | O_WRONLY, 0644);
  if (file >= 0 && running != nullptr) {
    for (size_t done = 0; done < running->size();) {
      ssize_t now = write(file, running->data() + done, running->size() - done);
      if (now <= 0) break;
      done += static_cast<size_t>(now);
    }
    close(file);
  }
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

void RunOne(const std::string& text) {
  running = &text;
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(text.data()), text.size());
  running = nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: %s MUTATIONS SEED PATH...\n", argv[0]);
    return 2;
  }
  std::vector<std::string> corpus = ReadCorpus(argc, argv);
  if (corpus.empty()) {
    std::fprintf(stderr, "no corpus files\n");
    return 2;
  }
  signal(SIGABRT, KeepFinding);
  signal(SIGSEGV, KeepFinding);
  signal(SIGTERM, KeepFinding);  // sent at a timeout: keeps the current text
  for (const std::string& text : corpus) RunOne(text);
  char* unit = nullptr;
  const long number = std::strtol(argv[1], &unit, 10);
  const bool seconds = *unit == 's';
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds ? number : 0);
  uint32_t seed = static_cast<uint32_t>(std::strtoul(argv[2], nullptr, 10));
  docent::fuzz::Mutator mutator(seed, corpus,
                                {"<",
                                 ">",
                                 "</",
                                 "/>",
                                 "\"",
                                 "&lt;",
                                 "&#x0;",
                                 "&#10;",
                                 "<![CDATA[",
                                 "]]>",
                                 "<!--",
                                 "-->",
                                 "<?x?>",
                                 "<!DOCTYPE a [",
                                 "xmlns:x=\"urn:x\"",
                                 " name=\"\"",
                                 "$user",
                                 "?x",
                                 "not (",
                                 " or ",
                                 " and ",
                                 "prefix:",
                                 "RULE {",
                                 "} WHERE {",
                                 "FILTER NOT EXISTS {",
                                 "OPTIONAL {",
                                 "BIND(",
                                 "?x",
                                 "<urn:x>",
                                 "\xC3\xA9",
                                 "\xFF",
                                 std::string(1, '\0'),
                                 "{",
                                 "}",
                                 "ASK",
                                 "."});
  long mutations = 0;
  for (; seconds ? std::chrono::steady_clock::now() < end : mutations < number; ++mutations)
    RunOne(mutator.Next());
  std::printf("%zu corpus files, %ld mutations of seed %u: nothing found\n", corpus.size(), mutations, seed);
  return 0;
}
