#include "graph/wire/message_memory.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <climits>

#include "absl/container/flat_hash_map.h"

namespace docent {
namespace {

namespace pb = google::protobuf;
using Wire = pb::internal::WireFormatLite;

constexpr int kNesting = 100;            // as protobuf's own parser allows
constexpr size_t kPointer = 2 * 8;       // of an element in a list that has grown twofold
constexpr size_t kString = 32;           // without its text
constexpr size_t kShortString = 15;      // bytes that stand in the string itself
constexpr size_t kBlock = 16;            // that the allocator adds
constexpr size_t kUnknown = 2 * 16 + 8;  // a field that the type does not have
constexpr size_t kMapNode = 64;
constexpr size_t kScalar = 2 * 8;

// Walks the fields of one message and of those inside it.
class Walk {
 public:
  Walk(pb::io::ZeroCopyInputStream* bytes, size_t most) : input_(bytes), most_(most) {
    input_.SetTotalBytesLimit(INT_MAX);
  }

  // False: it is malformed.
  bool Message(const pb::Descriptor* type) {
    memory_ += SizeOf(type) + kBlock;
    return Fields(type, 0) && input_.ConsumedEntireMessage();
  }
  size_t memory() const { return memory_; }
  bool beyond() const { return memory_ > most_; }

 private:
  bool Fields(const pb::Descriptor* type, int depth) {
    while (!beyond()) {
      const uint32_t tag = input_.ReadTagNoLastTag();
      if (tag == 0) return input_.BytesUntilLimit() <= 0;
      if (!Field(type, tag, depth)) return false;
    }
    return false;
  }

  bool Field(const pb::Descriptor* type, uint32_t tag, int depth) {
    const pb::FieldDescriptor* field = type->FindFieldByNumber(Wire::GetTagFieldNumber(tag));
    if (field == nullptr) memory_ += kUnknown;
    if (Wire::GetTagWireType(tag) != Wire::WIRETYPE_LENGTH_DELIMITED) {
      if (field != nullptr && field->is_repeated()) memory_ += kScalar;
      const int begin = input_.CurrentPosition();
      if (!Wire::SkipField(&input_, tag)) return false;
      // A group, which no type here has: fields of two bytes each at least.
      if (Wire::GetTagWireType(tag) == Wire::WIRETYPE_START_GROUP)
        memory_ += kUnknown * static_cast<size_t>(input_.CurrentPosition() - begin) / 2;
      return true;
    }
    uint32_t length = 0;
    if (!input_.ReadVarint32(&length) || length > INT_MAX) return false;
    if (field != nullptr && field->cpp_type() == pb::FieldDescriptor::CPPTYPE_MESSAGE)
      return Inside(*field, static_cast<int>(length), depth);
    const bool text = field == nullptr || field->cpp_type() == pb::FieldDescriptor::CPPTYPE_STRING;
    // Numbers that stand together: one byte may be one of eight, in a list that has grown twofold.
    memory_ += text ? kPointer + kString + kBlock + (length > kShortString ? length + kBlock : 0)
                    : kScalar * size_t{length};
    return input_.Skip(static_cast<int>(length));
  }

  bool Inside(const pb::FieldDescriptor& field, int length, int depth) {
    const pb::Descriptor* type = field.message_type();
    memory_ += kPointer + kBlock + SizeOf(type) + (field.is_map() ? kMapNode : 0);
    if (depth == kNesting) return false;
    const auto limit = input_.PushLimit(length);
    if (!Fields(type, depth + 1) || input_.BytesUntilLimit() != 0) return false;
    input_.PopLimit(limit);
    return true;
  }

  size_t SizeOf(const pb::Descriptor* type) {
    size_t& size = sizes_[type];
    if (size == 0) {
      const pb::Message* prototype = pb::MessageFactory::generated_factory()->GetPrototype(type);
      size = prototype != nullptr ? prototype->SpaceUsedLong() : sizeof(pb::Message);
    }
    return size;
  }

  pb::io::CodedInputStream input_;
  const size_t most_;
  size_t memory_ = 0;
  absl::flat_hash_map<const pb::Descriptor*, size_t> sizes_;
};

}  // namespace

std::optional<size_t> MemoryOfMessage(const pb::Descriptor& type, pb::io::ZeroCopyInputStream* bytes,
                                      size_t most) {
  Walk walk(bytes, most);
  if (!walk.Message(&type) && !walk.beyond()) return std::nullopt;
  return walk.memory();
}

std::optional<size_t> MemoryOfMessage(const pb::Descriptor& type, std::string_view bytes, size_t most) {
  pb::io::ArrayInputStream input(bytes.data(), static_cast<int>(std::min<size_t>(bytes.size(), INT_MAX)));
  return MemoryOfMessage(type, &input, most);
}

}  // namespace docent
