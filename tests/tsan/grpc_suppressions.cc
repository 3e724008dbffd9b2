// Debian's gRPC (and what it uses) is built without the thread sanitizer: how its threads hand things over
// cannot be seen, so everything between two of them looks like a race. Reports whose stacks pass through it
// are left out; races among our own threads, and what gRPC's threads do with them behind our mutexes, are
// still found.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libgrpc.so\n"
         "called_from_lib:libgrpc++.so\n"
         "called_from_lib:libgpr.so\n"
         "called_from_lib:libprotobuf.so\n"
         // Strings and errors that gRPC made; the search for deadlocks in mutexes. A pattern may match one
         // library.
         "called_from_lib:libabsl_cord.so\n"
         "called_from_lib:libabsl_cord_internal.so\n"
         "called_from_lib:libabsl_graphcycles_internal.so\n"
         "called_from_lib:libabsl_malloc_internal.so\n"
         "called_from_lib:libabsl_status.so\n"
         "called_from_lib:libabsl_str_format_internal.so\n"
         "called_from_lib:libabsl_strings.so\n"
         "called_from_lib:libabsl_synchronization.so\n"
         "called_from_lib:libabsl_time.so\n"
         "called_from_lib:libabsl_time_zone.so\n"
         "called_from_lib:libupb.so\n"
         // Its registry is made behind the guard of a static variable, in a library that is not seen either.
         "race:spdlog::\n"
         // Its references are counted in a library that is not seen.
         "race:absl::debian3::Status::Unref\n"
         "race:libgrpc.so\n"
         "race:libgrpc++.so\n"
         "race:libgpr.so\n"
         "race:grpc::\n"
         "race:grpc_core::\n";
}
