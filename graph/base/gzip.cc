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

// Bytes that one text takes while it is made; given back at the end of the scope unless they are kept.
class Counted {
 public:
  explicit Counted(MemoryUse* memory) : memory_(memory) {}
  ~Counted() { SetTo(0); }
  // False: they do not fit.
  bool SetTo(size_t bytes) {
    if (memory_ == nullptr) return true;
    if (bytes < bytes_) memory_->Release(bytes_ - bytes);
    const bool fits = bytes <= bytes_ || memory_->Add(bytes - bytes_);
    bytes_ = bytes;
    return fits;
  }
  void Keep() { memory_ = nullptr; }

 private:
  MemoryUse* memory_;
  size_t bytes_ = 0;
};

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

absl::StatusOr<std::string> Gunzip(std::string_view bytes, size_t most_bytes, std::string_view limit_name,
                                   MemoryUse* memory, Cancellation* cancellation) {
  if (bytes.size() > 2 && !IsGzip(bytes))
    return absl::InvalidArgumentError("this is not gzip data: it does not begin with the bytes 1F 8B 08");
  Inflater inflater;
  if (!inflater.ready) return absl::ResourceExhaustedError("not enough memory to unpack gzip");
  z_stream& stream = inflater.stream;
  const absl::Status too_large = absl::ResourceExhaustedError(
      absl::StrCat("unpacked, it has more bytes than the limit ", ToAbsl(limit_name), " = ", most_bytes));
  Counted counted(memory);
  std::string out;
  size_t taken = 0;
  for (int state = Z_OK;;) {
    if (state == Z_STREAM_END) {
      if (taken == bytes.size()) {
        counted.SetTo(out.size());
        counted.Keep();
        return out;
      }
      if (!IsGzip(bytes.substr(taken)) || inflateReset(&stream) != Z_OK) {
        return absl::InvalidArgumentError(
            absl::StrCat("bytes follow the end of the gzip data, at byte ", taken));
      }
    }
    const size_t given = std::min<size_t>(bytes.size() - taken, INT_MAX);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    stream.avail_in = static_cast<uInt>(given);
    const size_t before = out.size();
    const size_t room = std::min(kPiece, most_bytes - before + 1);  // one more than may come out
    const size_t grown = before + room;
    if (cancellation != nullptr) {
      if (const absl::Status status = cancellation->CheckNow(); !status.ok()) return status;
    }
    if (grown > out.capacity()) {
      const size_t doubled = std::min(2 * grown, most_bytes + 1);
      if (!counted.SetTo(doubled)) return memory->Refusal(too_large);
      out.reserve(doubled);
    }
    out.resize(grown);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(out.size() - before);
    state = inflate(&stream, Z_NO_FLUSH);
    taken += given - stream.avail_in;
    out.erase(out.size() - stream.avail_out);
    if (out.size() > most_bytes) return too_large;
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
    out.erase(out.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return out;
}

}  // namespace docent
