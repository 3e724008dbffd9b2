// The robot's voice: converts text to a sound file, with espeak-ng in a process of its own. Free functions;
// any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_VOICE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_VOICE_H_

#include <chrono>
#include <functional>
#include <string>

#include "absl/status/statusor.h"

namespace docent::robot {

// Playing time of a WAV file (RIFF: the format and the length of its data chunk). INVALID_ARGUMENT: not a WAV
// file.
absl::StatusOr<std::chrono::milliseconds> PlayingTime(const std::string& wav_path);

// Speaks `text` (UTF-8) into `wav_path` and returns the playing time. `language` is a language tag; empty means
// English. `go_on` is polled; when it returns false, speaking ends with CANCELLED. FAILED_PRECONDITION:
// espeak-ng is not installed (names the package). INVALID_ARGUMENT: the voice does not have the language.
absl::StatusOr<std::chrono::milliseconds> SpeakToFile(const std::string& text, const std::string& wav_path,
                                                      const std::function<bool()>& go_on,
                                                      const std::string& language = "");

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_VOICE_H_
