#include "kb_server/live/resume_point.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;

const pb::FieldDescriptor* FieldOf(const pb::Descriptor& type, const char* name,
                                   pb::FieldDescriptor::CppType kind) {
  const pb::FieldDescriptor* field = type.FindFieldByName(name);
  return field != nullptr && !field->is_repeated() && field->cpp_type() == kind ? field : nullptr;
}

const pb::FieldDescriptor* Text(const pb::Descriptor& type, const char* name) {
  return FieldOf(type, name, pb::FieldDescriptor::CPPTYPE_STRING);
}

const pb::FieldDescriptor* Number(const pb::Descriptor& type, const char* name) {
  return FieldOf(type, name, pb::FieldDescriptor::CPPTYPE_UINT64);
}

}  // namespace

ResumePoint::ResumePoint(const pb::MethodDescriptor& method) {
  const pb::Descriptor& request = *method.input_type();
  const pb::Descriptor& reply = *method.output_type();
  if (Text(request, "resume") != nullptr && Text(reply, "resume") != nullptr) {
    kind_ = Kind::kText;
  } else if (Number(request, "after") != nullptr && Number(reply, "revision") != nullptr) {
    kind_ = Kind::kTurns;
  }
}

absl::Status ResumePoint::Begin(std::string_view resume, uint64_t newest, pb::Message* request) {
  const pb::Descriptor& type = *request->GetDescriptor();
  if (kind_ == Kind::kText && !resume.empty())
    request->GetReflection()->SetString(request, Text(type, "resume"), std::string(resume));
  if (kind_ != Kind::kTurns) return absl::OkStatus();
  const pb::FieldDescriptor* after = Number(type, "after");
  after_ = request->GetReflection()->GetUInt64(*request, after);
  if (after_ == 0) after_ = newest;
  if (!resume.empty()) {
    const std::vector<absl::string_view> parts = absl::StrSplit(ToAbsl(resume), ':');
    if (parts.size() != 2 || !absl::SimpleAtoi(parts[0], &after_) || !absl::SimpleAtoi(parts[1], &known_)) {
      return absl::InvalidArgumentError(absl::StrCat(
          "\"", ToAbsl(resume), "\" is no place in this stream; leave resume out to begin again"));
    }
  }
  events_ = known_;
  revision_ = known_ > 0 ? after_ + 1 : 0;
  request->GetReflection()->SetUInt64(request, after, after_);
  return absl::OkStatus();
}

std::string ResumePoint::Turns() const {
  return absl::StrCat(after_, ":", events_);
}

std::optional<std::string> ResumePoint::first() const {
  if (kind_ != Kind::kTurns) return std::nullopt;
  return Turns();
}

bool ResumePoint::IsNew(const pb::Message& reply) {
  if (kind_ != Kind::kTurns) return true;
  const uint64_t revision =
      reply.GetReflection()->GetUInt64(reply, Number(*reply.GetDescriptor(), "revision"));
  if (known_ > 0 && revision == revision_) {
    --known_;
    return false;
  }
  known_ = 0;
  if (revision != revision_) {
    revision_ = revision;
    after_ = revision - 1;
    events_ = 0;
  }
  ++events_;
  return true;
}

std::optional<std::string> ResumePoint::Next(const pb::Message& reply) const {
  if (kind_ == Kind::kTurns) return Turns();
  if (kind_ == Kind::kNone) return std::nullopt;
  const pb::Descriptor& type = *reply.GetDescriptor();
  const pb::FieldDescriptor* more = FieldOf(type, "more", pb::FieldDescriptor::CPPTYPE_BOOL);
  if (more != nullptr && reply.GetReflection()->GetBool(reply, more)) return std::nullopt;
  return reply.GetReflection()->GetString(reply, Text(type, "resume"));
}

}  // namespace docent::server
