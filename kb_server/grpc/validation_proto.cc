#include "kb_server/grpc/validation_proto.h"

#include <string>

#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

void FillPlace(const std::string& file, int line, int column, v1::SourcePlace* out) {
  out->set_file(file);
  out->set_line(line);
  out->set_column(column);
}

std::string Shown(const v1::Term& term) {
  return ToDisplay(FromProto(term).value_or(Term::Literal("")));
}

}  // namespace

void ToProto(const shapes::ResultText& text, const Term& focus, const Term& value, const Term& shape,
             v1::ValidationResult* out) {
  out->set_severity(text.severity);
  ToProto(focus, out->mutable_focus());
  out->set_path(text.path);
  if (!text.value.empty()) ToProto(value, out->mutable_value());
  ToProto(shape, out->mutable_shape());
  out->set_constraint(text.component);
  out->set_message(text.message);
  for (const std::string& detail : text.details) out->add_details(detail);
  if (!text.file.empty()) FillPlace(text.file, text.line, text.column, out->mutable_place());
  if (!text.shape_file.empty())
    FillPlace(text.shape_file, text.shape_line, text.shape_column, out->mutable_shape_place());
}

shapes::ResultText FromProto(const v1::ValidationResult& result) {
  shapes::ResultText text;
  text.file = result.place().file();
  text.line = result.place().line();
  text.column = result.place().column();
  text.shape_file = result.shape_place().file();
  text.shape_line = result.shape_place().line();
  text.shape_column = result.shape_place().column();
  text.severity = result.severity();
  text.focus = Shown(result.focus());
  text.path = result.path();
  if (result.has_value()) text.value = Shown(result.value());
  text.shape = Shown(result.shape());
  text.component = result.constraint();
  text.message = result.message();
  text.details.assign(result.details().begin(), result.details().end());
  return text;
}

}  // namespace docent::server
