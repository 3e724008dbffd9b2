#include "kb_server/work/cloud_event.h"

#include <cmath>
#include <cstdint>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/vocabulary.h"
#include "nlohmann/json.hpp"

namespace docent::server {
namespace {

using Json = nlohmann::ordered_json;

Json ValueOf(const Term& term) {
  if (term.IsBlank()) return absl::StrCat("_:", term.lexical);
  if (term.IsIri()) return term.lexical;
  if (!term.language.empty()) return {{"value", term.lexical}, {"language", term.language}};
  if (term.datatype.empty()) return term.lexical;
  const std::string datatype = term.datatype.starts_with(kXsdNs) ? term.datatype.substr(kXsdNs.size()) : "";
  int64_t whole = 0;
  double number = 0;
  if (datatype == "boolean") return term.lexical == "true" || term.lexical == "1";
  if ((datatype == "integer" || datatype == "int" || datatype == "long") &&
      absl::SimpleAtoi(term.lexical, &whole))
    return whole;
  const bool real = datatype == "decimal" || datatype == "double" || datatype == "float";
  if (real && absl::SimpleAtod(term.lexical, &number))
    return std::isfinite(number) ? Json(number) : Json(term.lexical);
  return {{"value", term.lexical}, {"datatype", term.datatype}};
}

}  // namespace

std::string ToCloudEvent(const Notification& notification) {
  Json data = Json::object();
  for (const auto& [name, value] : notification.data) data[name] = value ? ValueOf(*value) : Json();
  Json event = {{"specversion", "1.0"},
                {"id", notification.id.value()},
                {"source", notification.source},
                {"type", notification.type}};
  if (!notification.subject.empty()) event["subject"] = notification.subject;
  event["time"] = DateTimeTerm(notification.time_us).lexical;
  event["datacontenttype"] = "application/json";
  event["data"] = std::move(data);
  return event.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace docent::server
