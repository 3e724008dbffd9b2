#include "kb_server/clock/clock_facts.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/clock/opening_hours.h"

namespace docent::server {
namespace {

// Words of a trigger that somebody describes, and the properties that say them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kProperties = {{
    {"between", "between"},
    {"at", "atTime"},
    {"every", "every"},
    {"aligned", "aligned"},
    {"days", "onDays"},
    {"from", "validFrom"},
    {"until", "validUntil"},
    {"zone", "timeZone"},
    {"missed", "whenMissed"},
}};
constexpr std::array<std::string_view, 7> kOfHours = {"openingHoursSpecification",
                                                      "specialOpeningHoursSpecification",
                                                      "opens",
                                                      "closes",
                                                      "dayOfWeek",
                                                      "validFrom",
                                                      "validThrough"};

// Facts of the clock: subject, local name of the property in docent:, value.
struct Fact {
  std::string subject, property;
  Term value;

  friend bool operator<(const Fact& a, const Fact& b) {
    return std::tie(a.subject, a.property, a.value) < std::tie(b.subject, b.property, b.value);
  }
};

class ClockLook {
 public:
  ClockLook(const ClockTimes& now, const Dictionary& dictionary, const GraphVersion& graph,
            const std::function<bool(const std::string&)>& only)
      : now_(now), dictionary_(dictionary), graph_(graph), only_(only), reader_(dictionary, graph) {}

  ClockFacts Take() {
    ReadTold();
    std::vector<std::string> triggers = reader_.Subjects(kRdfType, Term::Iri(DocentIri("TimeTrigger")));
    Cut(&triggers);
    for (const std::string& trigger : triggers) LookAtTrigger(trigger);
    std::vector<std::string> places = PlacesWithHours(dictionary_, graph_);
    Cut(&places);
    for (const std::string& place : places) LookAtPlace(place);
    SayWhoTellsTheTime();
    for (const Fact& fact : told_) {
      if (!wanted_.contains(fact)) Change(QuadOperation::Kind::kRemove, fact);
    }
    for (const Fact& fact : wanted_) {
      if (!told_.contains(fact)) Change(QuadOperation::Kind::kAdd, fact);
    }
    return std::move(out_);
  }

 private:
  // A graph that a simulation has left says so until a clock of this world has looked at it.
  void SayWhoTellsTheTime() {
    const Fact simulated{std::string(kClockGraph), "simulatedTime", Term::Boolean(true)};
    if (!LooksAt(simulated.subject)) return;
    if (now_.simulated) wanted_.insert(simulated);
    if (!now_.simulated && told_.contains(simulated)) {
      out_.news.push_back(
          "the data folder has the times of a simulation; the clock goes on after the newest of them");
    }
  }

  bool LooksAt(const std::string& iri) const { return !only_ || only_(iri); }

  void Cut(std::vector<std::string>* subjects) {
    std::erase_if(*subjects, [this](const std::string& iri) { return !LooksAt(iri); });
    if (subjects->size() <= kTimeTriggers) return;
    out_.news.push_back(absl::StrCat("the clock looks at ", kTimeTriggers, " of ", subjects->size(),
                                     " times; the limit time_triggers is ", kTimeTriggers));
    subjects->resize(kTimeTriggers);
  }

  void ReadTold() {
    const std::optional<TermId> clock = dictionary_.FindIri(kClockGraph);
    if (!clock) return;
    graph_.ForEach({{}, {}, {}, *clock}, [this](const Quad& quad) {
      const std::string predicate = dictionary_.Decode(quad.predicate).lexical;
      const std::string subject = dictionary_.Decode(quad.subject).lexical;
      if (!predicate.starts_with(kDocentNs) || !LooksAt(subject)) return true;
      told_.insert({subject, predicate.substr(kDocentNs.size()), dictionary_.Decode(quad.object)});
      return true;
    });
  }

  std::optional<TimeMicros> Told(const std::string& subject, const std::string& property) const {
    const auto fact = told_.lower_bound({subject, property, Term::Blank("")});
    if (fact == told_.end() || fact->subject != subject || fact->property != property) return std::nullopt;
    const TimeMicros time = MicrosOfDateTime(fact->value.lexical);
    return time == 0 ? std::nullopt : std::make_optional(time);
  }

  void Want(const std::string& subject, std::string property, Term value) {
    wanted_.insert({subject, std::move(property), std::move(value)});
  }
  void WantTime(const std::string& subject, std::string property, const std::optional<TimeMicros>& time) {
    if (time) Want(subject, std::move(property), DateTimeTerm(*time));
  }

  void Change(QuadOperation::Kind kind, const Fact& fact) {
    out_.operations.push_back({kind,
                               {Term::Iri(fact.subject), Term::Iri(DocentIri(fact.property)), fact.value,
                                Term::Iri(std::string(kClockGraph))}});
  }

  void LookAgain(bool steady, const std::optional<TimeMicros>& time) {
    std::optional<TimeMicros>& next = steady ? out_.next_steady_us : out_.next_wall_us;
    if (time && (!next || *time < *next)) next = time;
  }

  calendar::TimeWords WordsOf(const std::string& trigger) const {
    if (const std::optional<calendar::TimeWords> words = calendar::WordsOfTimeIri(trigger)) return *words;
    calendar::TimeWords words;
    for (const auto& [word, property] : kProperties) {
      std::string value = reader_.Object(trigger, DocentIri(property));
      if (!value.empty()) words.emplace(word, std::move(value));
    }
    return words;
  }

  void LookAtTrigger(const std::string& trigger) {
    std::vector<calendar::TimeFault> faults;
    const std::optional<calendar::TimeSpec> spec = calendar::ParseTimeSpec(WordsOf(trigger), &faults);
    if (!spec) {
      Want(trigger, "timeFault", Term::Literal(faults.front().message));
    } else if (spec->is_level()) {
      Want(trigger, "timeHolds", Term::Boolean(spec->Holds(now_.wall_us)));
      LookAgain(false, spec->NextLook(now_.wall_us));
    } else {
      LookAtOccurrences(trigger, *spec);
    }
  }

  void LookAtOccurrences(const std::string& trigger, const calendar::TimeSpec& spec) {
    const TimeMicros now = spec.is_steady() ? now_.steady_us : now_.wall_us;
    // the graph has times to the millisecond
    const TimeMicros anchor = Told(trigger, "askedSince").value_or(now / 1000 * 1000);
    std::optional<TimeMicros> last = Told(trigger, "lastOccurrence");
    std::optional<TimeMicros> missed = Told(trigger, "missedOccurrence");
    const std::optional<TimeMicros> told_next = Told(trigger, "nextOccurrence");
    // a trigger that is described otherwise since then begins again
    const bool expected = told_next && spec.Next(*told_next - 1, anchor) == told_next;
    if (expected && *told_next <= now) {
      const TimeMicros due = spec.Last(now, anchor).value_or(*told_next);
      const bool late = now - due > kLateUs;
      if (late) {
        out_.news.push_back(absl::StrCat(trigger, ": ", DateTimeTerm(due).lexical, " was missed; ",
                                         spec.fire_missed ? "it occurs now" : "it is left out"));
      }
      if (late && !spec.fire_missed) {
        missed = due;
      } else {
        last = due;
        out_.occurs = true;
        WantTime(trigger, "occurs", due);
      }
    }
    // What has been told is not told again when the clock is set back by a little.
    TimeMicros after = now;
    for (const std::optional<TimeMicros>& done : {last, missed}) {
      if (done && *done > after && *done - now <= kSetBackUs) after = *done;
    }
    const std::optional<TimeMicros> next = spec.Next(after, anchor);
    WantTime(trigger, "askedSince", anchor);
    WantTime(trigger, "lastOccurrence", last);
    WantTime(trigger, "missedOccurrence", missed);
    WantTime(trigger, "nextOccurrence", next);
    LookAgain(spec.is_steady(), next);
  }

  void LookAtPlace(const std::string& place) {
    const OpeningHours hours = HoursOf(place, dictionary_, graph_);
    if (!hours.fault.empty()) {
      Want(place, "timeFault", Term::Literal(hours.fault));
      return;
    }
    Want(place, "openNow", Term::Boolean(hours.OpenAt(now_.wall_us)));
    LookAgain(false, hours.NextLook(now_.wall_us));
  }

  const ClockTimes now_;
  const Dictionary& dictionary_;
  const GraphVersion& graph_;
  const std::function<bool(const std::string&)>& only_;
  const GraphReader reader_;
  std::set<Fact> told_, wanted_;
  ClockFacts out_;
};

}  // namespace

ClockFacts ClockFactsAt(const ClockTimes& now, const Dictionary& dictionary, const GraphVersion& graph,
                        const std::function<bool(const std::string& iri)>& only) {
  ClockFacts facts = ClockLook(now, dictionary, graph, only).Take();
  // what occurred before is taken back in the next look, which is due at once
  for (const QuadOperation& operation : facts.operations) {
    if (operation.kind == QuadOperation::Kind::kAdd &&
        operation.quad.predicate.lexical == DocentIri("occurs"))
      facts.occurs = true;
  }
  return facts;
}

bool DescribesTime(std::string_view predicate) {
  if (predicate.starts_with(kDocentNs)) {
    const std::string_view local = predicate.substr(kDocentNs.size());
    return std::any_of(kProperties.begin(), kProperties.end(),
                       [local](const auto& property) { return property.second == local; });
  }
  for (const std::string_view space : {kSchemaNs, std::string_view("http://schema.org/")}) {
    if (predicate.starts_with(space) &&
        std::find(kOfHours.begin(), kOfHours.end(), predicate.substr(space.size())) != kOfHours.end())
      return true;
  }
  return false;
}

}  // namespace docent::server
