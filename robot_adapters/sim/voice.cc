#include "robot_adapters/sim/voice.h"

#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <thread>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "robot_adapters/sim/text_file.h"

extern char** environ;

namespace docent::robot {
namespace {

// RIFF is little-endian.
uint32_t ReadU32(const char* bytes) {
  uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

// The child's exit code, or an error. The child must not inherit blocked signals, because they end it.
absl::StatusOr<int> RunChild(const std::vector<std::string>& arguments, const std::function<bool()>& go_on) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  const int error = posix_spawnp(&child, argv[0], nullptr, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  if (error == ENOENT) {
    return absl::FailedPreconditionError(
        absl::StrCat(arguments[0], " is not installed; the Debian package espeak-ng has it"));
  }
  if (error != 0) return absl::ErrnoToStatus(error, absl::StrCat("cannot start ", arguments[0]));
  while (true) {
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (ended < 0 && errno != EINTR) return absl::ErrnoToStatus(errno, "cannot wait for the voice");
    if (!go_on()) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return absl::CancelledError("stopped while preparing to speak");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

// The voice of espeak-ng for a language tag: "de-AT" is "de-at".
absl::StatusOr<std::string> VoiceOf(const std::string& language) {
  constexpr size_t kLongestTag = 35;  // RFC 5646, section 4.4.1
  if (language.empty() || absl::EqualsIgnoreCase(language, "en")) return std::string("en-gb");
  const bool is_tag = language.size() <= kLongestTag && language[0] != '-' &&
                      std::all_of(language.begin(), language.end(),
                                  [](unsigned char c) { return absl::ascii_isalnum(c) || c == '-'; });
  if (!is_tag) return absl::InvalidArgumentError(absl::StrCat("\"", language, "\" is not a language tag"));
  return absl::AsciiStrToLower(language);
}

}  // namespace

absl::StatusOr<std::chrono::milliseconds> PlayingTime(const std::string& wav_path) {
  std::ifstream in(wav_path, std::ios::binary | std::ios::ate);
  const int64_t size = in ? static_cast<int64_t>(in.tellg()) : 0;
  in.seekg(0);
  char head[12];
  if (!in.read(head, sizeof head) || std::memcmp(head, "RIFF", 4) != 0 ||
      std::memcmp(head + 8, "WAVE", 4) != 0) {
    return absl::InvalidArgumentError(absl::StrCat(wav_path, " is not a WAV file"));
  }
  uint32_t bytes_per_s = 0;
  for (char chunk[8]; in.read(chunk, sizeof chunk);) {
    const int64_t length = ReadU32(chunk + 4);
    if (std::memcmp(chunk, "data", 4) == 0 && bytes_per_s > 0) {
      const int64_t data = std::min<int64_t>(length, size - in.tellg());  // a stream's header may claim more
      return std::chrono::milliseconds(data * 1000 / bytes_per_s);
    }
    char format[16] = {};
    if (std::memcmp(chunk, "fmt ", 4) == 0 && length >= 16) {
      in.read(format, sizeof format);
      bytes_per_s = ReadU32(format + 8);
      in.seekg(length - 16, std::ios::cur);
    } else {
      in.seekg(length + (length & 1), std::ios::cur);
    }
  }
  return absl::InvalidArgumentError(absl::StrCat(wav_path, " has no sound in it"));
}

absl::StatusOr<std::chrono::milliseconds> SpeakToFile(const std::string& text, const std::string& wav_path,
                                                      const std::function<bool()>& go_on,
                                                      const std::string& language) {
  const absl::StatusOr<std::string> voice = VoiceOf(language);
  if (!voice.ok()) return voice.status();
  const std::string text_path = wav_path + ".txt";
  if (absl::Status status = WriteTextFile(text_path, text); !status.ok()) return status;
  const std::string part = wav_path + ".part";
  // -s 150: words a minute, slow enough for a busy hall; -p 45: a little below the default pitch.
  auto code = RunChild(
      {"espeak-ng", "-v", *voice, "-s", "150", "-p", "45", "-b", "1", "-w", part, "-f", text_path}, go_on);
  if (!code.ok()) return code.status();
  if (*code == 1 && !language.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("the voice does not speak \"", language, "\"; espeak-ng --voices lists its languages"));
  }
  if (*code != 0) return absl::InternalError(absl::StrCat("espeak-ng ended with code ", *code));
  if (std::rename(part.c_str(), wav_path.c_str()) != 0) {
    return absl::ErrnoToStatus(errno, absl::StrCat("cannot write ", wav_path));
  }
  return PlayingTime(wav_path);
}

}  // namespace docent::robot
