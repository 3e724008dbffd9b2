// One measured figure, and its two output forms: a table for people, one JSON object a line for machines.
// Shared by all benchmarks. Values; any thread.
#ifndef DOCENT_BENCH_MEASUREMENT_H_
#define DOCENT_BENCH_MEASUREMENT_H_

#include <string>
#include <vector>

namespace docent::bench {

struct Measurement {
  std::string bench;         // "localisation"
  std::string name;          // the case, "s01 tracking"
  std::string system;        // "docent" or the peer's name
  std::string metric;        // "position error, RMSE"
  std::string unit;          // "mm"
  std::vector<double> runs;  // one figure a run; empty: not measured
  std::string reason;        // why `runs` is empty
};

// Median, the mean of the two middle ones for an even count. Requires at least one value.
double Median(std::vector<double> values);

// The value below which `share` of them lie, 0 to 1; 0 of none.
double Percentile(std::vector<double> values, double share);

// {"bench":…,"case":…,"system":…,"metric":…,"unit":…,"value":median,"min":…,"max":…,"runs":n}; value null and a
// "reason" where nothing was measured.
std::string ToJsonLine(const Measurement& measurement);

// A table with the cases and metrics in the order given, one row a measurement.
std::string ToTable(const std::vector<Measurement>& measurements);

// Prints to standard output in one of these forms.
void Print(const std::vector<Measurement>& measurements, bool json);

// CPU time of this process in milliseconds: the basis of figures on a shared machine.
double CpuMillis();

}  // namespace docent::bench

#endif  // DOCENT_BENCH_MEASUREMENT_H_
