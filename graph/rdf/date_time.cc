#include "graph/rdf/date_time.h"

#include "absl/time/time.h"
#include "graph/rdf/vocabulary.h"

namespace docent {

Term DateTimeTerm(TimeMicros time_us) {
  std::string text =
      absl::FormatTime("%Y-%m-%dT%H:%M:%E3S", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
  // The canonical form has no zeros at the end of the fraction.
  while (text.back() == '0' && text.find('.') != std::string::npos) text.pop_back();
  if (text.back() == '.') text.pop_back();
  return Term::Literal(text + "Z", std::string(kXsdDateTime));
}

TimeMicros MicrosOfDateTime(const std::string& lexical) {
  absl::Time time;
  if (!absl::ParseTime(absl::RFC3339_full, lexical, &time, nullptr)) return 0;
  return absl::ToUnixMicros(time);
}

}  // namespace docent
