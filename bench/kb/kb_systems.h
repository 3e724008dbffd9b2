// The measured systems of `docent-bench kb` as processes, and their answers. One thread.
#ifndef DOCENT_BENCH_KB_KB_SYSTEMS_H_
#define DOCENT_BENCH_KB_KB_SYSTEMS_H_

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace docent::bench {

struct KbSystem {
  std::string name;     // as in the results
  std::string command;  // shell words; the job file's name is appended
  std::string missing;  // why it cannot run; empty: it can
};

// Docent and the peers. `programs`: folder of docent_kb_*; `scripts`: of the peers' scripts; `npm`: holds
// node_modules.
std::vector<KbSystem> KbSystems(const std::string& programs, const std::string& scripts,
                                const std::string& npm);

struct KbAnswer {
  std::vector<int64_t> answers;         // rows (count, 0 or 1) of each instance
  std::vector<std::vector<double>> us;  // latency of each instance, a pass each
  std::string reason;                   // why there is no answer

  // Mean latencies of the first `instances`, ascending: of each instance's fastest pass, of
  // its second fastest, and so on. On a shared machine the middle one excludes interrupted
  // passes.
  std::vector<double> Means(size_t instances) const;
};

struct KbRun {
  double load_s = 0;
  double bytes = 0;                                            // growth of resident memory by loading
  double index_bytes = 0, dictionary_bytes = 0;                // docent
  std::string reason;                                          // why nothing was measured
  std::map<std::pair<size_t, std::string>, KbAnswer> answers;  // by case and mode
};

// One system's process: it has loaded the data and runs cases on request. Systems are measured in turn, case
// by case, because the speed of a shared machine changes within minutes. Not copyable; the destructor ends
// the process.
class KbProcess {
 public:
  // Waits until the data are loaded. The total waiting time here and in Measure() is at most `timeout_s`.
  KbProcess(const KbSystem& system, const std::string& job_file, int timeout_s);
  ~KbProcess();
  KbProcess(const KbProcess&) = delete;
  KbProcess& operator=(const KbProcess&) = delete;

  // Measures a case ("cold" or "prepared"); does nothing if the process has ended or its time is over.
  void Measure(size_t number, const std::string& mode);
  const KbRun& run() const { return run_; }

 private:
  // Waits for the next line with a JSON object; false: there is none in the remaining time.
  bool TakeLine();
  void End();

  pid_t pid_ = -1;
  int socket_ = -1;
  std::chrono::steady_clock::duration left_;
  std::string buffer_;
  KbRun run_;
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_KB_KB_SYSTEMS_H_
