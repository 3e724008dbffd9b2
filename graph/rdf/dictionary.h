// The dictionary: IRIs, blank nodes and literals that do not fit into an id ↔ TermId.
//
// Append-only but for refused turns. One thread (the writer) interns; any number of threads decode and find at the same time,
// without locks: entries, text and hash slots never move once they are published. Ids are given in order of
// first interning (a literal's datatype or language before the literal), so replaying the same log gives the
// same ids. At most 2^29 entries.
//
// The terms of a turn are seen by other threads once it is kept. Those of a turn that is refused are gone, and
// their ids are given again: whoever is told to roll back must forget them.
//
// Language tags count without case, and a literal keeps the tag that it was first interned with: "a"@en-GB, then
// "a"@en-gb, are one entry that says en-GB.
#ifndef DOCENT_GRAPH_RDF_DICTIONARY_H_
#define DOCENT_GRAPH_RDF_DICTIONARY_H_

#include <memory>
#include <optional>
#include <string_view>

#include "graph/rdf/term.h"
#include "graph/rdf/term_id.h"

namespace docent {

class Dictionary {
 public:
  Dictionary();
  // A dictionary over `base`, which must outlive it: it knows the terms that `base` has now, under the
  // same ids, and keeps new terms itself, under ids that `base` never gives. For work beside the writer
  // that interns terms (a SPARQL Update that reads what it wrote). One thread; the base may grow
  // meanwhile.
  explicit Dictionary(const Dictionary* base);
  // Makes the terms known that the base has learnt since. Call it only while this dictionary has no terms of
  // its own, so that no term gets two ids. Same thread as the other calls.
  void FollowBase();
  ~Dictionary();
  Dictionary(const Dictionary&) = delete;
  Dictionary& operator=(const Dictionary&) = delete;

  // A turn, on the writer's thread. Between BeginTurn and one of the others only that thread sees the terms
  // that are interned. KeepTurn and DropTurn do nothing without a turn.
  void BeginTurn();
  void KeepTurn();
  void DropTurn();

  // The id of `term`, made if new. Writer thread only. Inline literals make no entry.
  TermId Intern(const Term& term);
  TermId InternIri(std::string_view iri);
  // The id of `term` if it is known (or inline). Finds every term whose id this thread has already seen, in a
  // version or from another thread. Any thread.
  std::optional<TermId> Find(const Term& term) const;
  std::optional<TermId> FindIri(std::string_view iri) const;
  // The term of `id`, which this dictionary gave, or which is inline. Any thread.
  Term Decode(TermId id) const;
  // Decodes into *out and reuses its memory: faster for many terms.
  void DecodeTo(TermId id, Term* out) const;
  // The lexical form of a dictionary entry without a copy; the view lives as long as the dictionary.
  // Requires id.InDictionary(). Any thread.
  std::string_view Lexical(TermId id) const;

  // The datatype IRI of any literal id, inline ones included (rdf:langString with a language); empty for IRIs
  // and blank nodes. Below: the language tag, or empty. Both without a copy, as Lexical. Any thread.
  std::string_view Datatype(TermId id) const;
  std::string_view Language(TermId id) const;

  // All texts of a literal with an entry; the datatype is empty for a plain string and with a language.
  // Requires the tag kLiteral. Without a copy, as Lexical. Any thread.
  struct LiteralView {
    std::string_view lexical, datatype, language;
  };
  LiteralView Literal(TermId id) const;

  // The stored entries, for snapshots: entry number `index` < size() is the term of payload `index`. A
  // literal's `qualifier` is 0 for a plain string, else 1 + the number of another entry: its datatype, or
  // with `is_language` its language tag. Only for a dictionary without a base. Any thread.
  struct EntryView {
    TermId::Tag tag = TermId::Tag::kNone;
    std::string_view text;
    uint32_t qualifier = 0;
    bool is_language = false;
  };
  EntryView EntryAt(uint64_t index) const;
  // The id of such an entry, made if new; `qualifier` names an entry of this dictionary. Writer thread only.
  TermId InternEntry(const EntryView& entry);

  size_t size() const;   // entries
  size_t bytes() const;  // memory held, estimated

 private:
  struct Impl;
  // The id in the base, if the base knew the term when this dictionary was made.
  std::optional<TermId> FindInBase(const Term& term) const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_DICTIONARY_H_
