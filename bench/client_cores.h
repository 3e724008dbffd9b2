// Processor affinity of a benchmark's clients, which share the machine with the server.
#ifndef DOCENT_BENCH_CLIENT_CORES_H_
#define DOCENT_BENCH_CLIENT_CORES_H_

namespace docent::bench {

// Restricts this thread, and the threads it starts later, to the upper half of its cores; with one core
// nothing changes. The kernel may spread an unrestricted load badly for tens of milliseconds at a time. The
// server, in a process of its own, may still use all cores.
void KeepToUpperHalfOfCores();

}  // namespace docent::bench

#endif  // DOCENT_BENCH_CLIENT_CORES_H_
