// Scenario s02 in numbers: the recorded drive through our localiser and through MRPT's stock filter, and the
// reference that both are held against.
#ifndef DOCENT_BENCH_REAL_LOG_H_
#define DOCENT_BENCH_REAL_LOG_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "bench/measurement.h"

namespace docent::bench {

// `scenario` is the folder of s02. Where the data set is not installed: lines with no value and that reason.
// INVALID_ARGUMENT, NOT_FOUND: the scenario's own files.
absl::StatusOr<std::vector<Measurement>> MeasureRealLog(const std::string& scenario, int seeds);

// Runs MRPT's stock filter over the log, with its own grid drawn from the recorded map and with many particles, several
// times; writes the mean of the runs to `path`. NOT_FOUND: the data set is not installed. INTERNAL: too few runs agree.
absl::Status MakeReference(const std::string& path);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_REAL_LOG_H_
