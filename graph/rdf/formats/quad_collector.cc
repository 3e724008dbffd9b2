#include "graph/rdf/formats/quad_collector.h"

#include <charconv>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {
namespace {

// No label in a document can begin with this character, so unlabelled nodes cannot clash with labelled ones.
constexpr char kNewMark = '\x01';

bool LooksLikeNew(std::string_view label) {
  return label.size() > 1 && label[0] == 'b' &&
         label.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

}  // namespace

Term QuadCollector::NamedBlank(std::string_view label) {
  if (LooksLikeNew(label)) named_like_new_.insert(std::string(label));
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

std::vector<TermQuad> QuadCollector::TakeQuads() {
  std::vector<std::string> labels;
  for (uint64_t n = 1; labels.size() < new_blanks_; ++n) {
    std::string label = absl::StrCat("b", n);
    if (!named_like_new_.contains(label)) labels.push_back(scope_ + label);
  }
  auto name = [&labels](Term* term) {
    if (!term->IsBlank() || !term->lexical.starts_with(kNewMark)) return;
    uint64_t n = 0;
    std::from_chars(term->lexical.data() + 1, term->lexical.data() + term->lexical.size(), n);
    term->lexical = labels[n];
  };
  if (!labels.empty()) {
    for (TermQuad& quad : quads_) {
      name(&quad.subject);
      name(&quad.object);
      name(&quad.graph);
    }
  }
  new_blanks_ = 0;
  named_like_new_.clear();
  return std::exchange(quads_, {});
}

}  // namespace docent
