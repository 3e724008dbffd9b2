// The saved state of the engine as earlier formats of snapshots had it: what they did not have is left out.
#ifndef DOCENT_TESTS_WORKFLOW_ENGINE_OLD_FORMATS_H_
#define DOCENT_TESTS_WORKFLOW_ENGINE_OLD_FORMATS_H_

#include <cstdint>
#include <string>

#include "gtest/gtest.h"
#include "workflow/engine/packed_state.h"

namespace docent::engine::test {

// Formats 4 to 14 (docs/reference/file_formats.md).
inline std::string EngineInFormat(uint64_t format, const EngineState& state) {
  const std::string bytes = *EncodeEngineState(state);
  Packed packed;
  ByteReader reader(bytes);
  Fields(reader, packed);
  AddedFields(reader, packed);
  AddedIn6(reader, packed);
  AddedIn7(reader, packed);
  AddedIn8(reader, packed);
  AddedIn9(reader, packed);
  reader(packed.last_used);
  AddedIn11(reader, packed);
  AddedIn12(reader, packed);
  AddedIn13(reader, packed);
  AddedIn14(reader, packed);
  EXPECT_TRUE(reader.AtEnd()) << "a newer format: leave out here what it added";
  ByteWriter writer;
  Fields(writer, packed);
  if (format >= 5) AddedFields(writer, packed);
  if (format >= 6) AddedIn6(writer, packed);
  if (format >= 7) AddedIn7(writer, packed);
  if (format >= 8) AddedIn8(writer, packed);
  if (format >= 9) AddedIn9(writer, packed);
  if (format >= 10) writer(packed.last_used);
  if (format >= 11) AddedIn11(writer, packed);
  if (format >= 12) AddedIn12(writer, packed);
  if (format >= 13) AddedIn13(writer, packed);
  if (format >= 14) AddedIn14(writer, packed);
  return writer.Take();
}

}  // namespace docent::engine::test

#endif  // DOCENT_TESTS_WORKFLOW_ENGINE_OLD_FORMATS_H_
