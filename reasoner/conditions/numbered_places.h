// Container of numbered objects with stable addresses, stored side by side. An access reads the object's own
// cache lines and a short list. Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_CONDITIONS_NUMBERED_PLACES_H_
#define DOCENT_REASONER_CONDITIONS_NUMBERED_PLACES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace docent::conditions {

template <typename T>
class NumberedPlaces {
 public:
  NumberedPlaces() = default;
  ~NumberedPlaces() {
    for (uint32_t number = 0; number < taken_.size(); ++number) {
      if (taken_[number]) At(number).object.~T();
    }
  }
  NumberedPlaces(const NumberedPlaces&) = delete;
  NumberedPlaces& operator=(const NumberedPlaces&) = delete;

  // The number of the next object: the last one freed, or a new one.
  uint32_t Next() const { return free_.empty() ? static_cast<uint32_t>(taken_.size()) : free_.back(); }
  // Constructs an object from `arguments`, with the number Next().
  template <typename... Arguments>
  T& Make(Arguments&&... arguments) {
    const uint32_t number = Next();
    if (number / kOfAPiece == pieces_.size()) pieces_.push_back(std::make_unique_for_overwrite<Piece>());
    T* const made = new (&At(number).object) T(std::forward<Arguments>(arguments)...);
    if (free_.empty()) {
      taken_.push_back(true);
    } else {
      free_.pop_back();
      taken_[number] = true;
    }
    return *made;
  }
  // Requires that the object exists.
  void Remove(uint32_t number) {
    At(number).object.~T();
    taken_[number] = false;
    free_.push_back(number);
  }

  bool Has(uint32_t number) const { return taken_[number]; }
  // Requires that the object exists.
  T& operator[](uint32_t number) { return At(number).object; }
  const T& operator[](uint32_t number) const { return At(number).object; }

 private:
  static constexpr uint32_t kOfAPiece = 512;
  union Place {
    Place() {}
    ~Place() {}
    T object;
  };
  struct Piece {
    std::array<Place, kOfAPiece> places;
  };
  Place& At(uint32_t number) const { return pieces_[number / kOfAPiece]->places[number % kOfAPiece]; }

  std::vector<std::unique_ptr<Piece>> pieces_;
  std::vector<bool> taken_;
  std::vector<uint32_t> free_;
};

}  // namespace docent::conditions

#endif  // DOCENT_REASONER_CONDITIONS_NUMBERED_PLACES_H_
