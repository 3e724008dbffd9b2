// A `docent serve` process for a benchmark, with its data folder and its addresses. One thread.
#ifndef DOCENT_BENCH_SERVER_PROCESS_H_
#define DOCENT_BENCH_SERVER_PROCESS_H_

#include <sys/types.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace docent::bench {

class ServerProcess {
 public:
  // Starts the program `docent` beside this one, on free ports of 127.0.0.1, with an empty data folder below
  // `parent_folder`.
  static absl::StatusOr<std::unique_ptr<ServerProcess>> Start(const std::string& parent_folder);
  // Ends the process and removes the folder.
  ~ServerProcess();

  const std::string& grpc_address() const { return grpc_address_; }
  const std::string& http_address() const { return http_address_; }
  // CPU time of the server so far.
  double CpuSeconds() const;
  // Memory of the server now, resident.
  double ResidentMegabytes() const;

 private:
  ServerProcess() = default;
  pid_t pid_ = -1;
  std::string folder_;
  std::string grpc_address_;
  std::string http_address_;
};

}  // namespace docent::bench

#endif  // DOCENT_BENCH_SERVER_PROCESS_H_
