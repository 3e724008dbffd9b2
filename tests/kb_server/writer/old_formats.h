// Snapshots as earlier formats had them: what they did not have is left out.
#ifndef DOCENT_TESTS_KB_SERVER_WRITER_OLD_FORMATS_H_
#define DOCENT_TESTS_KB_SERVER_WRITER_OLD_FORMATS_H_

#include <cstdint>
#include <string>

#include "graph/base/archive.h"
#include "gtest/gtest.h"
#include "kb_server/writer/server_state.h"
#include "tests/workflow/engine/old_formats.h"

namespace docent::server::test {

// Formats 4 to 14 (docs/reference/file_formats.md).
inline std::string StateInFormat(uint64_t format, ServerState state, const Dictionary& dictionary) {
  if (format < 7) state.versions = {};
  if (format < 6) state.events.clear();
  std::string bytes = *EncodeState(state, dictionary);
  EXPECT_EQ(bytes[0], 14) << "a newer format: leave out here what it added";
  bytes[0] = static_cast<char>(format);
  const auto as_text = [](const std::string& text) {
    ByteWriter writer;
    writer.Text(text);
    return writer.Take();
  };
  const std::string engine = as_text(*engine::EncodeEngineState(state.engine));
  const size_t at = bytes.find(engine);
  EXPECT_NE(at, std::string::npos);
  bytes.replace(at, engine.size(), as_text(engine::test::EngineInFormat(format, state.engine)));
  if (format < 11) {
    ByteWriter digests;
    digests.Varint(state.requests.size());
    for (const RememberedRequestPtr& request : state.requests) digests.Varint(request->digest);
    const std::string section = digests.Take();
    EXPECT_TRUE(bytes.ends_with(section));
    bytes.resize(bytes.size() - section.size());
  }
  // Each of these sections was written empty: as its length, 0.
  for (const uint64_t since : {7, 6}) {
    if (format >= since) continue;
    EXPECT_EQ(bytes.back(), 0);
    bytes.pop_back();
  }
  return bytes;
}

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_WRITER_OLD_FORMATS_H_
