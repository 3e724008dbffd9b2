#include "bench/measurement.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "absl/strings/str_cat.h"
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

std::string Number(double value) {
  return absl::StrFormat("%.4g", value);
}

// Four significant digits; from 10,000 on with commas.
std::string NumberForPeople(double value) {
  const std::string number = Number(value);
  const double rounded = std::strtod(number.c_str(), nullptr);  // 9,999.9 is 10,000
  if (std::abs(rounded) < 10000) return number;
  std::string out = absl::StrFormat("%.0f", rounded);
  const size_t first = value < 0 ? 1 : 0;
  for (size_t i = out.size(); i > first + 3;) out.insert(i -= 3, ",");
  return out;
}

const std::vector<std::string> kTitles = {"metric", "system", "median", "min", "max", "unit", "runs"};

// A measurement without figures shows its reason.
std::vector<std::string> RowOf(const Measurement& m) {
  if (m.runs.empty()) return {m.metric, m.system, absl::StrCat("not measured: ", m.reason)};
  const auto [low, high] = std::minmax_element(m.runs.begin(), m.runs.end());
  return {m.metric,
          m.system,
          NumberForPeople(Median(m.runs)),
          NumberForPeople(*low),
          NumberForPeople(*high),
          m.unit,
          absl::StrCat(m.runs.size())};
}

std::string Line(const std::vector<std::string>& cells, const std::vector<size_t>& widths) {
  std::string out;
  for (size_t i = 0; i < cells.size(); ++i) {
    const int width = static_cast<int>(widths[i]);
    const bool figure = i >= 2 && i != 5 && cells.size() == widths.size();
    absl::StrAppend(
        &out, "  ",
        figure ? absl::StrFormat("%*s", width, cells[i]) : absl::StrFormat("%-*s", width, cells[i]));
  }
  return out + "\n";
}

}  // namespace

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<size_t>(share * static_cast<double>(values.size())))];
}

std::string ToJsonLine(const Measurement& m) {
  std::string out =
      absl::StrFormat(R"({"bench":%s,"case":%s,"system":%s,"metric":%s,"unit":%s,)", Quoted(m.bench),
                      Quoted(m.name), Quoted(m.system), Quoted(m.metric), Quoted(m.unit));
  if (m.runs.empty()) {
    return out +
           absl::StrFormat(R"("value":null,"min":null,"max":null,"runs":0,"reason":%s})", Quoted(m.reason));
  }
  const auto [low, high] = std::minmax_element(m.runs.begin(), m.runs.end());
  return out + absl::StrFormat(R"("value":%s,"min":%s,"max":%s,"runs":%d})", Number(Median(m.runs)),
                               Number(*low), Number(*high), m.runs.size());
}

std::string ToTable(const std::vector<Measurement>& measurements) {
  std::vector<std::vector<std::string>> rows;
  for (const Measurement& m : measurements) rows.push_back(RowOf(m));
  std::vector<size_t> widths;
  for (const std::string& title : kTitles) widths.push_back(title.size());
  for (const auto& row : rows) {
    for (size_t i = 0; i < row.size() && row.size() == kTitles.size(); ++i)
      widths[i] = std::max(widths[i], row[i].size());
  }
  std::string out;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Measurement& m = measurements[i];
    const bool new_case = i == 0 || m.name != measurements[i - 1].name;
    if (new_case) absl::StrAppend(&out, i == 0 ? "" : "\n", m.name, "\n", Line(kTitles, widths));
    const bool new_metric = new_case || m.metric != measurements[i - 1].metric;
    if (!new_metric) rows[i][0] = "";  // another system's, for comparison
    out += Line(rows[i], widths);
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
