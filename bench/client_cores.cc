#include "bench/client_cores.h"

#include <sched.h>

namespace docent::bench {

void KeepToUpperHalfOfCores() {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof(cores), &cores) != 0) return;
  int leave = CPU_COUNT(&cores) / 2;
  for (int core = 0; core < CPU_SETSIZE && leave > 0; ++core) {
    if (!CPU_ISSET(core, &cores)) continue;
    CPU_CLR(core, &cores);
    --leave;
  }
  sched_setaffinity(0, sizeof(cores), &cores);
}

}  // namespace docent::bench
