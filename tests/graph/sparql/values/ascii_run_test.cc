#include "graph/sparql/values/ascii_run.h"

#include <gtest/gtest.h>

#include <string>

namespace docent::sparql {
namespace {

TEST(AsciiRun, EndsAtEachByteThatIsOfAnotherClass) {
  for (size_t size = 1; size < 40; ++size) {
    for (size_t place = 0; place < size; ++place) {
      for (int c = 0; c < 256; ++c) {
        std::string text(size, 'a');
        const char byte = static_cast<char>(c);
        text[place] = byte;
        for (size_t at = 0; at <= place; at += 3) {
          ASSERT_EQ(WordEnd(text, at), Is(byte, kInWord) ? size : place)
              << size << ' ' << place << ' ' << c << ' ' << at;
          ASSERT_EQ(NameEnd(text, at), Is(byte, kInName) ? size : place)
              << size << ' ' << place << ' ' << c << ' ' << at;
          ASSERT_EQ(IriEnd(text, at), Is(byte, kInIri) ? size : place)
              << size << ' ' << place << ' ' << c << ' ' << at;
          ASSERT_EQ(AsciiEnd(text, at), c > 0 && c < 128 ? size : place)
              << size << ' ' << place << ' ' << c << ' ' << at;
        }
        ASSERT_EQ(WordEnd(text, place + 1), size);  // what stands before does not count
      }
    }
  }
  EXPECT_EQ(WordEnd("", 0), 0u);
  EXPECT_EQ(IriEnd(std::string(16, 'a'), 16), 16u);
}

}  // namespace
}  // namespace docent::sparql
