#include "graph/rdf/formats/attribute_counter.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace docent {
namespace {

struct Markup {
  std::string_view opens;   // after "<"
  std::string_view ending;  // some equal characters and another
};
constexpr std::array<Markup, 3> kMarkup = {{{"!--", "-->"}, {"![CDATA[", "]]>"}, {"?", "?>"}}};

}  // namespace

void AttributeCounter::Begin() {
  state_ = State::kOpen;
  opened_size_ = attributes_ = 0;
}

void AttributeCounter::Open(char c) {
  opened_[opened_size_++] = c;
  const std::string_view seen(opened_, opened_size_);
  for (const Markup& markup : kMarkup) {
    if (!markup.opens.starts_with(seen)) continue;
    if (markup.opens.size() > seen.size()) return;
    state_ = State::kUntil;
    ending_ = markup.ending;
    matched_ = 0;
    return;
  }
  state_ = State::kTag;
}

size_t AttributeCounter::Feed(std::string_view piece) {
  for (size_t at = 0; at < piece.size(); ++at) {
    if (state_ == State::kText) {
      at = piece.find('<', at);
      if (at == std::string_view::npos) return at;
      Begin();
      continue;
    }
    if (state_ == State::kValue) {
      at = piece.find(quote_, at);
      if (at == std::string_view::npos) return at;
      state_ = State::kTag;
      continue;
    }
    const char c = piece[at];
    if (state_ == State::kUntil) {
      if (c == ending_[matched_]) {
        if (++matched_ == ending_.size()) state_ = State::kText;
      } else if (c != ending_[0]) {
        matched_ = 0;
      }
      continue;
    }
    if (state_ == State::kOpen) Open(c);
    if (state_ != State::kTag) continue;
    if (c == '>') {
      state_ = State::kText;
    } else if (c == '<') {  // a declaration inside a document type definition
      Begin();
    } else if (c == '"' || c == '\'') {
      state_ = State::kValue;
      quote_ = c;
      if (++attributes_ > most_) return at;
    }
  }
  return std::string_view::npos;
}

}  // namespace docent
