// The robot's voice: text to a sound file, by espeak-ng in a process of its own. Free functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_VOICE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_VOICE_H_

#include <chrono>
#include <functional>
#include <string>

#include "absl/status/statusor.h"

namespace docent::robot {

// How long a WAV file plays (RIFF: the format and the length of its data chunk). INVALID_ARGUMENT: not a WAV
// file.
absl::StatusOr<std::chrono::milliseconds> PlayingTime(const std::string& wav_path);

// Speaks `text` (UTF-8, English) into `wav_path` and tells how long it plays. `go_on` is asked now and then;
// when it says false the speaking ends with CANCELLED. FAILED_PRECONDITION: espeak-ng is not installed (names
// the package).
absl::StatusOr<std::chrono::milliseconds> SpeakToFile(const std::string& text, const std::string& wav_path,
                                                      const std::function<bool()>& go_on);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_VOICE_H_
