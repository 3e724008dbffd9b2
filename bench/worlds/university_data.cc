#include "bench/worlds/university_data.h"

#include <array>

#include "absl/strings/str_cat.h"
#include "bench/worlds/kb_random.h"

namespace docent::bench {
namespace {

class Writer {
 public:
  Writer(size_t count, const TripleSink& sink) : left_(count), sink_(sink) {}
  bool full() const { return left_ == 0; }
  void Tell(const std::string& s, const char* p, const std::string& o) {
    if (full()) return;
    --left_;
    sink_(s, p, o);
  }
  size_t Between(size_t low, size_t high) { return low + random_.Below(high - low + 1); }

  void University(size_t number);

 private:
  void Department(const std::string& university, size_t universities, const std::string& name);
  std::string Teacher(const std::string& department, const char* kind, size_t number, size_t universities);
  void Student(const std::string& department, bool graduate, size_t number, size_t universities);

  size_t left_;
  const TripleSink& sink_;
  Random random_{7};
  size_t courses_ = 0, graduate_courses_ = 0, professors_ = 0, publications_ = 0;
};

std::string Writer::Teacher(const std::string& department, const char* kind, size_t number,
                            size_t universities) {
  const std::string name = absl::StrCat(department, kind, number);
  Tell(name, "type", kind);
  Tell(name, "worksFor", department);
  Tell(name, "undergraduateDegreeFrom", absl::StrCat("u", Between(0, universities)));
  Tell(name, "doctoralDegreeFrom", absl::StrCat("u", Between(0, universities)));
  for (size_t i = 0; i < 2; ++i) {
    const std::string course = absl::StrCat(department, "c", courses_++);
    Tell(course, "type", "Course");
    Tell(name, "teacherOf", course);
  }
  const std::string graduate_course = absl::StrCat(department, "gc", graduate_courses_++);
  Tell(graduate_course, "type", "GraduateCourse");
  Tell(name, "teacherOf", graduate_course);
  Tell(name, "researchInterest", absl::StrCat("interest", Between(0, 29)));
  const size_t publications = Between(5, 15);
  for (size_t i = 0; i < publications; ++i) {
    const std::string publication = absl::StrCat(department, "pub", publications_++);
    Tell(publication, "type", "Article");
    Tell(publication, "publicationAuthor", name);
  }
  return name;
}

void Writer::Student(const std::string& department, bool graduate, size_t number, size_t universities) {
  const std::string name = absl::StrCat(department, graduate ? "gs" : "us", number);
  Tell(name, "type", graduate ? "GraduateStudent" : "UndergraduateStudent");
  Tell(name, "memberOf", department);
  if (graduate) {
    Tell(name, "undergraduateDegreeFrom", absl::StrCat("u", Between(0, universities)));
    Tell(name, "advisor", absl::StrCat(department, "FullProfessor", Between(0, 6)));
    for (size_t i = 0; i < 2; ++i)
      Tell(name, "takesCourse", absl::StrCat(department, "gc", Between(0, graduate_courses_ - 1)));
    if (number % 5 == 0)
      Tell(name, "teachingAssistantOf", absl::StrCat(department, "c", Between(0, courses_ - 1)));
    return;
  }
  for (size_t i = 0; i < 3; ++i)
    Tell(name, "takesCourse", absl::StrCat(department, "c", Between(0, courses_ - 1)));
  if (number % 5 == 0) Tell(name, "advisor", absl::StrCat(department, "FullProfessor", Between(0, 6)));
}

void Writer::Department(const std::string& university, size_t universities, const std::string& name) {
  courses_ = graduate_courses_ = publications_ = 0;
  Tell(name, "type", "Department");
  Tell(name, "subOrganizationOf", university);
  const size_t groups = Between(10, 20);
  for (size_t i = 0; i < groups; ++i) {
    const std::string group = absl::StrCat(name, "g", i);
    Tell(group, "type", "ResearchGroup");
    Tell(group, "subOrganizationOf", name);
  }
  size_t teachers = 0;
  const std::array<std::pair<const char*, std::pair<size_t, size_t>>, 4> kinds = {
      {{"FullProfessor", {7, 10}},
       {"AssociateProfessor", {10, 14}},
       {"AssistantProfessor", {8, 11}},
       {"Lecturer", {5, 7}}}};
  for (const auto& [kind, range] : kinds) {
    const size_t count = Between(range.first, range.second);
    for (size_t i = 0; i < count && !full(); ++i) {
      const std::string teacher = Teacher(name, kind, i, universities);
      if (teachers++ == 0) Tell(teacher, "headOf", name);
    }
  }
  if (full()) return;
  const size_t undergraduates = teachers * Between(8, 14), graduates = teachers * Between(3, 4);
  for (size_t i = 0; i < undergraduates && !full(); ++i) Student(name, false, i, universities);
  for (size_t i = 0; i < graduates && !full(); ++i) Student(name, true, i, universities);
}

void Writer::University(size_t number) {
  const std::string name = absl::StrCat("u", number);
  Tell(name, "type", "University");
  const size_t departments = Between(15, 25);
  for (size_t i = 0; i < departments && !full(); ++i)
    Department(name, number + 10, absl::StrCat(name, "d", i));
}

}  // namespace

void UniversityOntology(const TripleSink& sink) {
  constexpr std::array<std::array<const char*, 2>, 20> kSubclasses = {{{"Employee", "Person"},
                                                                       {"Faculty", "Employee"},
                                                                       {"Professor", "Faculty"},
                                                                       {"FullProfessor", "Professor"},
                                                                       {"AssociateProfessor", "Professor"},
                                                                       {"AssistantProfessor", "Professor"},
                                                                       {"Chair", "Professor"},
                                                                       {"Lecturer", "Faculty"},
                                                                       {"Student", "Person"},
                                                                       {"UndergraduateStudent", "Student"},
                                                                       {"GraduateStudent", "Student"},
                                                                       {"ResearchAssistant", "Student"},
                                                                       {"TeachingAssistant", "Person"},
                                                                       {"University", "Organization"},
                                                                       {"Department", "Organization"},
                                                                       {"ResearchGroup", "Organization"},
                                                                       {"Course", "Work"},
                                                                       {"GraduateCourse", "Course"},
                                                                       {"Research", "Work"},
                                                                       {"Article", "Publication"}}};
  constexpr std::array<std::array<const char*, 2>, 5> kSubproperties = {
      {{"headOf", "worksFor"},
       {"worksFor", "memberOf"},
       {"doctoralDegreeFrom", "degreeFrom"},
       {"mastersDegreeFrom", "degreeFrom"},
       {"undergraduateDegreeFrom", "degreeFrom"}}};
  constexpr std::array<std::array<const char*, 2>, 10> kDomains = {
      {{"advisor", "Person"},
       {"takesCourse", "Student"},
       {"teacherOf", "Faculty"},
       {"publicationAuthor", "Publication"},
       {"memberOf", "Person"},
       {"degreeFrom", "Person"},
       {"subOrganizationOf", "Organization"},
       {"teachingAssistantOf", "TeachingAssistant"},
       {"headOf", "Chair"},
       {"hasAlumnus", "University"}}};
  constexpr std::array<std::array<const char*, 2>, 9> kRanges = {{{"advisor", "Professor"},
                                                                  {"takesCourse", "Course"},
                                                                  {"teacherOf", "Course"},
                                                                  {"publicationAuthor", "Person"},
                                                                  {"memberOf", "Organization"},
                                                                  {"degreeFrom", "University"},
                                                                  {"subOrganizationOf", "Organization"},
                                                                  {"teachingAssistantOf", "Course"},
                                                                  {"hasAlumnus", "Person"}}};
  for (const auto& [a, b] : kSubclasses) sink(a, "subClassOf", b);
  for (const auto& [a, b] : kSubproperties) sink(a, "subPropertyOf", b);
  for (const auto& [a, b] : kDomains) sink(a, "domain", b);
  for (const auto& [a, b] : kRanges) sink(a, "range", b);
  sink("subOrganizationOf", "type", "TransitiveProperty");
  sink("memberOf", "inverseOf", "member");
  sink("degreeFrom", "inverseOf", "hasAlumnus");
}

void UniversityFacts(size_t count, const TripleSink& sink) {
  Writer writer(count, sink);
  for (size_t i = 0; !writer.full(); ++i) writer.University(i);
}

}  // namespace docent::bench
