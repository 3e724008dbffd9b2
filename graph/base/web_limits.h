// Limits of the browser app's files and of its live connections. As in limits.h, an error at a limit gives its name and value.
#ifndef DOCENT_GRAPH_BASE_WEB_LIMITS_H_
#define DOCENT_GRAPH_BASE_WEB_LIMITS_H_

#include <cstddef>

namespace docent {

struct WebLimits {
  size_t web_files = 10000;              // files of the browser app
  size_t web_bytes = 256u << 20;         // bytes of all files of the browser app
  size_t visit_code_bytes = 1024;        // text of a QR code that leads to the visitors' page
  size_t live_streams = 256;             // streams of one live connection at the same time
  size_t live_message_bytes = 1u << 20;  // one message of a client on a live connection
  size_t live_unread_requests = 1000;    // messages of a client that does not read what it gets
  size_t live_reads_asked =
      2;                     // reads that one live connection follows and that are answered at the same time
  int live_follow_ms = 50;   // least time between two answers of a read that is followed
  int live_ping_ms = 20000;  // time after which a live connection without traffic is probed
  int live_silence_ms = 60000;  // time after which a live connection that sends nothing is closed
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_WEB_LIMITS_H_
