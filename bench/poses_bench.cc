#include "bench/poses_bench.h"

#include <time.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "bench/command_line.h"
#include "bench/kb/kb_process.h"
#include "bench/measurement.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/turn/turn.h"

namespace docent::bench {
namespace {

constexpr uint64_t kRobots = 100;
constexpr uint64_t kWarm = 100000;  // updates before the first look at memory
constexpr const char* kProperties[] = {"x", "y", "heading", "poseTime"};

// The time of pose number `n` in microseconds.
TimeMicros TimeOf(uint64_t n) {
  return TimeMicros{1'800'000'000'000'000} + static_cast<TimeMicros>(n) * 1000 + 7;
}

// `zone_hours` east of Greenwich.
std::string DateTime(TimeMicros us, int zone_hours) {
  us += TimeMicros{zone_hours} * 3'600'000'000;
  const time_t seconds = static_cast<time_t>(us / 1'000'000);
  tm utc{};
  gmtime_r(&seconds, &utc);
  return absl::StrFormat("%04d-%02d-%02dT%02d:%02d:%02d.%06d%s", utc.tm_year + 1900, utc.tm_mon + 1,
                         utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, us % 1'000'000,
                         zone_hours == 0 ? "Z" : absl::StrFormat("%+03d:00", zone_hours));
}

// `n` thousandths in the notations of robot programs: a decimal, a double with six digits (C's %f), or all
// its digits.
Term Number(uint64_t n, uint64_t robot) {
  const double value = static_cast<double>(n) / 1000 + static_cast<double>(n % 977) * 1e-12;
  switch (robot % 3) {
    case 0:
      return Term::Literal(absl::StrFormat("%d.%03d", n / 1000, n % 1000), std::string(kXsdDecimal));
    case 1:
      return Term::Literal(absl::StrFormat("%f", value), std::string(kXsdDouble));
    default: {
      std::array<char, 32> text;
      const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
      return Term::Literal(std::string(text.data(), end), std::string(kXsdDouble));
    }
  }
}

// One robot's pose: four state properties.
WriteBatch Pose(uint64_t n) {
  const uint64_t robot = n % kRobots;
  const uint64_t mixed = n * 0x9E3779B97F4A7C15u >> 20;
  WriteBatch batch;
  batch.source = absl::StrCat("urn:robots:R", robot);
  batch.time_us = TimeOf(n);
  const Term values[] = {
      Number(mixed % 400'000, robot), Number(mixed / 7 % 300'000, robot), Number(mixed / 3 % 6283, robot),
      Term::Literal(DateTime(batch.time_us, robot % 2 == 0 ? 0 : 9), std::string(kXsdDateTime))};
  for (size_t p = 0; p < std::size(kProperties); ++p) {
    batch.operations.push_back(
        {QuadOperation::Kind::kAdd,
         {Term::Iri(batch.source), Term::Iri(DocentIri(kProperties[p])), values[p], Term()}});
  }
  return batch;
}

struct Memory {
  double anonymous = 0, index = 0, dictionary = 0, terms = 0;
};

Memory Look(const server::Stages& stages) {
  return {static_cast<double>(AnonymousBytes()), static_cast<double>(stages.writer.current().bytes()),
          static_cast<double>(stages.dictionary.bytes()), static_cast<double>(stages.dictionary.size())};
}

}  // namespace

int RunPosesBench(const std::vector<std::string>& args) {
  CLI::App app{
      "Memory under a stream of poses of a hundred robots; each batch replaces x, y, heading and time of one",
      "docent-bench poses"};
  bool json = false;
  uint64_t updates = 10'000'000;
  app.add_flag("--json", json, "One JSON object a line");
  app.add_option("--updates", updates, "Values of state properties told in all")
      ->capture_default_str()
      ->check(CLI::Range(uint64_t{200'000}, uint64_t{1} << 40));
  if (std::optional<int> code = Parse(&app, args)) return *code;
  Dictionary dictionary;
  server::Stages stages(&dictionary, nullptr, Limits{});
  WriteBatch declarations;
  for (const char* property : kProperties) {
    declarations.operations.push_back({QuadOperation::Kind::kAdd,
                                       {Term::Iri(DocentIri(property)), Term::Iri(std::string(kRdfType)),
                                        Term::Iri(DocentIri("StateProperty")), Term()}});
  }
  uint64_t offset = 0;
  GraphVersionPtr version;  // as the readers' newest
  const auto turn = [&](WriteBatch batch) {
    std::string record;
    auto result = server::RunTurn(&stages, std::move(batch), ++offset, &record);
    if (!result.ok()) {
      std::fprintf(stderr, "docent-bench: %s\n", std::string(result.status().message()).c_str());
      return false;
    }
    version = result->version;
    return true;
  };
  if (!turn(declarations)) return 2;
  constexpr uint64_t kFacts = std::size(kProperties);
  std::optional<Memory> first;
  const auto start = std::chrono::steady_clock::now();
  for (uint64_t n = 0; n < updates / kFacts; ++n) {
    if (n * kFacts == kWarm) first = Look(stages);
    if (!turn(Pose(n))) return 2;
  }
  const double seconds = SecondsSince(start);
  const Memory last = Look(stages);
  const double growth = last.anonymous / first->anonymous;
  const std::string name = absl::StrCat(updates, " updates, ", kRobots, " robots");
  std::vector<Measurement> figures;
  const auto add = [&](const char* metric, const char* unit, double value) {
    figures.push_back({"poses", name, "docent", metric, unit, {value}, ""});
  };
  add("updates, turn and record, no disk", "updates/s", static_cast<double>(updates) / seconds);
  add("anonymous memory after the first 100,000", "MB", first->anonymous / 1e6);
  add("the same at the end", "MB", last.anonymous / 1e6);
  add("end / first 100,000", "x", growth);
  add("index at the end", "kB", last.index / 1e3);
  add("dictionary entries made after the first 100,000", "terms", last.terms - first->terms);
  add("quads at the end", "quads", static_cast<double>(version->size()));
  Print(figures, json);
  return growth <= 1.1 && last.terms == first->terms ? 0 : 1;
}

}  // namespace docent::bench
