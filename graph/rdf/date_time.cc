#include "graph/rdf/date_time.h"

#include <chrono>
#include <cstdlib>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

// Writes a number of so many digits, which end before `end`.
void WriteDigits(unsigned number, int digits, char* end) {
  for (; digits > 0; --digits, number /= 10) *--end = static_cast<char>('0' + number % 10);
}

}  // namespace

// Most facts of a run have a time: absl::FormatTime would be a tenth of what a short run costs.
Term DateTimeTerm(TimeMicros time_us) {
  using namespace std::chrono;
  const auto time = floor<milliseconds>(sys_time<microseconds>(microseconds(time_us)));
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss<milliseconds> clock(time - day);
  const int year = static_cast<int>(date.year());
  std::string text =
      absl::StrCat(year < 0 ? "-" : "", absl::Dec(std::abs(year), absl::kZeroPad4), "-00-00T00:00:00.000");
  char* const end = text.data() + text.size();
  WriteDigits(static_cast<unsigned>(date.month()), 2, end - 16);
  WriteDigits(static_cast<unsigned>(date.day()), 2, end - 13);
  WriteDigits(static_cast<unsigned>(clock.hours().count()), 2, end - 10);
  WriteDigits(static_cast<unsigned>(clock.minutes().count()), 2, end - 7);
  WriteDigits(static_cast<unsigned>(clock.seconds().count()), 2, end - 4);
  WriteDigits(static_cast<unsigned>(clock.subseconds().count()), 3, end);
  // The canonical form has no zeros at the end of the fraction.
  const size_t point = text.size() - 4;
  while (text.size() > point + 1 && text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  text += 'Z';
  return Term::Literal(std::move(text), std::string(kXsdDateTime));
}

TimeMicros MicrosOfDateTime(const std::string& lexical) {
  absl::Time time;
  if (!absl::ParseTime(absl::RFC3339_full, lexical, &time, nullptr)) return 0;
  return absl::ToUnixMicros(time);
}

}  // namespace docent
