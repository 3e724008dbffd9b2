#include "graph/wire/text_cut.h"

#include <string>
#include <vector>

#include "graph/base/cut_text.h"

namespace docent {
namespace {

constexpr size_t kLine = 64;

}  // namespace

bool CutTexts(google::protobuf::Message* message, size_t most) {
  using Field = google::protobuf::FieldDescriptor;
  const google::protobuf::Reflection& fields = *message->GetReflection();
  std::vector<const Field*> set;
  fields.ListFields(*message, &set);
  bool cut = false;
  for (const Field* field : set) {
    const int count = field->is_repeated() ? fields.FieldSize(*message, field) : 1;
    for (int i = 0; i < count; ++i) {
      if (field->cpp_type() == Field::CPPTYPE_MESSAGE) {
        cut = CutTexts(field->is_repeated() ? fields.MutableRepeatedMessage(message, field, i)
                                            : fields.MutableMessage(message, field),
                       most) ||
              cut;
      } else if (field->type() == Field::TYPE_STRING) {
        std::string scratch;
        const std::string& text = field->is_repeated()
                                      ? fields.GetRepeatedStringReference(*message, field, i, &scratch)
                                      : fields.GetStringReference(*message, field, &scratch);
        if (text.size() <= most) continue;
        std::string shorter = CutText(text, most);
        if (field->is_repeated())
          fields.SetRepeatedString(message, field, i, std::move(shorter));
        else
          fields.SetString(message, field, std::move(shorter));
        cut = true;
      }
    }
  }
  return cut;
}

bool CutToFit(google::protobuf::Message* message, size_t most, size_t bytes) {
  bool cut = CutTexts(message, most);
  while (most > kLine && message->ByteSizeLong() > bytes) {
    most /= 4;
    cut = CutTexts(message, most) || cut;
  }
  return cut;
}

}  // namespace docent
