#include "kb_server/clock/opening_hours.h"

#include <algorithm>
#include <array>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/calendar/zones.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"

namespace docent::server {
namespace {

constexpr int kDayS = 24 * 3600;
constexpr std::array<std::string_view, 2> kSchemaSpaces = {kSchemaNs, "http://schema.org/"};

absl::CivilSecond TimeOn(const absl::CivilDay& day, int seconds) {
  return absl::CivilSecond(day) + seconds;
}

int EndOf(const Hours& hours) {
  return *hours.closes_s < *hours.opens_s ? *hours.closes_s + kDayS : *hours.closes_s;
}

bool IsOpen(const Hours& hours) {
  return hours.opens_s && hours.closes_s && *hours.opens_s != *hours.closes_s;
}

class HoursReader {
 public:
  HoursReader(const Dictionary& dictionary, const GraphVersion& graph, std::string* fault)
      : dictionary_(dictionary), reader_(dictionary, graph), fault_(*fault) {}

  void Read(const std::string& place, std::string_view property, std::vector<Hours>* out) {
    for (const std::string_view space : kSchemaSpaces) {
      for (const Term& node : reader_.Objects(place, Concat(space, property))) {
        const std::optional<TermId> id = dictionary_.Find(node);
        if (id) out->push_back(ReadOne(*id));
      }
    }
  }

 private:
  std::vector<Term> Values(TermId node, std::string_view property) const {
    std::vector<Term> values;
    for (const std::string_view space : kSchemaSpaces) {
      std::vector<Term> of_space = reader_.Objects(node, Concat(space, property));
      values.insert(values.end(), of_space.begin(), of_space.end());
    }
    return values;
  }

  void Fail(std::string_view property, const std::string& value) {
    if (fault_.empty()) fault_ = Concat("schema:", property, " \"", value, "\" cannot be read");
  }

  std::optional<int> TimeOf(TermId node, std::string_view property) {
    const std::vector<Term> values = Values(node, property);
    if (values.empty()) return std::nullopt;
    const std::optional<int> time = calendar::ParseTimeOfDay(values.front().lexical);
    if (!time) Fail(property, values.front().lexical);
    return time;
  }

  std::optional<absl::CivilDay> DayOf(TermId node, std::string_view property) {
    const std::vector<Term> values = Values(node, property);
    if (values.empty()) return std::nullopt;
    const std::string& text = values.front().lexical;
    const std::optional<absl::CivilDay> day =
        calendar::ParseDay(std::string_view(text).substr(0, text.find('T')));
    if (!day) Fail(property, text);
    return day;
  }

  Hours ReadOne(TermId node) {
    Hours hours;
    hours.opens_s = TimeOf(node, "opens");
    hours.closes_s = TimeOf(node, "closes");
    hours.from = DayOf(node, "validFrom");
    hours.through = DayOf(node, "validThrough");
    calendar::Weekdays days = 0;
    for (const Term& value : Values(node, "dayOfWeek")) {
      // schema:Monday, or the text "Monday"
      const std::string& text = value.lexical;
      const std::optional<calendar::Weekdays> day =
          calendar::ParseWeekdays(value.IsIri() ? text.substr(text.rfind('/') + 1) : text);
      if (day)
        days = static_cast<calendar::Weekdays>(days | *day);
      else
        Fail("dayOfWeek", text);
    }
    if (days != 0) hours.days = days;
    return hours;
  }

  const Dictionary& dictionary_;
  const GraphReader reader_;
  std::string& fault_;
};

}  // namespace

bool Hours::IsOn(const absl::CivilDay& day) const {
  if ((from && day < *from) || (through && day > *through)) return false;
  return (days >> static_cast<int>(absl::GetWeekday(day)) & 1) != 0;
}

const std::vector<Hours>& OpeningHours::On(const absl::CivilDay& day) const {
  const bool is_special =
      std::any_of(special.begin(), special.end(), [&day](const Hours& hours) { return hours.IsOn(day); });
  return is_special ? special : regular;
}

bool OpeningHours::OpenAt(TimeMicros now_us) const {
  const absl::CivilDay today = calendar::DayOf(now_us, zone);
  for (const absl::CivilDay& day : {today - 1, today}) {
    for (const Hours& hours : On(day)) {
      if (!hours.IsOn(day) || !IsOpen(hours)) continue;
      if (calendar::InstantOf(TimeOn(day, *hours.opens_s), zone) <= now_us &&
          now_us < calendar::InstantOf(TimeOn(day, EndOf(hours)), zone))
        return true;
    }
  }
  return false;
}

TimeMicros OpeningHours::NextLook(TimeMicros now_us) const {
  const absl::CivilDay today = calendar::DayOf(now_us, zone);
  TimeMicros next = std::max(now_us + 1, calendar::InstantOf(absl::CivilSecond(today + 1), zone));
  for (const std::vector<Hours>* list : {&regular, &special}) {
    for (const Hours& hours : *list) {
      if (!IsOpen(hours)) continue;
      for (const absl::CivilDay& day : {today - 1, today}) {
        for (const int seconds : {*hours.opens_s, EndOf(hours)}) {
          const TimeMicros instant = calendar::InstantOf(TimeOn(day, seconds), zone);
          if (instant > now_us) next = std::min(next, instant);
        }
      }
    }
  }
  return next;
}

std::vector<std::string> PlacesWithHours(const Dictionary& dictionary, const GraphVersion& graph) {
  std::set<std::string> places;
  for (const std::string_view space : kSchemaSpaces) {
    for (const std::string_view property :
         {"openingHoursSpecification", "specialOpeningHoursSpecification"}) {
      const std::optional<TermId> predicate = dictionary.FindIri(Concat(space, property));
      if (!predicate) continue;
      graph.ForEach({{}, *predicate, {}, {}}, [&](const Quad& quad) {
        const Term subject = dictionary.Decode(quad.subject);
        if (subject.IsIri()) places.insert(subject.lexical);
        return true;
      });
    }
  }
  return {places.begin(), places.end()};
}

OpeningHours HoursOf(const std::string& place, const Dictionary& dictionary, const GraphVersion& graph) {
  OpeningHours hours;
  const std::string zone = GraphReader(dictionary, graph).Object(place, DocentIri("timeZone"));
  if (!zone.empty()) {
    const std::optional<absl::TimeZone> found = calendar::FindZone(zone);
    if (found)
      hours.zone = *found;
    else
      hours.fault = absl::StrCat("\"", zone, "\" is not a time zone");
  }
  HoursReader reader(dictionary, graph, &hours.fault);
  reader.Read(place, "openingHoursSpecification", &hours.regular);
  reader.Read(place, "specialOpeningHoursSpecification", &hours.special);
  return hours;
}

}  // namespace docent::server
