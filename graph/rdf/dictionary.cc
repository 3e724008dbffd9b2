#include "graph/rdf/dictionary.h"

#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/hash/hash.h"
#include "graph/base/text.h"
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

// Zeroed memory that the system provides only when it is written, so that no caller waits for megabytes at
// once. To be freed with std::free.
template <typename T>
T* Zeroed(uint64_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  void* const memory = std::calloc(count, sizeof(T));
  if (memory == nullptr) throw std::bad_alloc();
  return static_cast<T*>(memory);
}

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

// Open addressing over atomic slots: 32 bits of hash above index + 1, all 0 for empty. The hash bits in a
// slot also give its place, so growing reads no entry. The writer publishes a slot after its entry.
//
// A full table is followed by one twice as large, and each insert then moves a few slots over: no caller
// waits for a copy of the whole table. Meanwhile readers look into both. Old tables are kept, since a reader
// may still use them (together they are no larger than the newest).
class HashTable {
 public:
  HashTable() { current_.store(NewTable(kFirstSlots, nullptr), std::memory_order_release); }

  template <typename Matches>  // bool Matches(index)
  std::optional<uint64_t> Find(uint32_t hash, Matches matches) const {
    const Table* table = current_.load(std::memory_order_acquire);
    while (table != nullptr) {
      // Loaded before the search of this table: if the move is complete by then, the search sees all slots.
      const Table* older = table->older.load(std::memory_order_acquire);
      for (uint64_t i = hash & table->mask;; i = (i + 1) & table->mask) {
        const uint64_t slot = table->Slot(i).load(std::memory_order_acquire);
        if (slot == 0) break;
        if (slot >> 32 == hash && matches((slot & kIndexMask) - 1)) return (slot & kIndexMask) - 1;
      }
      table = older;
    }
    return std::nullopt;
  }

  // Writer thread only.
  void Insert(uint32_t hash, uint64_t index) {
    Table* table = tables_.back().get();
    if ((count_ + 1) * 3 > (table->mask + 1) * 2) {
      table = NewTable((table->mask + 1) * 2, table);
      current_.store(table, std::memory_order_release);
      moved_ = 0;
    }
    MoveSome(table);
    ++count_;
    Place(*table, static_cast<uint64_t>(hash) << 32 | (index + 1));
  }

  size_t bytes() const { return 2 * sizeof(uint64_t) * (current_.load(std::memory_order_acquire)->mask + 1); }

 private:
  static constexpr uint64_t kFirstSlots = 4096;
  static constexpr uint64_t kIndexMask = 0xFFFFFFFF;
  // Slots moved by one insert. Two would be enough to finish the move before the larger table is full.
  static constexpr uint64_t kStep = 16;

  struct Table {
    Table(uint64_t slot_count, const Table* before)
        : mask(slot_count - 1), slots(Zeroed<uint64_t>(slot_count), std::free), older(before) {}
    std::atomic_ref<uint64_t> Slot(uint64_t i) const { return std::atomic_ref(slots.get()[i]); }

    const uint64_t mask;
    const std::unique_ptr<uint64_t, decltype(&std::free)> slots;
    std::atomic<const Table*> older;  // table whose slots are still being moved; null: none
  };

  Table* NewTable(uint64_t slot_count, const Table* older) {
    tables_.push_back(std::make_unique<Table>(slot_count, older));
    return tables_.back().get();
  }

  void MoveSome(Table* to) {
    const Table* from = to->older.load(std::memory_order_relaxed);
    if (from == nullptr) return;
    for (const uint64_t end = moved_ + kStep; moved_ < end; ++moved_) {
      const uint64_t slot = from->Slot(moved_).load(std::memory_order_relaxed);
      if (slot != 0) Place(*to, slot);
    }
    if (moved_ > from->mask) to->older.store(nullptr, std::memory_order_release);
  }

  static void Place(const Table& table, uint64_t slot) {
    uint64_t i = (slot >> 32) & table.mask;
    while (table.Slot(i).load(std::memory_order_relaxed) != 0) i = (i + 1) & table.mask;
    table.Slot(i).store(slot, std::memory_order_release);
  }

  std::atomic<const Table*> current_{nullptr};
  std::vector<std::unique_ptr<Table>> tables_;  // writer; the last is the current one
  uint64_t count_ = 0;                          // writer
  uint64_t moved_ = 0;                          // writer: slots of the table before the current one
};

// Text in blocks that never move.
class TextArena {
 public:
  // Returns the place of the copy; adds to `allocated` what it had to allocate.
  const char* Put(std::string_view text, size_t* allocated) {
    if (text.size() > left_) {
      size_t block = text.size() > kBlock / 4 ? text.size() : kBlock;
      blocks_.push_back(std::make_unique<char[]>(block));
      *allocated += block;
      if (block != kBlock) {  // a long text gets its own block; the current block stays current
        std::memcpy(blocks_.back().get(), text.data(), text.size());
        return blocks_.back().get();
      }
      next_ = blocks_.back().get();
      left_ = kBlock;
    }
    char* place = next_;
    if (!text.empty()) std::memcpy(place, text.data(), text.size());
    next_ += text.size();
    left_ -= text.size();
    return place;
  }

 private:
  static constexpr size_t kBlock = 64 << 10;
  std::vector<std::unique_ptr<char[]>> blocks_;
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
  HashTable table;
  TextArena arena;
  std::atomic<uint64_t> count{0};
  std::atomic<size_t> allocated{0};

  // The dictionary that owns the entry of `id`.
  const Impl& OwnerOf(uint64_t id) const { return id < first ? *base->impl_ : *this; }
  const Entry& At(uint64_t id) const { return entries[id - first]; }

  std::optional<uint64_t> Find(const EntryKey& key) const {
    return table.Find(key.Hash(), [&](uint64_t index) {
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
    uint64_t index = count.load(std::memory_order_relaxed);
    size_t grown = 0;
    entry.text = arena.Put(key.text, &grown);
    entry.length = static_cast<uint32_t>(key.text.size());
    entry.tag = static_cast<uint32_t>(key.tag);
    grown += entries.Put(index, entry);
    table.Insert(key.Hash(), index);
    count.store(index + 1, std::memory_order_release);
    allocated.fetch_add(grown, std::memory_order_relaxed);
    return index;
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
  if (impl_->count.load(std::memory_order_relaxed) == 0) impl_->base_size = impl_->base->size();
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
  return impl_->count.load(std::memory_order_acquire);
}

size_t Dictionary::bytes() const {
  return impl_->allocated.load(std::memory_order_relaxed) + impl_->table.bytes();
}

}  // namespace docent
