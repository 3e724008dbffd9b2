// Measurements of scenario s02: the recorded drive through our localiser and through MRPT's stock filter,
// compared with a common reference.
#ifndef DOCENT_BENCH_REAL_LOG_H_
#define DOCENT_BENCH_REAL_LOG_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "bench/measurement.h"

namespace docent::bench {

// `scenario` is the folder of s02. If the data set is not installed: lines without a value and with the
// reason. INVALID_ARGUMENT, NOT_FOUND: the scenario's own files.
absl::StatusOr<std::vector<Measurement>> MeasureRealLog(const std::string& scenario, int seeds);

// Runs MRPT's stock filter over the log several times, with its own grid drawn from the recorded map and with
// many particles; writes the mean of the runs to `path`. NOT_FOUND: the data set is not installed. INTERNAL:
// too few runs agree.
absl::Status MakeReference(const std::string& path);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_REAL_LOG_H_
