// Counters, gauges and histograms, written in the Prometheus text format (version 0.0.4), which is a line
// format. (The prometheus-cpp package of Debian 12 cannot be installed beside the Redland libraries.)
//
// Metrics are added while the server is put together and live as long as the registry; changing one is an
// atomic operation, so they may stand on hot paths. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_METRICS_H_
#define DOCENT_KB_SERVER_DOOR_METRICS_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"

namespace docent::server {

// Only grows.
class Counter {
 public:
  void Add(uint64_t by = 1) { value_.fetch_add(by, std::memory_order_relaxed); }
  uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<uint64_t> value_{0};
};

// How often values fell up to each bound, their number and their sum.
class Histogram {
 public:
  // `bounds`: ascending; the bucket up to infinity is added.
  explicit Histogram(std::vector<double> bounds);
  void Observe(double value);

  const std::vector<double>& bounds() const { return bounds_; }
  // Values ≤ bounds()[i]; for i = bounds().size() all of them.
  uint64_t CountUpTo(size_t i) const;
  double sum() const { return sum_.load(std::memory_order_relaxed); }

 private:
  const std::vector<double> bounds_;
  std::vector<std::atomic<uint64_t>> counts_;  // of each bucket alone
  std::atomic<double> sum_{0};
};

class Metrics {
 public:
  using Labels = std::vector<std::pair<std::string, std::string>>;

  // Names by Prometheus' rules ([a-z_:][a-z0-9_:]*, counters end in _total, units last: _seconds, _bytes).
  // Adding the same name with other labels makes another series of that metric; with the same labels it gives
  // the same one.
  Counter& AddCounter(const std::string& name, const std::string& help, const Labels& labels = {});
  Histogram& AddHistogram(const std::string& name, const std::string& help, std::vector<double> bounds,
                          const Labels& labels = {});
  // A value that is read when the page is asked for. `read` is called from any thread and must outlive the
  // registry.
  void AddCounterFunction(const std::string& name, const std::string& help, std::function<double()> read,
                          const Labels& labels = {});
  void AddGaugeFunction(const std::string& name, const std::string& help, std::function<double()> read,
                        const Labels& labels = {});

  // `old_name` is also shown, with the values of `name` (which is there) and "Deprecated: use NAME" as its help.
  void AddDeprecatedName(const std::string& old_name, const std::string& name);

  // The whole page, names in order.
  std::string Render() const;

  // 0.1 ms … 10 s, about three a decade, in seconds.
  static std::vector<double> LatencyBounds();

 private:
  struct Series {
    std::string labels;  // "{code=\"200\"}" or empty
    std::unique_ptr<Counter> counter;
    std::unique_ptr<Histogram> histogram;
    std::function<double()> read;
  };
  struct Family {
    std::string help;
    std::string type;
    std::vector<std::unique_ptr<Series>> series;
  };

  Series& Find(const std::string& name, const std::string& help, const char* type, const Labels& labels)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  static void RenderSeries(const std::string& name, const Series& series, std::string* out);

  static void RenderFamily(const std::string& name, const std::string& help, const Family& family,
                           std::string* out);

  mutable absl::Mutex mutex_;
  std::map<std::string, Family> families_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::string> deprecated_ ABSL_GUARDED_BY(mutex_);  // old name → name
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_METRICS_H_
