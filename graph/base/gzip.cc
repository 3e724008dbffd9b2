#include "graph/base/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <climits>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {
namespace {

constexpr int kGzipWindow = 15 + 16;  // zlib's largest window, and only gzip
constexpr size_t kPiece = 64u << 10;
constexpr int kQuickly = 3;      // of zlib's 1 to 9
constexpr int kMemoryLevel = 8;  // zlib's default
constexpr size_t kMostAtOnce = size_t{1} << 30;

// Frees the stream at the end of the scope.
struct Inflater {
  Inflater() { ready = inflateInit2(&stream, kGzipWindow) == Z_OK; }
  ~Inflater() {
    if (ready) inflateEnd(&stream);
  }
  z_stream stream{};
  bool ready;
};

}  // namespace

absl::StatusOr<std::string> Gunzip(std::string_view bytes, size_t most_bytes, std::string_view limit_name) {
  if (bytes.size() > 2 && !IsGzip(bytes))
    return absl::InvalidArgumentError("this is not gzip data: it does not begin with the bytes 1F 8B 08");
  Inflater inflater;
  if (!inflater.ready) return absl::ResourceExhaustedError("not enough memory to unpack gzip");
  z_stream& stream = inflater.stream;
  std::string out;
  size_t taken = 0;
  for (int state = Z_OK;;) {
    if (state == Z_STREAM_END) {
      if (taken == bytes.size()) return out;
      if (!IsGzip(bytes.substr(taken)) || inflateReset(&stream) != Z_OK) {
        return absl::InvalidArgumentError(
            absl::StrCat("bytes follow the end of the gzip data, at byte ", taken));
      }
    }
    const size_t given = std::min<size_t>(bytes.size() - taken, INT_MAX);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    stream.avail_in = static_cast<uInt>(given);
    const size_t before = out.size();
    const size_t room = std::min(kPiece + before, most_bytes - before + 1);  // one more than may come out
    out.resize(before + std::min<size_t>(room, INT_MAX));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(out.size() - before);
    state = inflate(&stream, Z_NO_FLUSH);
    taken += given - stream.avail_in;
    out.resize(out.size() - stream.avail_out);
    if (out.size() > most_bytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat("unpacked, it has more bytes than the limit ", ToAbsl(limit_name), " = ", most_bytes));
    }
    if (state == Z_OK || state == Z_STREAM_END) continue;
    const bool cut = state == Z_BUF_ERROR && taken == bytes.size();
    return absl::InvalidArgumentError(cut ? "the gzip data ends too early: was the file cut?"
                                          : absl::StrCat("the gzip data is damaged near byte ", taken));
  }
}

std::string Gzip(std::string_view bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, kQuickly, Z_DEFLATED, kGzipWindow, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK)
    return "";
  std::string out;
  int state = Z_OK;
  for (size_t taken = 0; state != Z_STREAM_END;) {
    const size_t given = std::min<size_t>(bytes.size() - taken, kMostAtOnce);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    stream.avail_in = static_cast<uInt>(given);
    const size_t before = out.size();
    out.resize(before + deflateBound(&stream, given));
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(out.size() - before);
    state = deflate(&stream, taken + given == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    taken += given - stream.avail_in;
    out.resize(out.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return out;
}

}  // namespace docent
