// The robot's screen: a small HTTP server on loopback that shows the robot's pages, and below them what the robot
// says, with the word that is spoken marked. GET and HEAD only. A browser at / follows the robot from page to page:
// a script, /-/screen.js, asks /-/now (JSON) a few times a second. A request that names another host is refused: no page of
// another site reads the screen by a name that leads here (DNS rebinding).
//
// One thread of its own serves all connections asynchronously; each has a time limit, and where there are too many the oldest
// is closed. `Show` and `Say` from any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_SCREEN_SERVER_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_SCREEN_SERVER_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace docent::robot {

class ScreenServer {
 public:
  static constexpr int kWaitingLimit = 64;        // connections that wait to be accepted
  static constexpr size_t kConnectionLimit = 32;  // connections at the same time

  // `port` 0: any free port. UNAVAILABLE: the port is in use.
  static absl::StatusOr<std::unique_ptr<ScreenServer>> Start(int port);
  ~ScreenServer();

  // Serves `html` at /NAME and on the screen itself, /. NAME: letters, digits, - and _ (see FileNameOf).
  // Returns the address of /NAME.
  std::string Show(const std::string& name, std::string html);

  // Shows what the robot says. `language`: a language tag, or empty for English; `share`: how much of the text was
  // spoken, 0..1. An empty text: the robot is silent.
  void Say(const std::string& text, const std::string& language, double share);

  int port() const;
  std::string address() const;  // "http://127.0.0.1:PORT/"

 private:
  class Impl;
  explicit ScreenServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_SCREEN_SERVER_H_
