// Reader of one value of a JSON text that knows its place, for messages. What is wrong first is kept; all further reads then give
// empty values, so that the caller asks once, at the end. Private to this folder. One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_JSON_PLACE_H_
#define DOCENT_KB_SERVER_REPLAY_JSON_PLACE_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "nlohmann/json.hpp"

namespace docent::server {

class JsonPlace {
 public:
  // All must outlive it. `value` null: it is absent.
  JsonPlace(const nlohmann::ordered_json* value, std::string place, absl::Status* wrong)
      : value_(value), place_(std::move(place)), wrong_(wrong) {}

  bool there() const { return value_ != nullptr; }
  const std::string& place() const { return place_; }

  // A member of an object; absent where there is none.
  JsonPlace At(const char* name) const;
  std::string Text() const;
  std::string TextOr(std::string otherwise) const { return there() ? Text() : otherwise; }
  uint64_t Number() const;
  bool IsTrue() const;  // false where it is absent
  double Fraction() const;
  // Of a list; none where it is absent.
  std::vector<JsonPlace> Items() const;
  // Of an object; none where it is absent.
  std::vector<std::pair<std::string, JsonPlace>> Members() const;
  // Lines of a text, joined.
  std::string Lines() const;

  void Wrong(const std::string& what) const;

 private:
  const nlohmann::ordered_json* value_;
  const std::string place_;
  absl::Status* wrong_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_JSON_PLACE_H_
