// The words of a time trigger, read and written.
#include <algorithm>
#include <array>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/calendar/time_spec.h"
#include "graph/calendar/zones.h"

namespace docent::calendar {
namespace {

constexpr int kDayS = 24 * 3600;
constexpr int64_t kDayMs = kDayS * 1000LL;
constexpr int64_t kMaxEveryMs = 720 * 3600 * 1000LL;
// More often, nothing else would be done.
constexpr int64_t kMinEveryMs = 1000;
constexpr std::array<std::string_view, 7> kDayNames = {"monday", "tuesday",  "wednesday", "thursday",
                                                       "friday", "saturday", "sunday"};

// 0 for Monday; "Mon", "Monday" or "Mo".
std::optional<int> ParseDayName(std::string_view text) {
  const std::string lower = absl::AsciiStrToLower(ToAbsl(text));
  for (size_t i = 0; i < kDayNames.size(); ++i) {
    if (lower == kDayNames[i] ||
        ((lower.size() == 2 || lower.size() == 3) && kDayNames[i].starts_with(lower)))
      return static_cast<int>(i);
  }
  return std::nullopt;
}

std::optional<int> Number(std::string_view text, size_t digits) {
  int value = 0;
  const bool plain = !text.empty() && text.size() <= digits &&
                     std::all_of(text.begin(), text.end(), [](char c) { return absl::ascii_isdigit(c); });
  if (!plain || !absl::SimpleAtoi(ToAbsl(text), &value)) return std::nullopt;
  return value;
}

// "2026-12-24" or "2026-12-24T18:00".
std::optional<absl::CivilSecond> ParseDateTime(std::string_view text, bool* has_time) {
  const size_t t = text.find('T');
  *has_time = t != std::string_view::npos;
  const std::optional<absl::CivilDay> day = ParseDay(text.substr(0, t));
  if (!day) return std::nullopt;
  if (!*has_time) return absl::CivilSecond(*day);
  const std::optional<int> time = ParseTimeOfDay(text.substr(t + 1));
  if (!time) return std::nullopt;
  return absl::CivilSecond(*day) + *time;
}

// "10min": a whole number and s, min or h.
std::optional<int64_t> ParseEveryMs(std::string_view text) {
  const size_t unit = std::min(text.find_first_not_of("0123456789"), text.size());
  const std::optional<int> number = Number(text.substr(0, unit), 9);
  if (!number) return std::nullopt;
  const std::string_view name = FromAbsl(absl::StripAsciiWhitespace(ToAbsl(text.substr(unit))));
  const int64_t ms = name == "s" ? 1000 : name == "min" ? 60'000 : name == "h" ? 3'600'000 : 0;
  if (ms == 0 || *number == 0) return std::nullopt;
  return *number * ms;
}

class Reader {
 public:
  explicit Reader(const TimeWords& words) : words_(words) {
    ReadKind();
    ReadZone();
    ReadDays();
    ReadRange();
    ReadAligned();
    ReadMissed();
  }

  const TimeSpec& spec() const { return spec_; }  // whole where there is no fault
  std::vector<TimeFault>& faults() { return faults_; }

 private:
  const std::string* Find(const std::string& word) const {
    const auto found = words_.find(word);
    return found == words_.end() ? nullptr : &found->second;
  }

  void Fail(std::string word, std::string message, std::string hint, std::string right = "") {
    faults_.push_back({std::move(word), std::move(message), std::move(hint), std::move(right)});
  }

  bool IsUnaligned() const {
    return knows_kind_ && spec_.kind == TimeSpec::Kind::kEvery && Find("aligned") == nullptr;
  }

  void ReadKind() {
    std::vector<std::string> given;
    for (const char* word : {"between", "at", "every"}) {
      if (Find(word) != nullptr) given.emplace_back(word);
    }
    knows_kind_ = given.size() < 2;
    if (!knows_kind_)
      return Fail(given[1], absl::StrCat(given[0], " and ", given[1], " stand together"),
                  "a time is one of them; write two times, and join them in the rule's expression");
    if (given.empty() && Find("days") == nullptr && Find("from") == nullptr && Find("until") == nullptr)
      return Fail("", "it does not say which time",
                  "write between, at, every, days, from or until, for example between=\"09:00-17:00\"");
    if (const std::string* between = Find("between")) return ReadBetween(*between);
    if (const std::string* at = Find("at")) return ReadAt(*at);
    if (const std::string* every = Find("every")) return ReadEvery(*every);
  }

  void ReadBetween(const std::string& text) {
    const std::vector<std::string> ends = absl::StrSplit(text, '-');
    const std::optional<int> begin = ParseTimeOfDay(ends[0]);
    const std::optional<int> end = ends.size() == 2 ? ParseTimeOfDay(ends[1]) : std::nullopt;
    if (!begin || !end || *begin == kDayS)
      return Fail("between", absl::StrCat("\"", text, "\" is not two times of day"),
                  "write for example 09:00-17:00, or 22:00-06:00 over midnight");
    if (*begin == *end)
      return Fail("between", absl::StrCat("\"", text, "\" never holds: it ends when it begins"),
                  "write 00:00-24:00 for the whole day, or leave between out");
    spec_.begin_s = *begin;
    spec_.end_s = *end;
  }

  void ReadAt(const std::string& text) {
    bool has_time = false;
    if (text.find('T') != std::string::npos || text.find('-') != std::string::npos) {
      spec_.kind = TimeSpec::Kind::kOnce;
      const std::optional<absl::CivilSecond> once = ParseDateTime(text, &has_time);
      if (!once || !has_time) BadDate("at", text, "2026-12-24T18:00");
      for (const char* word : {"days", "from", "until"}) {
        if (Find(word) != nullptr)
          Fail(word, absl::StrCat(word, " has no effect on a single date and time"), "leave it out");
      }
      spec_.once = once.value_or(absl::CivilSecond());
      return;
    }
    spec_.kind = TimeSpec::Kind::kDaily;
    const std::optional<int> at = ParseTimeOfDay(text);
    if (!at || *at == kDayS)
      return Fail("at", absl::StrCat("\"", text, "\" is not a time of day"),
                  "write 00:00 to 23:59, for example 18:00, or a date and time: 2026-12-24T18:00");
    spec_.at_s = *at;
  }

  void ReadEvery(const std::string& text) {
    spec_.kind = TimeSpec::Kind::kEvery;
    const std::optional<int64_t> ms = ParseEveryMs(text);
    if (!ms || *ms < kMinEveryMs || *ms > kMaxEveryMs)
      return Fail("every", absl::StrCat("\"", text, "\" is not an interval"),
                  "write a whole number and s, min or h, from 1s to 720h");
    spec_.every_ms = *ms;
  }

  // A day that the calendar has not, or no date at all.
  void BadDate(const std::string& word, const std::string& text, const std::string& like) {
    const std::vector<std::string> parts = absl::StrSplit(text.substr(0, text.find('T')), '-');
    const std::optional<int> month = parts.size() == 3 ? Number(parts[1], 2) : std::nullopt;
    const std::optional<int> day = parts.size() == 3 ? Number(parts[2], 2) : std::nullopt;
    if (parts[0].size() == 4 && month && day && *month >= 1 && *month <= 12 &&
        !ParseDay(text.substr(0, text.find('T'))))
      return Fail(word, absl::StrCat("\"", text, "\" can never be: the month has no day ", *day),
                  absl::StrCat("write a date of the calendar, for example ", like));
    return Fail(word, absl::StrCat("\"", text, "\" is not a date", word == "at" ? " and time" : ""),
                absl::StrCat("write it as ", like));
  }

  void ReadZone() {
    const std::string* name = Find("zone");
    if (name == nullptr) return;
    const std::optional<absl::TimeZone> zone = FindZone(*name);
    if (!zone) {
      const std::string like = ZoneLike(*name);
      return Fail("zone", absl::StrCat("\"", *name, "\" is not a time zone"),
                  like.empty()
                      ? "write a name of the IANA time zone database, for example Europe/Berlin or UTC"
                      : absl::StrCat("did you mean ", like, "?"),
                  like);
    }
    spec_.zone_name = *name;
    spec_.zone = *zone;
  }

  void ReadDays() {
    const std::string* text = Find("days");
    if (text == nullptr) return;
    const std::optional<Weekdays> days = ParseWeekdays(*text);
    if (!days)
      return Fail("days", absl::StrCat("\"", *text, "\" is not a list of weekdays"),
                  "write for example Mon-Fri or Sat,Sun");
    if (IsUnaligned())
      return Fail("days", "days has no effect on an interval that is not aligned",
                  "add aligned=\"true\", or write a second time with days beside it");
    spec_.days = *days;
  }

  void ReadRange() {
    for (const char* word : {"from", "until"}) {
      const std::string* text = Find(word);
      if (text == nullptr) continue;
      bool has_time = false;
      std::optional<absl::CivilSecond> instant = ParseDateTime(*text, &has_time);
      if (!instant) {
        BadDate(word, *text, "2026-12-24");
        continue;
      }
      if (IsUnaligned())
        Fail(word, absl::StrCat(word, " has no effect on an interval that is not aligned"),
             "add aligned=\"true\", or write a second time beside it");
      // the last day belongs to it
      if (std::string_view(word) == "until" && !has_time)
        instant = absl::CivilSecond(absl::CivilDay(*instant) + 1);
      (std::string_view(word) == "from" ? spec_.from : spec_.until) = instant;
    }
    if (spec_.from && spec_.until && *spec_.until <= *spec_.from)
      return Fail("until", "it can never be: it ends before it begins", "write from before until");
  }

  void ReadAligned() {
    const std::string* aligned = Find("aligned");
    if (aligned == nullptr) return;
    if (*aligned != "true" && *aligned != "false")
      return Fail("aligned", absl::StrCat("aligned is \"", *aligned, "\""), "write true or false");
    if (knows_kind_ && spec_.kind != TimeSpec::Kind::kEvery)
      return Fail("aligned", "aligned has an effect with every only", "leave it out");
    spec_.aligned = *aligned == "true";
    if (spec_.every_ms == 0) return;  // it is at fault itself
    if (spec_.aligned && (spec_.every_ms > kDayMs || kDayMs % spec_.every_ms != 0))
      Fail("every", "an aligned interval divides a day, and this one does not",
           "write for example 10min, 6h or 24h, or leave aligned out");
  }

  void ReadMissed() {
    const std::string* missed = Find("missed");
    if (missed == nullptr) return;
    if (*missed != "fire" && *missed != "skip")
      return Fail("missed", absl::StrCat("missed is \"", *missed, "\""), "write fire or skip");
    if (knows_kind_ && spec_.is_level())
      return Fail("missed", "missed has no effect on a time that lasts",
                  "leave it out: whether it holds is looked at whenever the server runs");
    spec_.fire_missed = *missed == "fire";
  }

  const TimeWords& words_;
  std::vector<TimeFault> faults_;
  bool knows_kind_ = true;  // false: two words say it
  TimeSpec spec_;
};

}  // namespace

const std::vector<std::string>& TimeWordNames() {
  static const std::vector<std::string>* const names = new std::vector<std::string>{
      "between", "at", "every", "aligned", "days", "from", "until", "zone", "missed", "of"};
  return *names;
}

std::optional<Weekdays> ParseWeekdays(std::string_view text) {
  Weekdays days = 0;
  const std::vector<std::string> parts =
      absl::StrSplit(ToAbsl(text), absl::ByAnyChar(", "), absl::SkipEmpty());
  for (const std::string& part : parts) {
    const size_t dash = part.find('-');
    const std::optional<int> first = ParseDayName(std::string_view(part).substr(0, dash));
    const std::optional<int> last =
        dash == std::string::npos ? first : ParseDayName(std::string_view(part).substr(dash + 1));
    if (!first || !last) return std::nullopt;
    for (int day = *first;; day = (day + 1) % 7) {
      days = static_cast<Weekdays>(days | 1 << day);
      if (day == *last) break;
    }
  }
  return days == 0 ? std::nullopt : std::make_optional(days);
}

std::optional<int> ParseTimeOfDay(std::string_view text) {
  const std::vector<std::string> parts = absl::StrSplit(absl::StripAsciiWhitespace(ToAbsl(text)), ':');
  if (parts.size() < 2 || parts.size() > 3 || parts[1].size() != 2) return std::nullopt;
  const std::optional<int> hour = Number(parts[0], 2), minute = Number(parts[1], 2);
  const std::optional<int> second = parts.size() == 3 ? Number(parts[2], 2) : std::make_optional(0);
  if (!hour || !minute || !second || *minute > 59 || *second > 59) return std::nullopt;
  const int seconds = *hour * 3600 + *minute * 60 + *second;
  return seconds <= kDayS ? std::make_optional(seconds) : std::nullopt;
}

std::optional<absl::CivilDay> ParseDay(std::string_view text) {
  const std::vector<std::string> parts = absl::StrSplit(ToAbsl(text), '-');
  if (parts.size() != 3 || parts[0].size() != 4) return std::nullopt;
  const std::optional<int> year = Number(parts[0], 4), month = Number(parts[1], 2), day = Number(parts[2], 2);
  if (!year || !month || !day) return std::nullopt;
  const absl::CivilDay out(*year, *month, *day);  // which carries 31 February over
  if (out.month() != *month || out.day() != *day) return std::nullopt;
  return out;
}

std::optional<TimeSpec> ParseTimeSpec(const TimeWords& words, std::vector<TimeFault>* faults) {
  Reader reader(words);
  *faults = std::move(reader.faults());
  return faults->empty() ? std::make_optional(reader.spec()) : std::nullopt;
}

std::optional<TimeSpec> ParseTimeSpec(const TimeWords& words) {
  std::vector<TimeFault> faults;
  return ParseTimeSpec(words, &faults);
}

std::string TimeIri(const TimeWords& words) {
  std::vector<std::string> parts;
  for (const std::string& name : TimeWordNames()) {
    const auto word = words.find(name);
    if (word == words.end()) continue;
    std::string value = word->second;
    std::erase_if(value, [](char c) { return absl::ascii_isspace(c); });
    parts.push_back(absl::StrCat(name, "=", value));
  }
  return Concat(kTimeNs, absl::StrJoin(parts, ";"));
}

std::optional<TimeWords> WordsOfTimeIri(std::string_view iri) {
  if (!iri.starts_with(kTimeNs)) return std::nullopt;
  TimeWords words;
  for (const absl::string_view part : absl::StrSplit(ToAbsl(iri.substr(kTimeNs.size())), ';')) {
    const std::pair<std::string, std::string> word = absl::StrSplit(part, absl::MaxSplits('=', 1));
    const std::vector<std::string>& names = TimeWordNames();
    if (std::find(names.begin(), names.end(), word.first) == names.end()) return std::nullopt;
    words.insert(word);
  }
  return words;
}

std::vector<std::string> TimeIrisIn(std::string_view text) {
  std::vector<std::string> iris;
  const std::string begin = Concat("<", kTimeNs);
  for (size_t at = text.find(begin); at != std::string_view::npos; at = text.find(begin, at + 1)) {
    const size_t end = text.find_first_of("> \n", at);
    if (end == std::string_view::npos || text[end] != '>') continue;
    std::string iri(text.substr(at + 1, end - at - 1));
    if (std::find(iris.begin(), iris.end(), iri) == iris.end()) iris.push_back(std::move(iri));
  }
  return iris;
}

}  // namespace docent::calendar
