#include "kb_server/door/metrics.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"

namespace docent::server {
namespace {

// Shortest form that reads back as the same double.
std::string Number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  for (int digits = 6; digits < 17; ++digits) {
    const std::string text = absl::StrFormat("%.*g", digits, value);
    if (std::strtod(text.c_str(), nullptr) == value) return text;
  }
  return absl::StrFormat("%.17g", value);
}

std::string LabelText(const Metrics::Labels& labels) {
  std::string text;
  for (const auto& [name, value] : labels) {
    absl::StrAppend(&text, text.empty() ? "{" : ",", name, "=\"",
                    absl::StrReplaceAll(value, {{"\\", "\\\\"}, {"\"", "\\\""}, {"\n", "\\n"}}), "\"");
  }
  return text.empty() ? text : text + "}";
}

// `labels` with one more: "{a="1"}" and le="0.5" → "{a="1",le="0.5"}".
std::string WithBound(const std::string& labels, const std::string& bound) {
  const std::string last = absl::StrCat("le=\"", bound, "\"}");
  return labels.empty() ? absl::StrCat("{", last)
                        : absl::StrCat(labels.substr(0, labels.size() - 1), ",", last);
}

}  // namespace

Histogram::Histogram(std::vector<double> bounds) : bounds_(std::move(bounds)), counts_(bounds_.size() + 1) {}

void Histogram::Observe(double value) {
  const auto bound = std::lower_bound(bounds_.begin(), bounds_.end(), value);
  counts_[static_cast<size_t>(bound - bounds_.begin())].fetch_add(1, std::memory_order_relaxed);
  sum_.fetch_add(value, std::memory_order_relaxed);
}

uint64_t Histogram::CountUpTo(size_t i) const {
  uint64_t count = 0;
  for (size_t bucket = 0; bucket <= i && bucket < counts_.size(); ++bucket) {
    count += counts_[bucket].load(std::memory_order_relaxed);
  }
  return count;
}

std::vector<double> Metrics::LatencyBounds() {
  return {0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10};
}

Metrics::Series& Metrics::Find(const std::string& name, const std::string& help, const char* type,
                               const Labels& labels) {
  Family& family = families_[name];
  if (family.series.empty()) {
    family.help = help;
    family.type = type;
  }
  const std::string text = LabelText(labels);
  for (const auto& series : family.series) {
    if (series->labels == text) return *series;
  }
  family.series.push_back(std::make_unique<Series>());
  family.series.back()->labels = text;
  return *family.series.back();
}

Counter& Metrics::AddCounter(const std::string& name, const std::string& help, const Labels& labels) {
  absl::MutexLock lock(&mutex_);
  Series& series = Find(name, help, "counter", labels);
  if (!series.counter) series.counter = std::make_unique<Counter>();
  return *series.counter;
}

Histogram& Metrics::AddHistogram(const std::string& name, const std::string& help, std::vector<double> bounds,
                                 const Labels& labels) {
  absl::MutexLock lock(&mutex_);
  Series& series = Find(name, help, "histogram", labels);
  if (!series.histogram) series.histogram = std::make_unique<Histogram>(std::move(bounds));
  return *series.histogram;
}

void Metrics::AddCounterFunction(const std::string& name, const std::string& help,
                                 std::function<double()> read, const Labels& labels) {
  absl::MutexLock lock(&mutex_);
  Find(name, help, "counter", labels).read = std::move(read);
}

void Metrics::AddGaugeFunction(const std::string& name, const std::string& help, std::function<double()> read,
                               const Labels& labels) {
  absl::MutexLock lock(&mutex_);
  Find(name, help, "gauge", labels).read = std::move(read);
}

void Metrics::RenderSeries(const std::string& name, const Series& series, std::string* out) {
  if (series.histogram) {
    const Histogram& histogram = *series.histogram;
    for (size_t i = 0; i < histogram.bounds().size(); ++i) {
      absl::StrAppend(out, name, "_bucket", WithBound(series.labels, Number(histogram.bounds()[i])), " ",
                      histogram.CountUpTo(i), "\n");
    }
    const uint64_t all = histogram.CountUpTo(histogram.bounds().size());
    absl::StrAppend(out, name, "_bucket", WithBound(series.labels, "+Inf"), " ", all, "\n");
    absl::StrAppend(out, name, "_sum", series.labels, " ", Number(histogram.sum()), "\n");
    absl::StrAppend(out, name, "_count", series.labels, " ", all, "\n");
    return;
  }
  std::string value;
  if (series.counter) value = absl::StrCat(series.counter->value());
  if (series.read) value = Number(series.read());
  absl::StrAppend(out, name, series.labels, " ", value, "\n");
}

void Metrics::AddDeprecatedName(const std::string& old_name, const std::string& name) {
  absl::MutexLock lock(&mutex_);
  deprecated_[old_name] = name;
}

void Metrics::RenderFamily(const std::string& name, const std::string& help, const Family& family,
                           std::string* out) {
  absl::StrAppend(out, "# HELP ", name, " ", absl::StrReplaceAll(help, {{"\\", "\\\\"}, {"\n", "\\n"}}),
                  "\n");
  absl::StrAppend(out, "# TYPE ", name, " ", family.type, "\n");
  for (const auto& series : family.series) RenderSeries(name, *series, out);
}

std::string Metrics::Render() const {
  absl::MutexLock lock(&mutex_);
  std::map<std::string, std::string> pages;
  for (const auto& [name, family] : families_) RenderFamily(name, family.help, family, &pages[name]);
  for (const auto& [old_name, name] : deprecated_) {
    const auto family = families_.find(name);
    if (family == families_.end()) continue;
    RenderFamily(old_name, absl::StrCat("Deprecated: use ", name), family->second, &pages[old_name]);
  }
  std::string out;
  for (const auto& [name, page] : pages) absl::StrAppend(&out, page);
  return out;
}

}  // namespace docent::server
