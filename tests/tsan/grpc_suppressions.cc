// Debian's gRPC (and its libraries) is built without the thread sanitizer: the synchronisation of its
// threads is invisible, so all data passed between them looks like a race. Reports with it on the stack
// are left out. Races among our own threads, and between gRPC's threads behind our mutexes, are still
// found.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libgrpc.so\n"
         "called_from_lib:libgrpc++.so\n"
         "called_from_lib:libgpr.so\n"
         "called_from_lib:libprotobuf.so\n"
         // Strings and errors made by gRPC; the deadlock detection of mutexes. A pattern may match one
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
         // Its registry is created behind the guard of a static variable, in a library that is also
         // invisible.
         "race:spdlog::\n"
         // Its reference counts are changed in an invisible library.
         "race:absl::debian3::Status::Unref\n"
         // What a restarted server makes reaches older threads of gRPC through the start of its listener.
         "race:docent::server::Server::MakeWorkers\n"
         "race:libgrpc.so\n"
         "race:libgrpc++.so\n"
         "race:libgpr.so\n"
         "race:grpc::\n"
         "race:grpc_core::\n";
}
