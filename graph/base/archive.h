// Binary serialisation for snapshots: one `Fields` function of a type both writes and reads it, so the two
// cannot differ.
//
//   template <class Archive> void Fields(Archive& a, Robot& r) { a(r.name, r.speed, r.steps); }
//   ByteWriter w;  w(robot);  std::string bytes = w.Take();
//   ByteReader r(bytes);  r(robot);  if (!r.AtEnd()) …  // damaged
//
// Integers are varints (signed ones zigzag); texts and lists begin with their length. A reader never reads
// past the end of its bytes and never allocates more than they can hold. After damage the reader is !ok(),
// and the values are unspecified. Values; any thread.
#ifndef DOCENT_GRAPH_BASE_ARCHIVE_H_
#define DOCENT_GRAPH_BASE_ARCHIVE_H_

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "graph/base/ids.h"

namespace docent {

template <class Archive, class Tag>
void Fields(Archive& a, NameOf<Tag>& name) {
  std::string value = name.value();
  a(value);
  if constexpr (Archive::kReads) name = NameOf<Tag>(std::move(value));
}

template <class Archive>
void Fields(Archive& a, Revision& revision) {
  uint64_t value = revision.value();
  a(value);
  if constexpr (Archive::kReads) revision = Revision(value);
}

class ByteWriter {
 public:
  static constexpr bool kReads = false;

  template <class... Values>
  void operator()(const Values&... values) {
    (Put(values), ...);
  }
  void Varint(uint64_t value) {
    while (value >= 0x80) {
      bytes_.push_back(static_cast<char>(value | 0x80));
      value >>= 7;
    }
    bytes_.push_back(static_cast<char>(value));
  }
  void Signed(int64_t value) {
    Varint(static_cast<uint64_t>(value) << 1 ^ static_cast<uint64_t>(value >> 63));
  }
  void Text(std::string_view text) {
    Varint(text.size());
    bytes_.append(text);
  }
  size_t size() const { return bytes_.size(); }
  // Reserves space for about `bytes` more bytes.
  void Reserve(size_t bytes) { bytes_.reserve(bytes); }
  std::string Take() { return std::move(bytes_); }

 private:
  void Put(bool value) { bytes_.push_back(value ? 1 : 0); }
  template <std::unsigned_integral T>
  void Put(T value) {
    Varint(value);
  }
  template <std::signed_integral T>
  void Put(T value) {
    Signed(value);
  }
  template <class T>
  requires std::is_enum_v<T>
  void Put(T value) { Varint(static_cast<uint64_t>(value)); }
  void Put(double value) { Varint(std::bit_cast<uint64_t>(value)); }
  void Put(const std::string& text) { Text(text); }
  template <class A, class B>
  void Put(const std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class T>
  void Put(const std::optional<T>& value) {
    Put(value.has_value());
    if (value) Put(*value);
  }
  template <class T>
  void Put(const std::vector<T>& list) {
    PutAll(list);
  }
  template <class T>
  void Put(const std::set<T>& set) {
    PutAll(set);
  }
  template <class K, class V>
  void Put(const std::map<K, V>& map) {
    PutAll(map);
  }
  template <class List>
  void PutAll(const List& list) {
    Varint(list.size());
    for (const auto& value : list) Put(value);
  }
  template <class T>
  requires std::is_class_v<T>
  void Put(const T& value) {
    Fields(*this, const_cast<T&>(value));  // writes nothing into it
  }

  std::string bytes_;
};

class ByteReader {
 public:
  static constexpr bool kReads = true;

  // `bytes` must outlive the reader.
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}

  bool ok() const { return ok_; }
  // True if all bytes were read without an error.
  bool AtEnd() const { return ok_ && left_.empty(); }
  void Fail() {
    ok_ = false;
    left_ = {};
  }

  template <class... Values>
  void operator()(Values&... values) {
    (Get(values), ...);
  }
  uint64_t Varint() {
    uint64_t value = 0;
    for (int shift = 0; shift < 64 && !left_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(left_[0]);
      left_.remove_prefix(1);
      value |= static_cast<uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80) return value;
    }
    Fail();
    return 0;
  }
  int64_t Signed() {
    const uint64_t value = Varint();
    return static_cast<int64_t>(value >> 1) ^ -static_cast<int64_t>(value & 1);
  }
  // The view lives as long as the bytes.
  std::string_view Text() {
    const size_t size = Count();
    const std::string_view text = left_.substr(0, size);
    left_.remove_prefix(size);
    return text;
  }
  // Reads the length of a list whose elements take at least one byte each.
  size_t Count() {
    const uint64_t count = Varint();
    if (count <= left_.size()) return count;
    Fail();
    return 0;
  }

 private:
  void Get(bool& value) { value = Varint() != 0; }
  template <std::unsigned_integral T>
  void Get(T& value) {
    value = static_cast<T>(Varint());
  }
  template <std::signed_integral T>
  void Get(T& value) {
    value = static_cast<T>(Signed());
  }
  template <class T>
  requires std::is_enum_v<T>
  void Get(T& value) { value = static_cast<T>(Varint()); }
  void Get(double& value) { value = std::bit_cast<double>(Varint()); }
  void Get(std::string& text) { text = Text(); }
  template <class A, class B>
  void Get(std::pair<A, B>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class T>
  void Get(std::optional<T>& value) {
    bool there = false;
    Get(there);
    value.reset();
    if (there) Get(value.emplace());
  }
  template <class T>
  void Get(std::vector<T>& list) {
    list.clear();
    for (size_t left = Count(); left > 0 && ok_; --left) Get(list.emplace_back());
  }
  template <class T>
  void Get(std::set<T>& set) {
    set.clear();
    for (size_t left = Count(); left > 0 && ok_; --left) {
      T value{};
      Get(value);
      set.insert(set.end(), std::move(value));
    }
  }
  template <class K, class V>
  void Get(std::map<K, V>& map) {
    map.clear();
    for (size_t left = Count(); left > 0 && ok_; --left) {
      std::pair<K, V> entry;
      Get(entry);
      map.insert(map.end(), std::move(entry));
    }
  }
  template <class T>
  requires std::is_class_v<T>
  void Get(T& value) { Fields(*this, value); }

  std::string_view left_;
  bool ok_ = true;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_ARCHIVE_H_
