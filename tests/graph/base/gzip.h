// Packs bytes as gzip does, for tests of what reads them.
#ifndef DOCENT_TESTS_GRAPH_BASE_GZIP_H_
#define DOCENT_TESTS_GRAPH_BASE_GZIP_H_

#include <zlib.h>

#include <string>
#include <string_view>

namespace docent {

inline std::string Gzip(std::string_view bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    return "";
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace docent

#endif  // DOCENT_TESTS_GRAPH_BASE_GZIP_H_
