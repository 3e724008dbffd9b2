#include "bench/kb/kb_data.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "bench/worlds/kb_random.h"
#include "graph/rdf/vocabulary.h"

namespace docent::bench {
namespace {

constexpr size_t kDepartmentsPerUniversity = 5;

class Generator {
 public:
  Generator(std::FILE* file, uint64_t seed) : file_(file), random_(seed) {}

  KbCounts Run(size_t triples) {
    University(triples * 4 / 10);
    Shop(triples * 8 / 10);
    Place(triples);
    counts_.triples = written_;
    return counts_;
  }

 private:
  size_t Below(size_t n) { return random_.Below(n); }
  bool Chance(size_t percent) { return Below(100) < percent; }
  // Few are popular, most are not: similar to Zipf, as WatDiv's follows and likes.
  size_t Popular(size_t n) {
    const double u = (static_cast<double>(Below(1 << 20)) + 1) / (1 << 20);
    return std::min(n - 1, static_cast<size_t>(static_cast<double>(n) * u * u * u));
  }

  static std::string Iri(const std::string& name) {
    return absl::StrCat("<http://bench.example/", name, ">");
  }
  static std::string Docent(const std::string& name) { return absl::StrCat("<", DocentIri(name), ">"); }
  static std::string Text(const std::string& text) { return absl::StrCat("\"", text, "\""); }
  static std::string Typed(const std::string& text, std::string_view datatype) {
    return absl::StrCat("\"", text, "\"^^<", std::string(datatype), ">");
  }
  static std::string Integer(size_t n) { return Typed(absl::StrCat(n), kXsdInteger); }
  static std::string Metres(size_t millimetres) {
    return Typed(absl::StrFormat("%d.%03d", millimetres / 1000, millimetres % 1000), kXsdDecimal);
  }

  void Say(const std::string& s, const std::string& p, const std::string& o) {
    std::fprintf(file_, "%s %s %s .\n", s.c_str(), p.c_str(), o.c_str());
    ++written_;
  }
  void Is(const std::string& s, const std::string& type) {
    Say(s, absl::StrCat("<", std::string(kRdfType), ">"), Iri(type));
  }

  void University(size_t until) {
    for (size_t d = 0; written_ < until; ++d) {
      if (d % kDepartmentsPerUniversity == 0) {
        Is(Iri(absl::StrCat("univ", counts_.universities)), "University");
        ++counts_.universities;
      }
      Department(d);
      ++counts_.departments;
    }
  }

  void Department(size_t d) {
    const std::string dept = absl::StrCat("dept", d),
                      university = absl::StrCat("univ", counts_.universities - 1);
    Is(Iri(dept), "Department");
    Say(Iri(dept), Iri("subOrganizationOf"), Iri(university));
    for (size_t c = 0; c < kCoursesPerDepartment; ++c) {
      Is(Iri(absl::StrCat(dept, "/course", c)), c < 12 ? "Course" : "GraduateCourse");
    }
    for (size_t p = 0; p < kProfessorsPerDepartment; ++p) Professor(dept, p);
    for (size_t s = 0; s < 75; ++s) {
      const bool graduate = s >= 60;
      const std::string student = absl::StrCat(dept, "/student", s);
      Is(Iri(student), graduate ? "GraduateStudent" : "UndergraduateStudent");
      Say(Iri(student), Iri("memberOf"), Iri(dept));
      Say(Iri(student), Iri("name"), Text(absl::StrCat("Student ", d, " ", s)));
      Say(Iri(student), Iri("email"), Text(absl::StrCat("s", s, "@dept", d, ".example")));
      const size_t first = Below(6);
      for (size_t k = 0; k < 3; ++k) {
        const size_t course = graduate ? 12 + (first + k * 2) % 8 : (first + k * 5) % 12;
        Say(Iri(student), Iri("takesCourse"), Iri(absl::StrCat(dept, "/course", course)));
      }
      if (graduate) {
        Say(Iri(student), Iri("undergraduateDegreeFrom"),
            Iri(absl::StrCat("univ", Below(counts_.universities))));
      }
      if (graduate || Chance(20)) {
        Say(Iri(student), Iri("advisor"),
            Iri(absl::StrCat(dept, "/professor", Below(kProfessorsPerDepartment))));
      }
    }
  }

  void Professor(const std::string& dept, size_t p) {
    static constexpr const char* kRanks[] = {"FullProfessor", "AssociateProfessor", "AssistantProfessor",
                                             "Lecturer"};
    const std::string professor = absl::StrCat(dept, "/professor", p);
    Is(Iri(professor), kRanks[p % 4]);
    Say(Iri(professor), Iri("worksFor"), Iri(dept));
    Say(Iri(professor), Iri("name"), Text(absl::StrCat("Professor ", dept, " ", p)));
    Say(Iri(professor), Iri("email"), Text(absl::StrCat("p", p, "@", dept, ".example")));
    Say(Iri(professor), Iri("telephone"), Text(absl::StrCat("555-", Below(10000))));
    Say(Iri(professor), Iri("researchInterest"), Text(absl::StrCat("Research", Below(30))));
    for (size_t c = p; c < kCoursesPerDepartment; c += kProfessorsPerDepartment) {
      Say(Iri(professor), Iri("teacherOf"), Iri(absl::StrCat(dept, "/course", c)));
    }
    for (size_t k = 0; k < 4; ++k) {
      const std::string publication = absl::StrCat(professor, "/publication", k);
      Is(Iri(publication), "Publication");
      Say(Iri(publication), Iri("publicationAuthor"), Iri(professor));
    }
  }

  void Shop(size_t until) {
    const size_t share = until > written_ ? until - written_ : 1;
    counts_.users = share / 26;
    counts_.products = std::max<size_t>(20, share / 60);
    counts_.genres = 60;
    counts_.retailers = std::max<size_t>(5, counts_.products / 40);
    counts_.countries = 12;
    counts_.cities = 120;
    for (size_t g = 1; g < counts_.genres; ++g) {
      Say(Iri(absl::StrCat("genre", g)), Iri("subGenreOf"), Iri(absl::StrCat("genre", (g - 1) / 3)));
    }
    for (size_t c = 0; c < counts_.cities; ++c) {
      Say(Iri(absl::StrCat("city", c)), Iri("partOf"), Iri(absl::StrCat("country", c % counts_.countries)));
    }
    for (size_t p = 0; p < counts_.products; ++p) Product(p);
    for (size_t u = 0; u < counts_.users; ++u) User(u);
  }

  void Product(size_t p) {
    const std::string product = absl::StrCat("product", p);
    Is(Iri(product), "Product");
    Say(Iri(product), Iri("genre"), Iri(absl::StrCat("genre", Below(counts_.genres))));
    Say(Iri(product), Iri("caption"), Text(absl::StrCat("Product number ", p, " of a kind ", Below(500))));
    for (size_t o = 0, n = 1 + Below(3); o < n; ++o) {
      const std::string offer = absl::StrCat(product, "/offer", o);
      Say(Iri(offer), Iri("offers"), Iri(product));
      Say(Iri(offer), Iri("offeredBy"), Iri(absl::StrCat("retailer", Popular(counts_.retailers))));
      Say(Iri(offer), Iri("price"), Integer(1 + Below(5000)));
    }
    for (size_t r = 0, n = Below(5); r < n; ++r) {
      const std::string review = absl::StrCat(product, "/review", r);
      Say(Iri(product), Iri("hasReview"), Iri(review));
      Say(Iri(review), Iri("reviewer"), Iri(absl::StrCat("user", Popular(counts_.users))));
      Say(Iri(review), Iri("rating"), Integer(1 + Below(10)));
      if (Chance(40)) Say(Iri(review), Iri("title"), Text(absl::StrCat("Review ", p, " ", r)));
    }
  }

  void User(size_t u) {
    const std::string user = absl::StrCat("user", u);
    Is(Iri(user), "User");
    Say(Iri(user), Iri("location"), Iri(absl::StrCat("city", Popular(counts_.cities))));
    if (Chance(60)) Say(Iri(user), Iri("age"), Integer(16 + Below(70)));
    if (Chance(40)) Say(Iri(user), Iri("gender"), Iri(Chance(50) ? "Female" : "Male"));
    if (Chance(30)) Say(Iri(user), Iri("homepage"), Iri(absl::StrCat("page", u)));
    Several(user, "follows", "user", counts_.users, 10);
    Several(user, "likes", "product", counts_.products, 7);
    if (u % 8 != 0) Say(Iri(user), Iri("friendOf"), Iri(absl::StrCat("user", u / 8 * 8 + Below(8))));
  }

  // Adds up to `most` different ones.
  void Several(const std::string& user, const std::string& property, const std::string& what, size_t among,
               size_t most) {
    std::vector<size_t> chosen;
    for (size_t i = 0, n = Below(most + 1) + most / 2; i < n; ++i) chosen.push_back(Popular(among));
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    for (const size_t other : chosen) Say(Iri(user), Iri(property), Iri(absl::StrCat(what, other)));
  }

  void Place(size_t until) {
    const size_t share = until > written_ ? until - written_ : 1;
    counts_.visitors = share / 8;
    counts_.robots = std::max<size_t>(10, counts_.visitors / 10);
    counts_.booths = std::max<size_t>(10, counts_.visitors / 25);
    for (size_t b = 0; b < counts_.booths; ++b) {
      const std::string booth = Iri(absl::StrCat("booth", b));
      Is(booth, "Booth");
      Say(booth, Docent("topic"), Iri(absl::StrCat("topic", b % 40)));
      Say(booth, Iri("name"), Text(absl::StrCat("Booth ", b)));
    }
    for (size_t r = 0; r < counts_.robots; ++r) {
      const std::string robot = Iri(absl::StrCat("robot", r));
      Someone(robot, "Robot");
      Say(robot, Docent("battery"), Integer(Below(100)));
      Say(robot, Docent("status"), Docent(Chance(70) ? "idle" : "busy"));
    }
    for (size_t v = 0; v < counts_.visitors; ++v) {
      const std::string visitor = Iri(absl::StrCat("visitor", v));
      Someone(visitor, "Visitor");
      Say(visitor, Docent("interestedIn"), Iri(absl::StrCat("topic", Below(40))));
      Say(visitor, Iri("name"), Text(absl::StrCat("Visitor ", v)));
    }
  }

  void Someone(const std::string& who, const std::string& type) {
    Is(who, type);
    Say(who, Docent("isAt"), Iri(absl::StrCat("booth", Below(counts_.booths))));
    Say(who, Docent("x"), Metres(Below(100000)));
    Say(who, Docent("y"), Metres(Below(60000)));
    Say(who, Docent("heading"), Metres(Below(6283)));
  }

  std::FILE* file_;
  Random random_;
  KbCounts counts_;
  size_t written_ = 0;
};

}  // namespace

absl::StatusOr<KbCounts> WriteKbData(const std::string& path, size_t triples, uint64_t seed) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"), &std::fclose);
  if (file == nullptr) return absl::UnavailableError(absl::StrCat("cannot write ", path));
  const KbCounts counts = Generator(file.get(), seed).Run(triples);
  if (std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0) {
    return absl::UnavailableError(absl::StrCat("cannot write ", path, ": is the disk full?"));
  }
  return counts;
}

}  // namespace docent::bench
