#include "graph/rdf/dictionary.h"

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "absl/hash/hash.h"
#include "graph/base/text.h"
#include "graph/rdf/term_table.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

using Tag = TermId::Tag;

// One term. Of a literal, `qualifier` is 0 for a plain string, else 1 + the index of another entry: the
// datatype IRI, or with `is_language` the language tag (itself a plain string).
struct Entry {
  const char* text = nullptr;
  uint32_t length = 0;
  uint32_t qualifier : 29 = 0;
  uint32_t is_language : 1 = 0;
  uint32_t tag : 2 = 0;

  std::string_view view() const { return {text, length}; }
};
static_assert(sizeof(Entry) == 16);

// Lookup key of an entry: its datatype as Entry::qualifier, or its language tag as text, in any case.
struct EntryKey {
  Tag tag = Tag::kNone;
  std::string_view text;
  uint32_t qualifier = 0;
  std::string_view language;

  bool IsButForLanguage(const Entry& e) const {
    return e.tag == static_cast<uint32_t>(tag) && e.is_language == (language.empty() ? 0 : 1) &&
           (e.is_language != 0 || e.qualifier == qualifier) && e.view() == text;
  }
  uint32_t Hash() const {
    const size_t hash = language.empty()
                            ? absl::HashOf(static_cast<int>(tag), ToAbsl(text), qualifier)
                            : absl::HashOf(static_cast<int>(tag), ToAbsl(text), LowerLanguage(language));
    return static_cast<uint32_t>(hash >> 16);
  }
};

// Entries in chunks that never move: chunk k holds kFirstChunk * 2^k of them. The writer appends; a
// reader may read any index that it got through a synchronising operation (a published version, the hash
// table).
class EntryArray {
 public:
  EntryArray() = default;
  EntryArray(const EntryArray&) = delete;
  EntryArray& operator=(const EntryArray&) = delete;
  ~EntryArray() {
    for (std::atomic<Entry*>& chunk : chunks_) std::free(chunk.load(std::memory_order_relaxed));
  }

  const Entry& operator[](uint64_t index) const {
    auto [chunk, at] = Place(index);
    return chunks_[chunk].load(std::memory_order_acquire)[at];
  }

  // `index` is the one after the newest. Returns the bytes allocated.
  size_t Put(uint64_t index, const Entry& entry) {
    auto [chunk, at] = Place(index);
    Entry* entries = chunks_[chunk].load(std::memory_order_relaxed);
    size_t allocated = 0;
    if (entries == nullptr) {
      entries = Zeroed<Entry>(kFirstChunk << chunk);
      allocated = (kFirstChunk << chunk) * sizeof(Entry);
      chunks_[chunk].store(entries, std::memory_order_release);
    }
    entries[at] = entry;
    return allocated;
  }

 private:
  static constexpr uint64_t kFirstChunk = 1024;

  static std::pair<size_t, uint64_t> Place(uint64_t index) {
    size_t chunk = static_cast<size_t>(std::bit_width(index / kFirstChunk + 1) - 1);
    return {chunk, index - ((kFirstChunk << chunk) - kFirstChunk)};
  }

  std::array<std::atomic<Entry*>, 24> chunks_ = {};
};

// Text in blocks that never move.
class TextArena {
 public:
  // Returns the place of the copy; adds to `allocated` what it had to allocate.
  const char* Put(std::string_view text, size_t* allocated) {
    if (text.size() > left_) {
      size_t block = text.size() > kBlock / 4 ? text.size() : kBlock;
      blocks_.push_back({std::make_unique<char[]>(block), block});
      *allocated += block;
      if (block != kBlock) {  // a long text gets its own block; the current block stays current
        std::memcpy(blocks_.back().text.get(), text.data(), text.size());
        return blocks_.back().text.get();
      }
      next_ = blocks_.back().text.get();
      left_ = kBlock;
    }
    char* place = next_;
    if (!text.empty()) std::memcpy(place, text.data(), text.size());
    next_ += text.size();
    left_ -= text.size();
    return place;
  }

  // What was put since Mark is gone. Returns the bytes freed.
  struct Place {
    size_t blocks = 0;
    char* next = nullptr;
    size_t left = 0;
  };
  Place Mark() const { return {blocks_.size(), next_, left_}; }
  size_t Rewind(const Place& to) {
    size_t freed = 0;
    for (; blocks_.size() > to.blocks; blocks_.pop_back()) freed += blocks_.back().size;
    next_ = to.next;
    left_ = to.left;
    return freed;
  }

 private:
  static constexpr size_t kBlock = 64 << 10;
  struct Block {
    std::unique_ptr<char[]> text;
    size_t size;
  };
  std::vector<Block> blocks_;
  char* next_ = nullptr;
  size_t left_ = 0;
};

// Above every index that the writer's dictionary gives (Entry::qualifier has 29 bits).
constexpr uint64_t kOverBase = uint64_t{1} << 29;

}  // namespace

struct Dictionary::Impl {
  const Dictionary* base = nullptr;
  uint64_t base_size = 0;  // number of entries that `base` had; later ones do not count
  uint64_t first = 0;      // the id of entry 0
  EntryArray entries;
  TermTable table;
  TextArena arena;
  uint64_t count = 0;                 // writer: entries, those of the running turn included
  std::atomic<uint64_t> kept{0};      // entries that every thread sees
  std::atomic<std::thread::id> turn;  // the thread of the running turn; none: no turn
  TextArena::Place before_turn;
  std::atomic<size_t> allocated{0};

  bool IsOwnTurn() const { return turn.load(std::memory_order_relaxed) == std::this_thread::get_id(); }
  // Read after the number was: an entry that is kept is never written again.
  bool IsSeen(uint64_t index) const { return index < kept.load(std::memory_order_acquire) || IsOwnTurn(); }
  uint64_t Size() const { return IsOwnTurn() ? count : kept.load(std::memory_order_acquire); }

  // The dictionary that owns the entry of `id`.
  const Impl& OwnerOf(uint64_t id) const { return id < first ? *base->impl_ : *this; }
  const Entry& At(uint64_t id) const { return entries[id - first]; }

  std::optional<uint64_t> Find(const EntryKey& key) const {
    return table.Find(key.Hash(), [&](uint64_t index) {
      if (!IsSeen(index)) return false;
      const Entry& entry = entries[index];
      return key.IsButForLanguage(entry) &&
             (key.language.empty() || SameLanguage(entries[entry.qualifier - 1].view(), key.language));
    });
  }

  uint64_t Intern(const EntryKey& key) {
    if (std::optional<uint64_t> known = Find(key)) return *known;
    Entry entry;
    entry.qualifier = key.qualifier;
    if (!key.language.empty()) {  // the tag comes before its literal
      entry.qualifier = static_cast<uint32_t>(Intern(EntryKey{Tag::kLiteral, key.language}) + 1);
      entry.is_language = 1;
    }
    const uint64_t index = count;
    size_t grown = 0;
    entry.text = arena.Put(key.text, &grown);
    entry.length = static_cast<uint32_t>(key.text.size());
    entry.tag = static_cast<uint32_t>(key.tag);
    grown += entries.Put(index, entry);
    table.Insert(key.Hash(), index);
    count = index + 1;
    if (!IsOwnTurn()) kept.store(count, std::memory_order_release);
    allocated.fetch_add(grown, std::memory_order_relaxed);
    return index;
  }

  EntryKey KeyOf(const Entry& entry) const {
    EntryKey key{static_cast<Tag>(entry.tag), entry.view()};
    if (entry.is_language != 0) {
      key.language = entries[entry.qualifier - 1].view();
    } else {
      key.qualifier = entry.qualifier;
    }
    return key;
  }

  // The key of `term` when its datatype is known; `qualify(key)` finds or makes its entry.
  template <typename Qualify>
  static std::optional<EntryKey> KeyOf(const Term& term, Qualify qualify) {
    switch (term.kind) {
      case TermKind::kIri:
        return EntryKey{Tag::kIri, term.lexical};
      case TermKind::kBlank:
        return EntryKey{Tag::kBlank, term.lexical};
      case TermKind::kLiteral:
        break;
    }
    EntryKey key{Tag::kLiteral, term.lexical};
    key.language = term.language;
    if (!term.language.empty() || term.datatype.empty() || term.datatype == kXsdString) return key;
    const std::optional<uint64_t> qualifier = qualify(EntryKey{Tag::kIri, term.datatype});
    if (!qualifier) return std::nullopt;
    key.qualifier = static_cast<uint32_t>(*qualifier + 1);
    return key;
  }
};

Dictionary::Dictionary() : impl_(std::make_unique<Impl>()) {}
Dictionary::Dictionary(const Dictionary* base) : Dictionary() {
  impl_->base = base;
  impl_->base_size = base->size();
  impl_->first = kOverBase;
}
Dictionary::~Dictionary() = default;

void Dictionary::FollowBase() {
  if (impl_->count == 0) impl_->base_size = impl_->base->size();
}

void Dictionary::BeginTurn() {
  if (impl_->IsOwnTurn()) return;
  impl_->before_turn = impl_->arena.Mark();
  impl_->turn.store(std::this_thread::get_id(), std::memory_order_relaxed);
}

void Dictionary::KeepTurn() {
  if (!impl_->IsOwnTurn()) return;
  impl_->kept.store(impl_->count, std::memory_order_release);
  impl_->turn.store(std::thread::id(), std::memory_order_relaxed);
}

// The newest entry first: a literal before its language.
void Dictionary::DropTurn() {
  Impl& impl = *impl_;
  if (!impl.IsOwnTurn()) return;
  const uint64_t kept = impl.kept.load(std::memory_order_relaxed);
  for (; impl.count > kept; --impl.count) {
    const uint64_t index = impl.count - 1;
    impl.table.Remove(impl.KeyOf(impl.entries[index]).Hash(), index);
  }
  impl.allocated.fetch_sub(impl.arena.Rewind(impl.before_turn), std::memory_order_relaxed);
  impl.turn.store(std::thread::id(), std::memory_order_relaxed);
}

std::optional<TermId> Dictionary::FindInBase(const Term& term) const {
  std::optional<TermId> id = impl_->base->Find(term);
  if (id && id->InDictionary() && id->payload() >= impl_->base_size) return std::nullopt;
  return id;
}

TermId Dictionary::Intern(const Term& term) {
  if (std::optional<TermId> id = InlineLiteral(term)) return *id;
  if (impl_->base != nullptr) {
    if (std::optional<TermId> id = FindInBase(term)) return *id;
  }
  EntryKey key = *Impl::KeyOf(term, [this](const EntryKey& k) { return std::optional(impl_->Intern(k)); });
  return TermId::Make(key.tag, impl_->first + impl_->Intern(key));
}

TermId Dictionary::InternIri(std::string_view iri) {
  if (impl_->base != nullptr) return Intern(Term::Iri(std::string(iri)));
  return TermId::Make(Tag::kIri, impl_->Intern(EntryKey{Tag::kIri, iri}));
}

std::optional<TermId> Dictionary::Find(const Term& term) const {
  if (std::optional<TermId> id = InlineLiteral(term)) return id;
  if (impl_->base != nullptr) {
    if (std::optional<TermId> id = FindInBase(term)) return id;
  }
  std::optional<EntryKey> key = Impl::KeyOf(term, [this](const EntryKey& k) { return impl_->Find(k); });
  if (!key) return std::nullopt;
  std::optional<uint64_t> index = impl_->Find(*key);
  if (!index) return std::nullopt;
  return TermId::Make(key->tag, impl_->first + *index);
}

std::optional<TermId> Dictionary::FindIri(std::string_view iri) const {
  if (impl_->base != nullptr) return Find(Term::Iri(std::string(iri)));
  std::optional<uint64_t> index = impl_->Find(EntryKey{Tag::kIri, iri});
  if (!index) return std::nullopt;
  return TermId::Make(Tag::kIri, *index);
}

Term Dictionary::Decode(TermId id) const {
  Term term;
  DecodeTo(id, &term);
  return term;
}

void Dictionary::DecodeTo(TermId id, Term* out) const {
  if (!id.InDictionary()) return DecodeInlineTo(id, out);
  const Impl& owner = impl_->OwnerOf(id.payload());
  const Entry& entry = owner.At(id.payload());
  out->kind = id.IsIri() ? TermKind::kIri : id.IsBlank() ? TermKind::kBlank : TermKind::kLiteral;
  Overwrite(&out->lexical, entry.view());
  out->datatype.clear();
  out->language.clear();
  if (entry.qualifier == 0 || !id.IsLiteral()) return;
  (entry.is_language != 0 ? out->language : out->datatype) = owner.entries[entry.qualifier - 1].view();
}

std::string_view Dictionary::Lexical(TermId id) const {
  return impl_->OwnerOf(id.payload()).At(id.payload()).view();
}

std::string_view Dictionary::Datatype(TermId id) const {
  if (!id.InDictionary()) return InlineDatatype(id);
  if (!id.IsLiteral()) return {};
  const LiteralView literal = Literal(id);
  if (!literal.language.empty()) return kRdfLangString;
  return literal.datatype.empty() ? kXsdString : literal.datatype;
}

std::string_view Dictionary::Language(TermId id) const {
  return id.tag() == Tag::kLiteral ? Literal(id).language : std::string_view();
}

Dictionary::LiteralView Dictionary::Literal(TermId id) const {
  const Impl& owner = impl_->OwnerOf(id.payload());
  const Entry& entry = owner.At(id.payload());
  LiteralView view{entry.view(), {}, {}};
  if (entry.qualifier != 0)
    (entry.is_language != 0 ? view.language : view.datatype) = owner.entries[entry.qualifier - 1].view();
  return view;
}

Dictionary::EntryView Dictionary::EntryAt(uint64_t index) const {
  const Entry& entry = impl_->entries[index];
  return {static_cast<Tag>(entry.tag), entry.view(), entry.qualifier, entry.is_language != 0};
}

TermId Dictionary::InternEntry(const EntryView& entry) {
  EntryKey key{entry.tag, entry.text};
  if (entry.is_language) {
    key.language = impl_->entries[entry.qualifier - 1].view();
  } else {
    key.qualifier = entry.qualifier;
  }
  return TermId::Make(entry.tag, impl_->Intern(key));
}

size_t Dictionary::size() const {
  return impl_->Size();
}

size_t Dictionary::bytes() const {
  return impl_->allocated.load(std::memory_order_relaxed) + impl_->table.bytes();
}

}  // namespace docent
