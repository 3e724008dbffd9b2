#include "graph/log/record_chain.h"

#include <openssl/evp.h>

#include <cstdlib>
#include <cstring>
#include <memory>

namespace docent::log {
namespace {

using TableOfEight = std::array<std::array<uint32_t, 256>, 8>;

// Slicing-by-8 (Kounavis and Berry, "A systematic approach to building high performance software-based CRC
// generators", ISCC 2005): table[k][b] is the CRC of byte b followed by k zero bytes, bit-reflected.
constexpr TableOfEight MakeTables() {
  TableOfEight tables{};
  for (uint32_t b = 0; b < 256; ++b) {
    uint32_t crc = b;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82F63B78u : 0u);
    tables[0][b] = crc;
  }
  for (uint32_t b = 0; b < 256; ++b) {
    for (size_t k = 1; k < 8; ++k)
      tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 0xFF];
  }
  return tables;
}

constexpr TableOfEight kTables = MakeTables();

std::array<char, 8> LittleEndian(uint64_t value) {
  std::array<char, 8> bytes;
  for (char& byte : bytes) {
    byte = static_cast<char>(value & 0xFF);
    value >>= 8;
  }
  return bytes;
}

// Ends the process: a failure inside OpenSSL means no memory or a broken library, and no log can be written
// then.
void Require(bool ok) {
  if (!ok) std::abort();
}

// Fetched once: OpenSSL 3 repeats the lookup at each use of EVP_sha256() (crypto(7), "Explicit fetching").
const EVP_MD* Sha256Algorithm() {
  static const EVP_MD* const algorithm = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  Require(algorithm != nullptr);
  return algorithm;
}

void Begin(EVP_MD_CTX* context) {
  Require(context != nullptr && EVP_DigestInit_ex2(context, Sha256Algorithm(), nullptr) == 1);
}

void Add(EVP_MD_CTX* context, std::string_view bytes) {
  Require(EVP_DigestUpdate(context, bytes.data(), bytes.size()) == 1);
}

void Add(EVP_MD_CTX* context, uint64_t value) {
  const auto bytes = LittleEndian(value);
  Add(context, std::string_view(bytes.data(), bytes.size()));
}

ChainHash Finish(EVP_MD_CTX* context) {
  ChainHash hash;
  Require(EVP_DigestFinal_ex(context, hash.data(), nullptr) == 1);
  return hash;
}

void BeginRecord(EVP_MD_CTX* context, uint64_t offset, uint64_t epoch, const ChainHash& previous) {
  Begin(context);
  Add(context, AsBytes(previous));
  Add(context, offset);
  Add(context, epoch);
}

// One context for each thread, reused for every record.
EVP_MD_CTX* ThreadContext() {
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  thread_local std::unique_ptr<EVP_MD_CTX, Free> context(EVP_MD_CTX_new());
  return context.get();
}

}  // namespace

Crc32c& Crc32c::Add(std::string_view bytes) {
  const auto* p = reinterpret_cast<const unsigned char*>(bytes.data());
  size_t left = bytes.size();
  uint32_t crc = state_;
  for (; left >= 8; left -= 8, p += 8) {
    crc ^= static_cast<uint32_t>(p[0]) | static_cast<uint32_t>(p[1]) << 8 |
           static_cast<uint32_t>(p[2]) << 16 | static_cast<uint32_t>(p[3]) << 24;
    crc = kTables[7][crc & 0xFF] ^ kTables[6][(crc >> 8) & 0xFF] ^ kTables[5][(crc >> 16) & 0xFF] ^
          kTables[4][crc >> 24] ^ kTables[3][p[4]] ^ kTables[2][p[5]] ^ kTables[1][p[6]] ^ kTables[0][p[7]];
  }
  for (; left > 0; --left, ++p) crc = (crc >> 8) ^ kTables[0][(crc ^ *p) & 0xFF];
  state_ = crc;
  return *this;
}

Crc32c& Crc32c::Add(uint64_t value) {
  const auto bytes = LittleEndian(value);
  return Add(std::string_view(bytes.data(), bytes.size()));
}

uint32_t RecordCrc(uint64_t offset, uint64_t epoch, const ChainHash& previous, std::string_view data) {
  return Crc32c().Add(offset).Add(epoch).Add(AsBytes(previous)).Add(data).value();
}

ChainHash RecordHash(uint64_t offset, uint64_t epoch, const ChainHash& previous, std::string_view data) {
  EVP_MD_CTX* const context = ThreadContext();
  BeginRecord(context, offset, epoch, previous);
  Add(context, data);
  return Finish(context);
}

RecordHasher::RecordHasher(uint64_t offset, uint64_t epoch, const ChainHash& previous)
    : context_(EVP_MD_CTX_new()) {
  BeginRecord(context_.get(), offset, epoch, previous);
}

RecordHasher::~RecordHasher() = default;

void RecordHasher::Free::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

void RecordHasher::Add(std::string_view data) {
  log::Add(context_.get(), data);
}

ChainHash RecordHasher::Finish() {
  return log::Finish(context_.get());
}

ChainHash Sha256(std::string_view bytes) {
  EVP_MD_CTX* const context = ThreadContext();
  Begin(context);
  Add(context, bytes);
  return Finish(context);
}

}  // namespace docent::log
