// What a server's /metrics says.
#ifndef DOCENT_TESTS_KB_SERVER_HTTP_READ_METRIC_H_
#define DOCENT_TESTS_KB_SERVER_HTTP_READ_METRIC_H_

#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::server {

// The value of a metric without labels; a failure and -1 where it is not there.
inline double ReadMetric(uint16_t port, const std::string& name) {
  const std::string page = HttpClient(port).Ask("GET", "/metrics").body;
  const size_t at = page.find(absl::StrCat("\n", name, " "));
  double value = -1;
  EXPECT_TRUE(at != std::string::npos) << name;
  if (at == std::string::npos) return value;
  const size_t begin = at + name.size() + 2;
  EXPECT_TRUE(absl::SimpleAtod(page.substr(begin, page.find('\n', begin) - begin), &value));
  return value;
}

}  // namespace docent::server

#endif  // DOCENT_TESTS_KB_SERVER_HTTP_READ_METRIC_H_
