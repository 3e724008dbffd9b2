#include "bench/kb/kb_queries.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "bench/worlds/kb_random.h"

namespace docent::bench {
namespace {

constexpr char kPrologue[] = "PREFIX : <http://bench.example/> PREFIX d: <https://w3id.org/docent#> ";
constexpr char kParameter[] = "<http://bench.example/@P@>";

enum class Draw {
  kNone,
  kCourse,
  kDepartment,
  kUniversity,
  kProfessor,
  kUser,
  kCity,
  kCountry,
  kGenre,
  kRetailer,
  kBooth,
  kRobot,
  kNumber
};

struct Shape {
  const char* name;
  Draw draw;
  const char* select;   // what follows SELECT; null: ASK
  const char* pattern;  // inside WHERE { }
  const char* after = "";
  bool counted = true;  // has a COUNT form
};

constexpr int kPasses = 100;  // maximum over the instances of a case

// # is the parameter. Patterns are in an order that a person might choose; "badly ordered" is the worst
// order.
constexpr Shape kShapes[] = {
    {"univ: graduates of a course", Draw::kCourse, "?x", "?x :takesCourse # . ?x a :GraduateStudent"},
    {"univ: degree from own university", Draw::kNone, "?x ?y ?z",
     "?z :subOrganizationOf ?y . ?x :memberOf ?z . ?x :undergraduateDegreeFrom ?y . ?x a :GraduateStudent . "
     "?y a :University"},
    {"univ: professors of a department", Draw::kDepartment, "?x ?n ?e ?t",
     "?x :worksFor # . ?x a :FullProfessor . ?x :name ?n . ?x :email ?e . ?x :telephone ?t"},
    {"univ: students of a professor", Draw::kProfessor, "?x ?c",
     "# :teacherOf ?c . ?x :takesCourse ?c . ?x a :UndergraduateStudent"},
    {"univ: members of a university", Draw::kUniversity, "?x ?d ?e",
     "?d :subOrganizationOf # . ?x :memberOf ?d . ?x :email ?e"},
    {"univ: taught by own advisor", Draw::kNone, "?x ?y ?z",
     "?x :advisor ?y . ?y :teacherOf ?z . ?x :takesCourse ?z"},
    {"univ: all undergraduates", Draw::kNone, "?x", "?x a :UndergraduateStudent"},
    {"univ: publications badly ordered", Draw::kDepartment, "?p ?n",
     "?p a :Publication . ?p :publicationAuthor ?a . ?a :name ?n . ?a :worksFor #"},
    {"shop: what a user's contacts like", Draw::kUser, "?p ?g",
     "# :follows ?a . ?a :likes ?p . ?p :genre ?g"},
    {"shop: offers of a retailer", Draw::kRetailer, "?o ?p ?c ?v",
     "?o :offeredBy # . ?o :offers ?p . ?o :price ?v . ?p :caption ?c"},
    {"shop: older users of a city", Draw::kCity, "?u ?a", "?u :location # . ?u :age ?a FILTER(?a > 60)"},
    {"shop: reviews of a genre", Draw::kGenre, "?p ?r ?u ?s ?t",
     "?p :genre # . ?p :hasReview ?r . ?r :reviewer ?u . ?r :rating ?s OPTIONAL { ?r :title ?t }"},
    {"shop: friend reviewed what one likes", Draw::kNone, "?a ?b ?p",
     "?a :friendOf ?b . ?a :likes ?p . ?p :hasReview ?r . ?r :reviewer ?b"},
    {"shop: triangle of follows", Draw::kUser, "?b ?c", "# :follows ?b . ?b :follows ?c . # :follows ?c"},
    {"shop: badly ordered", Draw::kUser, "?x ?p ?g",
     "?x :likes ?p . ?p :genre ?g . ?p a :Product . # :friendOf ?x"},
    {"shop: ten dearest offers", Draw::kNone, "?o ?v", "?o :price ?v", "ORDER BY DESC(?v) ?o LIMIT 10",
     false},
    {"shop: mean rating by genre", Draw::kNone, "?g (COUNT(?r) AS ?n) (AVG(?s) AS ?m)",
     "?p :genre ?g . ?p :hasReview ?r . ?r :rating ?s", "GROUP BY ?g", false},
    {"shop: fans without homepage", Draw::kGenre, "?u ?p",
     "?p :genre # . ?u :likes ?p FILTER NOT EXISTS { ?u :homepage ?h }"},
    {"shop: likes minus reviewed", Draw::kCity, "?u ?p",
     "?u :location # . ?u :likes ?p MINUS { ?p :hasReview ?r . ?r :reviewer ?u }"},
    {"shop: in a country, by path", Draw::kCountry, "?u", "?u :location/:partOf+ #"},
    {"shop: circle of friends", Draw::kUser, "?f", "# :friendOf+ ?f"},
    {"shop: genres below a genre", Draw::kGenre, "?g ?p", "?g :subGenreOf* # . ?p :genre ?g"},
    {"shop: distinct genres liked in a city", Draw::kCity, "DISTINCT ?g",
     "?u :location # . ?u :likes ?p . ?p :genre ?g", "", false},
    {"shop: follows or likes of a user", Draw::kUser, "?x ?y",
     "{ # :follows ?x . ?x :follows ?y } UNION { # :likes ?x . ?x :genre ?y }"},
    {"place: robot beside a visitor", Draw::kRobot, nullptr, "# d:isAt ?b . ?v d:isAt ?b . ?v a :Visitor"},
    {"place: robot at its booth", Draw::kRobot, nullptr, "# d:isAt ?b . ?b a :Booth"},
    {"place: visitors who like their booth", Draw::kBooth, "?v ?n",
     "?v d:isAt # . # d:topic ?t . ?v d:interestedIn ?t . ?v :name ?n"},
    {"place: robots within a square", Draw::kNone, "?r ?x ?y",
     "?r a :Robot . ?r d:x ?x . ?r d:y ?y FILTER(?x > 10.0 && ?x < 20.0 && ?y > 10.0 && ?y < 30.0)"},
    {"place: idle charged robot near a visitor", Draw::kBooth, "?r ?v",
     "?v d:isAt # . ?v a :Visitor . ?r d:isAt # . ?r a :Robot . ?r d:status d:idle . ?r d:battery ?c "
     "FILTER(?c >= 50)"},
    {"place: booths without a robot", Draw::kNone, "?b",
     "?b a :Booth FILTER NOT EXISTS { ?r d:isAt ?b . ?r a :Robot }"},
    {"place: visitors by name", Draw::kNumber, "?v ?n",
     "?v a :Visitor . ?v :name ?n FILTER(CONTAINS(?n, \"@P@\"))"},
    {"place: visitors a topic", Draw::kNone, "?t (COUNT(?v) AS ?n)", "?v d:interestedIn ?t",
     "GROUP BY ?t ORDER BY DESC(?n) LIMIT 5", false},
};

// The k-th of 10,000 values of a parameter; the last tenth of them do not exist.
std::string Value(Draw draw, const KbCounts& counts, size_t k) {
  constexpr size_t kValues = 10000;
  const auto of = [k](size_t n) { return k % kValues * (n * 10 / 9 + 1) / kValues; };
  switch (draw) {
    case Draw::kNone:
      return "";
    case Draw::kCourse:
      return absl::StrCat("dept", of(counts.departments), "/course", 12 + k % 8);
    case Draw::kDepartment:
      return absl::StrCat("dept", of(counts.departments));
    case Draw::kUniversity:
      return absl::StrCat("univ", of(counts.universities));
    case Draw::kProfessor:
      return absl::StrCat("dept", of(counts.departments), "/professor", k % kProfessorsPerDepartment);
    case Draw::kUser:
      return absl::StrCat("user", of(counts.users));
    case Draw::kCity:
      return absl::StrCat("city", of(counts.cities));
    case Draw::kCountry:
      return absl::StrCat("country", of(counts.countries));
    case Draw::kGenre:
      return absl::StrCat("genre", of(counts.genres));
    case Draw::kRetailer:
      return absl::StrCat("retailer", of(counts.retailers));
    case Draw::kBooth:
      return absl::StrCat("booth", of(counts.booths));
    case Draw::kRobot:
      return absl::StrCat("robot", of(counts.robots));
    case Draw::kNumber:
      return absl::StrCat(of(counts.visitors));
  }
  return "";
}

}  // namespace

std::vector<KbCase> MakeKbCases(const KbCounts& counts, size_t instances, uint64_t seed) {
  std::vector<KbCase> cases;
  Random random(seed);
  for (const Shape& shape : kShapes) {
    std::vector<std::string> parameters;
    for (size_t i = 0; i < (shape.draw == Draw::kNone ? 1 : instances); ++i) {
      parameters.push_back(Value(shape.draw, counts, random.Below(10000)));
    }
    const std::string pattern = absl::StrReplaceAll(shape.pattern, {{"#", kParameter}});
    const auto add = [&](const std::string& form, const std::string& head, const std::string& tail) {
      cases.push_back(
          {shape.name, form, absl::StrCat(kPrologue, head, " { ", pattern, " }", tail), parameters});
    };
    if (shape.select == nullptr) {
      add("ask", "ASK", "");
      continue;
    }
    const std::string tail = *shape.after == 0 ? "" : absl::StrCat(" ", shape.after);
    add("rows", absl::StrCat("SELECT ", shape.select, " WHERE"), tail);
    if (shape.counted) add("count", "SELECT (COUNT(*) AS ?count) WHERE", "");
  }
  return cases;
}

std::string ToJobJson(const std::string& data_file, const std::vector<KbCase>& cases, int budget_ms) {
  nlohmann::json job = {
      {"data", data_file}, {"budget_ms", budget_ms}, {"passes", kPasses}, {"cases", nlohmann::json::array()}};
  for (const KbCase& c : cases) {
    job["cases"].push_back(
        {{"name", c.name}, {"form", c.form}, {"text", c.text}, {"parameters", c.parameters}});
  }
  return job.dump();
}

}  // namespace docent::bench
