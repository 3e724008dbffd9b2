// Checksums of the log: the CRC32C of each record and the SHA-256 chain through all of them. SQLite does
// not notice a flipped byte in a row (measured), so the log checks for itself. Any thread.
#ifndef DOCENT_GRAPH_LOG_RECORD_CHAIN_H_
#define DOCENT_GRAPH_LOG_RECORD_CHAIN_H_

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

struct evp_md_ctx_st;  // OpenSSL's EVP_MD_CTX

namespace docent::log {

using ChainHash = std::array<unsigned char, 32>;

inline std::string_view AsBytes(const ChainHash& hash) {
  return {reinterpret_cast<const char*>(hash.data()), hash.size()};
}

// CRC-32C (Castagnoli polynomial 0x1EDC6F41, RFC 3720 appendix B.4) of several pieces as if they were one.
class Crc32c {
 public:
  Crc32c& Add(std::string_view bytes);
  Crc32c& Add(uint64_t value);  // eight bytes, little endian
  uint32_t value() const { return ~state_; }

 private:
  uint32_t state_ = 0xFFFFFFFFu;
};

// The CRC stored with a record: over its offset, epoch, the previous record's hash and its data.
uint32_t RecordCrc(uint64_t offset, uint64_t epoch, const ChainHash& previous, std::string_view data);

// The hash of a record: SHA-256 over the previous record's hash, its own offset, epoch and data. Record 1 has
// a previous hash of 32 zero bytes.
ChainHash RecordHash(uint64_t offset, uint64_t epoch, const ChainHash& previous, std::string_view data);

// The same hash, for data in pieces. One thread.
class RecordHasher {
 public:
  RecordHasher(uint64_t offset, uint64_t epoch, const ChainHash& previous);
  ~RecordHasher();
  void Add(std::string_view data);
  ChainHash Finish();  // once

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

// SHA-256 of `bytes`.
ChainHash Sha256(std::string_view bytes);

}  // namespace docent::log

#endif  // DOCENT_GRAPH_LOG_RECORD_CHAIN_H_
