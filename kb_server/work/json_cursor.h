// How far nlohmann's parser has read a JSON text, for readers that take values as they come. Pure values.
#ifndef DOCENT_KB_SERVER_WORK_JSON_CURSOR_H_
#define DOCENT_KB_SERVER_WORK_JSON_CURSOR_H_

#include <cstddef>
#include <iterator>

namespace docent::server {

struct JsonCursor {
  const char* at = nullptr;     // the next character
  const char* bound = nullptr;  // the text ends here, too; null: at its end only
};

// For nlohmann::json::sax_parse, two of them: begin and end of the text. The cursor must outlive them.
class JsonIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  JsonIterator(const char* at, JsonCursor* cursor) : at_(at), cursor_(cursor) {}
  reference operator*() const { return *at_; }
  JsonIterator& operator++() {
    cursor_->at = ++at_;
    return *this;
  }
  bool operator==(const JsonIterator& end) const { return at_ == end.at_ || at_ == cursor_->bound; }

 private:
  const char* at_;
  JsonCursor* cursor_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_JSON_CURSOR_H_
