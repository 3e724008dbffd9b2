// Seeded changes of texts: the same seed gives the same texts on every machine.
#ifndef DOCENT_TESTS_FUZZ_MUTATOR_H_
#define DOCENT_TESTS_FUZZ_MUTATOR_H_

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace docent::fuzz {

class Mutator {
 public:
  // `corpus` must not be empty. `words` are inserted sometimes.
  Mutator(uint32_t seed, std::vector<std::string> corpus, std::vector<std::string> words = {})
      : random_(seed), corpus_(std::move(corpus)), words_(std::move(words)) {}

  // A text of the corpus with one to eight changes.
  std::string Next() {
    std::string text = corpus_[Below(corpus_.size())];
    for (size_t changes = Below(2) == 0 ? 1 : 1 + Below(8); changes > 0; --changes) Change(&text);
    return text;
  }

 private:
  size_t Below(size_t limit) { return limit == 0 ? 0 : random_() % limit; }

  void Change(std::string* text) {
    size_t at = Below(text->size() + 1);
    size_t length = std::min(text->size() - at, size_t{1} << Below(9));
    switch (Below(7)) {
      case 0:
        if (at < text->size()) (*text)[at] = static_cast<char>((*text)[at] ^ (1 << Below(8)));
        break;
      case 1:
        text->erase(at, length);
        break;
      case 2:
        text->insert(Below(text->size() + 1), text->substr(at, length));
        break;
      case 3:
        text->insert(at, 1, static_cast<char>(Below(256)));
        break;
      case 4:
        if (!words_.empty()) text->insert(at, words_[Below(words_.size())]);
        break;
      case 5:
        if (!words_.empty()) text->replace(at, length, words_[Below(words_.size())]);
        break;
      case 6: {  // the end of another text
        const std::string& other = corpus_[Below(corpus_.size())];
        *text = text->substr(0, at) + other.substr(Below(other.size() + 1));
        break;
      }
    }
  }

  std::mt19937 random_;  // its sequence is fixed by the C++ standard
  std::vector<std::string> corpus_;
  std::vector<std::string> words_;
};

}  // namespace docent::fuzz

#endif  // DOCENT_TESTS_FUZZ_MUTATOR_H_
