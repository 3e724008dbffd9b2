#include "graph/sparql/values/ascii_run.h"

#include <array>
#include <bit>
#include <cstring>

namespace docent::sparql {
namespace {

// Runs of a class are usually longer than a few characters, so sixteen bytes are compared at once. As signed
// numbers, bytes beyond ASCII are negative. A comparison gives -1 for true and 0 for false.
using SixteenBytes = int8_t __attribute__((vector_size(16)));
static_assert(std::endian::native == std::endian::little);

struct InWord {
  static SixteenBytes Of(SixteenBytes c) {
    const SixteenBytes lower = c | 0x20;  // of letters
    return ((lower > 'a' - 1) & (lower < 'z' + 1)) | ((c > '0' - 1) & (c < '9' + 1)) | (c == '_');
  }
  static bool Of(char c) { return Is(c, kInWord); }
};
struct InName {
  static SixteenBytes Of(SixteenBytes c) { return InWord::Of(c) | (c == '-'); }
  static bool Of(char c) { return Is(c, kInName); }
};
struct InIri {
  static SixteenBytes Of(SixteenBytes c) {
    const SixteenBytes even = c | 2;  // maps '<' to '>', '\\' to '^'
    return (c > 0x20) &
           ~((c == '"') | (even == '>') | (even == '^') | (c == '`') | ((c > '{' - 1) & (c < '}' + 1)));
  }
  static bool Of(char c) { return Is(c, kInIri); }
};
struct Ascii {
  static SixteenBytes Of(SixteenBytes c) { return c > 0; }
  static bool Of(char c) { return static_cast<signed char>(c) > 0; }
};

// The first of sixteen bytes outside the class, ignoring the first `without`; 16 if none is.
template <typename Class>
size_t FirstOther(const char* begin, size_t without) {
  SixteenBytes bytes;
  std::memcpy(&bytes, begin, sizeof(bytes));
  auto [low, high] = std::bit_cast<std::array<uint64_t, 2>>(~Class::Of(bytes));
  if (without >= 8) {
    low = 0;
    high = high >> 8 * (without - 8) << 8 * (without - 8);
  } else {
    low = low >> 8 * without << 8 * without;
  }
  if (low != 0) return static_cast<size_t>(std::countr_zero(low)) / 8;
  return high != 0 ? 8 + static_cast<size_t>(std::countr_zero(high)) / 8 : sizeof(bytes);
}

template <typename Class>
size_t RunEnd(std::string_view text, size_t at) {
  constexpr size_t kTogether = sizeof(SixteenBytes);
  for (; at + kTogether <= text.size(); at += kTogether) {
    const size_t length = FirstOther<Class>(text.data() + at, 0);
    if (length < kTogether) return at + length;
  }
  if (at < text.size() &&
      text.size() >= kTogether) {  // the last sixteen bytes, which overlap the ones before
    const size_t begin = text.size() - kTogether;
    return begin + FirstOther<Class>(text.data() + begin, at - begin);
  }
  while (at < text.size() && Class::Of(text[at])) ++at;
  return at;
}

}  // namespace

size_t WordEnd(std::string_view text, size_t at) {
  return RunEnd<InWord>(text, at);
}
size_t NameEnd(std::string_view text, size_t at) {
  return RunEnd<InName>(text, at);
}
size_t IriEnd(std::string_view text, size_t at) {
  return RunEnd<InIri>(text, at);
}
size_t AsciiEnd(std::string_view text, size_t at) {
  for (std::array<SixteenBytes, 4> some; at + sizeof(some) <= text.size();
       at += sizeof(some)) {  // reads the whole text
    std::memcpy(&some, text.data() + at, sizeof(some));
    const auto others = ~((some[0] > 0) & (some[1] > 0) & (some[2] > 0) & (some[3] > 0));
    const auto [low, high] = std::bit_cast<std::array<uint64_t, 2>>(others);
    if ((low | high) != 0) break;
  }
  return RunEnd<Ascii>(text, at);
}

}  // namespace docent::sparql
