// Processor affinity of a benchmark's clients, which share the machine with the server.
#ifndef DOCENT_BENCH_CLIENT_CORES_H_
#define DOCENT_BENCH_CLIENT_CORES_H_

namespace docent::bench {

// This thread, and those that it makes from now on, keep to the upper half of the cores that it may use; with one core
// nothing changes. A load that may run anywhere is spread by the kernel as it sees fit, which may be badly for tens of
// milliseconds at a time; the server, in a process of its own, still may use all cores.
void KeepToUpperHalfOfCores();

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CLIENT_CORES_H_
