#include "kb_server/clock/wait_times.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "graph/base/text.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/read_trace.h"
#include "workflow/xml/xml_document.h"

namespace docent::server {
namespace {

// Changes of a time of day that are looked at to find when it holds next: of more than a year.
constexpr int kLooksAhead = 1000;

// What the notes before a condition say of its times (workflow/cawl/ask_compiler.cc).
struct TimeNotes {
  int64_t after_ms = 0;  // of <ext:time after="20s"/>; 0: it has none
  std::string after;
  std::vector<std::string> lasting;  // of ext:for
};

TimeNotes NotesOf(const std::string& ask) {
  TimeNotes notes;
  for (absl::string_view line : absl::StrSplit(ask, '\n')) {
    int64_t ms = 0;
    absl::string_view note = line;
    if (absl::ConsumePrefix(&note, "# after ") && absl::ConsumeSuffix(&note, " in the node")) {
      if (!xml::ParseDurationMs(FromAbsl(note), &ms) || ms <= notes.after_ms) continue;
      notes.after_ms = ms;
      notes.after = std::string(note);
    } else if (absl::ConsumePrefix(&note, "# rule ")) {
      const size_t time = note.rfind(": for at least ");
      if (time != absl::string_view::npos) notes.lasting.emplace_back(note.substr(time + 15));
    }
  }
  return notes;
}

std::string NotYetForLong(const TimeNotes& notes) {
  return absl::StrCat("its condition holds, but not yet for ",
                      notes.lasting.empty() ? "as long as it has to"
                                            : absl::StrCat("the ", absl::StrJoin(notes.lasting, " and the "),
                                                           " that it has to hold"));
}

std::optional<TimeMicros> NextOf(const GraphReader& graph, const std::string& iri, TimeMicros now_us) {
  if (const std::string next = graph.Object(iri, DocentIri("nextOccurrence")); !next.empty())
    return MicrosOfDateTime(next);
  const auto words = calendar::WordsOfTimeIri(iri);
  const auto spec = words ? calendar::ParseTimeSpec(*words) : std::nullopt;
  ReadTrace::NoteAnything();  // the time
  if (!spec || !spec->is_level() || spec->Holds(now_us)) return std::nullopt;
  TimeMicros at = now_us;
  for (int looks = 0; looks < kLooksAhead; ++looks) {
    at = spec->NextLook(at);
    if (spec->Holds(at)) return at;
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> AlternativesOf(std::string_view waits_for) {
  return absl::StrSplit(ToAbsl(waits_for), "\n# or\n");
}

std::optional<WaitTime> TimeOfNode(const GraphReader& graph, const WaitingNode& node, const std::string& ask,
                                   TimeMicros now_us) {
  const TimeNotes notes = NotesOf(ask);
  const TimeMicros after_us = node.since_us + notes.after_ms * 1000;
  if (notes.after_ms > 0) ReadTrace::NoteAnything();  // the time
  if (notes.after_ms > 0 && after_us > now_us) {
    return WaitTime{after_us,
                    absl::StrCat("its condition holds, and may open it from ", DateTimeTerm(after_us).lexical,
                                 " on, ", notes.after, " after it was entered")};
  }
  const std::string opens = graph.Object(node.iri, DocentIri("opensAt"));
  if (notes.lasting.empty() || opens.empty()) return std::nullopt;
  return WaitTime{MicrosOfDateTime(opens), absl::StrCat(NotYetForLong(notes), "; it opens it at ", opens)};
}

std::string NotYetForLong(const std::string& ask) {
  return NotYetForLong(NotesOf(ask));
}

std::optional<TimeMicros> NextTime(const GraphReader& graph, const std::string& ask, TimeMicros now_us) {
  std::optional<TimeMicros> next;
  for (const std::string& iri : calendar::TimeIrisIn(ask)) {
    if (const auto of_one = NextOf(graph, iri, now_us)) next = std::max(next.value_or(*of_one), *of_one);
  }
  return next;
}

}  // namespace docent::server
