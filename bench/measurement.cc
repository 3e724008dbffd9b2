#include "bench/measurement.h"

#include <time.h>

#include <algorithm>
#include <cstdio>

#include "absl/strings/str_format.h"

namespace docent::bench {
namespace {

std::string Quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += absl::StrFormat("\\u%04x", static_cast<int>(c));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string Number(double value) { return absl::StrFormat("%.4g", value); }

}  // namespace

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

std::string ToJsonLine(const Measurement& m) {
  std::string out = absl::StrFormat(R"({"bench":%s,"case":%s,"system":%s,"metric":%s,"unit":%s,)", Quoted(m.bench),
                                    Quoted(m.name), Quoted(m.system), Quoted(m.metric), Quoted(m.unit));
  if (m.runs.empty()) {
    return out + absl::StrFormat(R"("value":null,"min":null,"max":null,"runs":0,"reason":%s})", Quoted(m.reason));
  }
  const auto [low, high] = std::minmax_element(m.runs.begin(), m.runs.end());
  return out + absl::StrFormat(R"("value":%s,"min":%s,"max":%s,"runs":%d})", Number(Median(m.runs)), Number(*low),
                               Number(*high), m.runs.size());
}

std::string ToTable(const std::vector<Measurement>& measurements) {
  std::string out = absl::StrFormat("%-24s %-34s %-26s %10s %10s %10s  %-6s %4s\n", "case", "metric", "system", "median",
                                    "min", "max", "unit", "runs");
  std::string before;
  for (const Measurement& m : measurements) {
    const std::string group = m.name + m.metric;
    if (!before.empty() && group != before) out += "\n";
    before = group;
    if (m.runs.empty()) {
      out += absl::StrFormat("%-24s %-34s %-26s not measured: %s\n", m.name, m.metric, m.system, m.reason);
      continue;
    }
    const auto [low, high] = std::minmax_element(m.runs.begin(), m.runs.end());
    out += absl::StrFormat("%-24s %-34s %-26s %10s %10s %10s  %-6s %4d\n", m.name, m.metric, m.system,
                           Number(Median(m.runs)), Number(*low), Number(*high), m.unit, m.runs.size());
  }
  return out;
}

void Print(const std::vector<Measurement>& measurements, bool json) {
  if (!json) std::printf("%s", ToTable(measurements).c_str());
  for (const Measurement& m : measurements) {
    if (json) std::printf("%s\n", ToJsonLine(m).c_str());
  }
}

double CpuMillis() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

}  // namespace docent::bench
