#include "graph/rdf/formats/quad_collector.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {
namespace {

// No label in a document can begin with this character, so unlabelled nodes cannot clash with labelled ones.
constexpr char kNewMark = '\x01';

// N of the label bN; nullopt: it is no such label, as b01.
std::optional<uint64_t> NumberOf(std::string_view label) {
  uint64_t number = 0;
  if (label.size() < 2 || label[0] != 'b' || label[1] == '0') return std::nullopt;
  const char* const end = label.data() + label.size();
  const auto [read, error] = std::from_chars(label.data() + 1, end, number);
  return error == std::errc() && read == end ? std::optional(number) : std::nullopt;
}

// The numbers from 1 that are not taken.
class FreeNumbers {
 public:
  explicit FreeNumbers(const absl::flat_hash_set<uint64_t>& taken)
      : free_before_(taken.begin(), taken.end()) {
    std::sort(free_before_.begin(), free_before_.end());
    for (size_t i = 0; i < free_before_.size(); ++i) free_before_[i] -= i + 1;
  }
  // The first for 0.
  uint64_t At(uint64_t index) const {
    const auto before = std::upper_bound(free_before_.begin(), free_before_.end(), index);
    return index + 1 + static_cast<uint64_t>(before - free_before_.begin());
  }

 private:
  std::vector<uint64_t> free_before_;  // for each number that is taken, in order
};

}  // namespace

Term QuadCollector::NamedBlank(std::string_view label) {
  const std::optional<uint64_t> number = NumberOf(label);
  if (number && named_like_new_.insert(*number).second) Charge(0);
  return Term::Blank(Concat(scope_, label));
}

Term QuadCollector::NewBlank() {
  return Term::Blank(absl::StrCat(std::string(1, kNewMark), new_blanks_++));
}

bool QuadCollector::Count() {
  if (memory_ == nullptr || memory_->Add(std::exchange(uncounted_, 0))) return true;
  stopped_ = memory_->Refusal(absl::ResourceExhaustedError(
      absl::StrCat("the document says more than fits into the limit query_memory_bytes = ", memory_bytes_)));
  return false;
}

std::string QuadCollector::Refusal() const {
  if (!stopped_.ok()) return std::string(stopped_.message());
  if (bytes_ > most_bytes_) {
    return absl::StrCat("the terms of this document have more than ", most_bytes_,
                        " bytes, written out: ", kGrowth, " for each byte of the limit document_bytes");
  }
  return absl::StrCat("the document has more than ", most_, " triples: one for each ", kBytesOfQuad,
                      " bytes of the limit document_bytes");
}

// Each piece goes as soon as it is moved, so that about one of them is there twice.
std::vector<TermQuad> QuadCollector::Joined() {
  std::vector<std::vector<TermQuad>> pieces = std::exchange(pieces_, {});
  const size_t all = std::exchange(quads_, 0);
  if (pieces.empty()) return {};
  if (pieces.size() == 1) return std::move(pieces[0]);
  std::vector<TermQuad> quads;
  quads.reserve(all);
  for (std::vector<TermQuad>& piece : pieces) {
    for (TermQuad& quad : piece) quads.push_back(std::move(quad));
    piece = std::vector<TermQuad>();
  }
  return quads;
}

std::vector<TermQuad> QuadCollector::TakeQuads() {
  std::vector<TermQuad> quads = Joined();
  const FreeNumbers numbers(named_like_new_);
  const auto name = [&](Term* term) {
    if (!term->IsBlank() || !term->lexical.starts_with(kNewMark)) return;
    uint64_t n = 0;
    std::from_chars(term->lexical.data() + 1, term->lexical.data() + term->lexical.size(), n);
    term->lexical = absl::StrCat(scope_, "b", numbers.At(n));
  };
  if (new_blanks_ > 0) {
    for (TermQuad& quad : quads) {
      name(&quad.subject);
      name(&quad.object);
      name(&quad.graph);
    }
  }
  new_blanks_ = 0;
  named_like_new_.clear();
  return quads;
}

}  // namespace docent
