// Debian's gRPC is built without the thread sanitizer: how its threads hand things over cannot be seen, so everything
// between two of them looks like a race. Reports whose stacks pass through it are left out; races among our own threads,
// and what gRPC's threads do with them behind our mutexes, are still found.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libgrpc.so\n"
         "called_from_lib:libgrpc++.so\n"
         "called_from_lib:libgpr.so\n"
         "race:libgrpc.so\n"
         "race:libgrpc++.so\n"
         "race:libgpr.so\n"
         "race:grpc::\n"
         "race:grpc_core::\n";
}
