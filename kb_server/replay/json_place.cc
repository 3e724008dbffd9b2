#include "kb_server/replay/json_place.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace docent::server {

void JsonPlace::Wrong(const std::string& what) const {
  if (wrong_->ok())
    *wrong_ = absl::InvalidArgumentError(absl::StrCat(place_.empty() ? "the file" : place_, " ", what));
}

JsonPlace JsonPlace::At(const char* name) const {
  const std::string place = place_.empty() ? name : absl::StrCat(place_, ".", name);
  if (value_ != nullptr && !value_->is_object()) Wrong("is no object");
  if (value_ == nullptr || !value_->is_object()) return {nullptr, place, wrong_};
  const auto member = value_->find(name);
  return {member == value_->end() ? nullptr : &*member, place, wrong_};
}

std::string JsonPlace::Text() const {
  if (value_ == nullptr) {
    Wrong("is missing");
  } else if (!value_->is_string()) {
    Wrong("is no text");
  } else {
    return value_->get_ref<const std::string&>();
  }
  return "";
}

uint64_t JsonPlace::Number() const {
  if (value_ == nullptr)
    Wrong("is missing");
  else if (!value_->is_number_unsigned())
    Wrong("is no whole number from 0");
  else
    return value_->get<uint64_t>();
  return 0;
}

bool JsonPlace::IsTrue() const {
  if (value_ == nullptr) return false;
  if (value_->is_boolean()) return value_->get<bool>();
  Wrong("is neither true nor false");
  return false;
}

double JsonPlace::Fraction() const {
  if (value_ == nullptr) return 0;
  if (value_->is_number()) return value_->get<double>();
  Wrong("is no number");
  return 0;
}

std::vector<JsonPlace> JsonPlace::Items() const {
  std::vector<JsonPlace> items;
  if (value_ == nullptr) return items;
  if (!value_->is_array()) {
    Wrong("is no list");
    return items;
  }
  for (size_t i = 0; i < value_->size(); ++i)
    items.push_back({&(*value_)[i], absl::StrCat(place_, "[", i, "]"), wrong_});
  return items;
}

std::vector<std::pair<std::string, JsonPlace>> JsonPlace::Members() const {
  std::vector<std::pair<std::string, JsonPlace>> members;
  if (value_ == nullptr) return members;
  if (!value_->is_object()) {
    Wrong("is no object");
    return members;
  }
  for (auto member = value_->begin(); member != value_->end(); ++member)
    members.emplace_back(member.key(),
                         JsonPlace(&member.value(), absl::StrCat(place_, ".", member.key()), wrong_));
  return members;
}

std::string JsonPlace::Lines() const {
  std::vector<std::string> lines;
  for (const JsonPlace& line : Items()) lines.push_back(line.Text());
  return absl::StrJoin(lines, "\n");
}

}  // namespace docent::server
