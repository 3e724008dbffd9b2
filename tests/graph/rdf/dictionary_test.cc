#include "graph/rdf/dictionary.h"

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

std::vector<Term> ManyKinds() {
  return {Term::Iri("http://a"),
          Term::Blank("http://a"),
          Term::Literal("http://a"),
          Term::Literal(""),
          Term::Literal(std::string("a\0b", 3)),
          Term::Literal("http://a", "http://t"),
          Term::Literal("http://a", "http://u"),
          Term::LangString("http://a", "en"),
          Term::LangString("http://a", "en-gb"),
          Term::Literal("007", std::string(kXsdInteger)),
          Term::Literal(std::string(100000, 'x'))};
}

TEST(DictionaryTest, RoundTripAndIdentity) {
  Dictionary dictionary;
  std::vector<TermId> ids;
  for (const Term& term : ManyKinds()) {
    EXPECT_FALSE(dictionary.Find(term).has_value());
    ids.push_back(dictionary.Intern(term));
  }
  size_t size = dictionary.size();
  for (size_t i = 0; i < ids.size(); ++i) {
    Term term = ManyKinds()[i];
    EXPECT_EQ(dictionary.Decode(ids[i]), term);
    EXPECT_EQ(dictionary.Intern(term), ids[i]);
    EXPECT_EQ(dictionary.Find(term), ids[i]);
    EXPECT_EQ(dictionary.Lexical(ids[i]), term.lexical);
    for (size_t j = 0; j < i; ++j) EXPECT_NE(ids[i], ids[j]);
  }
  EXPECT_EQ(dictionary.size(), size);
  EXPECT_GT(dictionary.bytes(), 100000u);
}

TEST(DictionaryTest, InlineLiteralsMakeNoEntry) {
  Dictionary dictionary;
  TermId id = dictionary.Intern(Term::Literal("1.25", std::string(kXsdDecimal)));
  EXPECT_EQ(dictionary.size(), 0u);
  EXPECT_EQ(dictionary.Decode(id), Term::Literal("1.25", std::string(kXsdDecimal)));
  EXPECT_EQ(dictionary.Find(Term::Integer(3)), dictionary.Intern(Term::Integer(3)));
}

TEST(DictionaryTest, OneTermIsDecodedIntoAfterTheOther) {
  Dictionary dictionary;
  const Term terms[] = {Term::Iri("http://a.example/a-long-one"),
                        Term::Literal("1.50", std::string(kXsdDecimal)),
                        Term::LangString("text", "en-gb"),
                        Term::Literal(""),
                        Term::Literal("007", std::string(kXsdInteger)),
                        Term::Literal("2014-02-28T23:59:59.050+05:45", std::string(kXsdDateTime)),
                        Term::Literal("x", "http://a.example/a-datatype"),
                        Term::Blank("b"),
                        Term::Integer(-3),
                        Term::Literal("-INF", std::string(kXsdDouble)),
                        Term::Iri("http://a.example/b")};
  std::vector<TermId> ids;
  for (const Term& term : terms) ids.push_back(dictionary.Intern(term));
  Term decoded;
  for (size_t a = 0; a < ids.size(); ++a) {
    for (size_t b = 0; b < ids.size(); ++b) {
      dictionary.DecodeTo(ids[a], &decoded);
      dictionary.DecodeTo(ids[b], &decoded);
      EXPECT_EQ(decoded, terms[b]) << "after " << ToNTriples(terms[a]);
    }
  }
}

TEST(DictionaryTest, DatatypeAndLanguage) {
  Dictionary dictionary;
  EXPECT_EQ(dictionary.Datatype(dictionary.Intern(Term::Literal("x"))), kXsdString);
  EXPECT_EQ(dictionary.Datatype(dictionary.Intern(Term::Literal("x", "http://t"))), "http://t");
  TermId english = dictionary.Intern(Term::LangString("x", "en"));
  EXPECT_EQ(dictionary.Datatype(english), kRdfLangString);
  EXPECT_EQ(dictionary.Language(english), "en");
  EXPECT_EQ(dictionary.Datatype(dictionary.Intern(Term::Integer(1))), kXsdInteger);
  EXPECT_EQ(dictionary.Datatype(dictionary.InternIri("http://a")), "");
  EXPECT_EQ(dictionary.Language(dictionary.Intern(Term::Literal("x"))), "");
}

TEST(DictionaryTest, LanguageTagsCountWithoutCaseAndStayAsFirstTold) {
  Dictionary dictionary;
  const TermId british = dictionary.Intern(Term::LangString("colour", "en-GB"));
  const size_t size = dictionary.size();
  for (const char* const tag : {"en-gb", "EN-gb", "en-GB"}) {
    EXPECT_EQ(dictionary.Find(Term::LangString("colour", tag)), british);
    EXPECT_EQ(dictionary.Intern(Term::LangString("colour", tag)), british);
  }
  EXPECT_EQ(dictionary.size(), size);
  EXPECT_EQ(dictionary.Language(british), "en-GB");
  EXPECT_EQ(dictionary.Decode(british).language, "en-GB");
  EXPECT_EQ(dictionary.Find(Term::LangString("colour", "en")), std::nullopt);
  EXPECT_EQ(dictionary.Find(Term::LangString("Colour", "en-GB")), std::nullopt);
  // another literal keeps a spelling of its own
  EXPECT_EQ(dictionary.Language(dictionary.Intern(Term::LangString("grey", "en-gb"))), "en-gb");

  Dictionary over(&dictionary);
  EXPECT_EQ(over.Intern(Term::LangString("colour", "EN-GB")), british);
  const TermId own = over.Intern(Term::LangString("theatre", "EN-GB"));
  EXPECT_EQ(over.Intern(Term::LangString("theatre", "en-gb")), own);
  EXPECT_EQ(over.Language(own), "EN-GB");
}

TEST(DictionaryTest, EntriesMakeTheSameDictionaryWithItsTags) {
  Dictionary a, b;
  for (const char* const tag : {"en-GB", "en", "EN", "de-at", "en-gb"}) {
    a.Intern(Term::LangString(tag, tag));
    a.Intern(Term::LangString("x", tag));
  }
  for (uint64_t i = 0; i < a.size(); ++i) b.InternEntry(a.EntryAt(i));
  ASSERT_EQ(b.size(), a.size());
  for (const char* const tag : {"en-GB", "EN", "DE-AT"}) {
    const TermId id = *a.Find(Term::LangString("x", tag));
    EXPECT_EQ(b.Find(Term::LangString("x", tag)), id);
    EXPECT_EQ(b.Language(id), a.Language(id));
  }
}

TEST(DictionaryTest, SameOrderGivesTheSameIds) {
  Dictionary a, b;
  for (int i = 0; i < 5000; ++i) {
    Term term = i % 3 == 0 ? Term::Literal("v" + std::to_string(i), "http://t" + std::to_string(i % 7))
                           : Term::Iri("http://e/" + std::to_string(i % 1000));
    ASSERT_EQ(a.Intern(term), b.Intern(term));
  }
}

// The hash table grows a few slots at a time: at every stage of the move all terms are found, and no others.
TEST(DictionaryTest, EveryTermIsFoundWhileTheTableGrows) {
  Dictionary dictionary;
  const auto text = [](uint64_t i) { return "http://example.org/" + std::to_string(i * 7919); };
  for (uint64_t i = 0; i < 30000; ++i) {
    const TermId id = dictionary.InternIri(text(i));
    ASSERT_EQ(id, TermId::Make(TermId::Tag::kIri, i));
    for (const uint64_t earlier : {i, i / 2, i * 7919 % (i + 1)}) {
      ASSERT_EQ(dictionary.FindIri(text(earlier)), TermId::Make(TermId::Tag::kIri, earlier)) << i;
      ASSERT_EQ(dictionary.InternIri(text(earlier)), TermId::Make(TermId::Tag::kIri, earlier)) << i;
    }
    ASSERT_FALSE(dictionary.FindIri(text(i + 1)).has_value()) << i;
  }
  EXPECT_EQ(dictionary.size(), 30000u);
}

// One writer; readers find and decode the terms that it has published through an atomic, and look for terms
// that do not exist yet.
TEST(DictionaryTest, ReadersBesideTheWriter) {
  Dictionary dictionary;
  constexpr uint64_t kTerms = 40000;
  auto text = [](uint64_t i) { return "http://example.org/" + std::to_string(i); };
  std::atomic<uint64_t> published{0};
  std::atomic<bool> wrong{false};
  auto read = [&](uint64_t step) {
    for (uint64_t i = 0; published.load(std::memory_order_acquire) < kTerms; i += step) {
      uint64_t count = published.load(std::memory_order_acquire);
      if (count == 0) continue;
      uint64_t n = i % count;
      TermId id = TermId::Make(TermId::Tag::kIri, n);
      if (dictionary.Lexical(id) != text(n) || dictionary.FindIri(text(n)) != id) wrong = true;
      std::optional<TermId> later = dictionary.FindIri(text(n + 1000));
      if (later && dictionary.Decode(*later).lexical != text(n + 1000)) wrong = true;
    }
  };
  std::thread first(read, 7), second(read, 13);
  for (uint64_t i = 0; i < kTerms; ++i) {
    dictionary.InternIri(text(i));
    published.store(i + 1, std::memory_order_release);
  }
  first.join();
  second.join();
  EXPECT_FALSE(wrong);
}

TEST(DictionaryTest, ADictionaryOverAnotherKeepsNewTermsToItself) {
  Dictionary base;
  const Term known = Term::Literal("x", "http://e/type"), later = Term::Iri("http://e/later");
  const TermId known_id = base.Intern(known);
  Dictionary over(&base);
  EXPECT_EQ(over.Intern(known), known_id);
  EXPECT_EQ(over.Find(Term::Integer(5)), InlineLiteral(Term::Integer(5)));
  const Term fresh[] = {later,
                        Term::Literal("y", "http://e/type"),
                        Term::Literal("z", "http://e/new-type"),
                        Term::LangString("n", "fr"),
                        Term::Blank("b"),
                        Term::Iri("http://e/new-type")};
  EXPECT_EQ(over.Find(fresh[0]), std::nullopt);
  std::vector<TermId> ids;
  for (const Term& term : fresh) ids.push_back(over.Intern(term));
  const TermId base_id = base.Intern(later);  // the base grows meanwhile
  EXPECT_NE(base_id, ids[0]);
  for (size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(over.Find(fresh[i]), ids[i]);
    EXPECT_EQ(over.Intern(fresh[i]), ids[i]);
    EXPECT_EQ(over.Decode(ids[i]), fresh[i]);
    EXPECT_EQ(over.Lexical(ids[i]), fresh[i].lexical);
  }
  EXPECT_EQ(over.Datatype(ids[2]), "http://e/new-type");
  EXPECT_EQ(over.Language(ids[3]), "fr");
  EXPECT_EQ(over.Datatype(known_id), "http://e/type");
  EXPECT_EQ(over.Decode(known_id), known);
  EXPECT_EQ(over.FindIri("http://e/type"), base.FindIri("http://e/type"));
  EXPECT_EQ(base.Find(fresh[1]), std::nullopt);
}

TEST(DictionaryTest, TheTermsOfARefusedTurnAreGone) {
  Dictionary dictionary;
  dictionary.InternIri("http://e/before");
  const size_t bytes = dictionary.bytes();
  const std::string text(100000, 'x');
  const Term terms[] = {Term::Literal(text), Term::LangString("n", "fr"), Term::Literal("y", "http://e/type"),
                        Term::Iri("http://e/new"), Term::Blank("b")};
  for (int turn = 0; turn < 3; ++turn) {
    dictionary.BeginTurn();
    std::vector<TermId> ids;
    for (const Term& term : terms) ids.push_back(dictionary.Intern(term));
    for (size_t i = 0; i < ids.size(); ++i) {
      EXPECT_EQ(dictionary.Find(terms[i]), ids[i]);
      EXPECT_EQ(dictionary.Decode(ids[i]), terms[i]);
    }
    EXPECT_EQ(dictionary.size(), 1u + 7u) << "with the datatype and the language";
    std::thread([&] {
      EXPECT_EQ(dictionary.size(), 1u);
      for (const Term& term : terms) EXPECT_EQ(dictionary.Find(term), std::nullopt);
      EXPECT_TRUE(dictionary.FindIri("http://e/before").has_value());
      Dictionary over(&dictionary);
      EXPECT_EQ(over.Find(terms[3]), std::nullopt);
    }).join();
    dictionary.DropTurn();
    EXPECT_EQ(dictionary.size(), 1u);
    EXPECT_EQ(dictionary.bytes(), bytes);
    for (const Term& term : terms) EXPECT_EQ(dictionary.Find(term), std::nullopt);
  }
  dictionary.BeginTurn();
  const TermId kept = dictionary.Intern(terms[3]);
  dictionary.KeepTurn();
  dictionary.DropTurn();
  std::thread([&] { EXPECT_EQ(dictionary.Find(terms[3]), kept); }).join();
}

// Turns of random terms, some refused, against a dictionary that never saw those; and readers beside.
TEST(DictionaryTest, RefusedTurnsLeaveNoTrace) {
  Dictionary dictionary, without;
  std::atomic<bool> done = false, wrong = false;
  std::atomic<size_t> kept_terms = 0;  // "t0" to this number are in both
  const auto name = [](size_t i) { return absl::StrCat("http://e/t", i); };
  std::thread reader([&] {
    for (size_t i = 0; !done; i = i * 7 + 1) {
      const size_t known = kept_terms.load();
      if (known == 0) continue;
      const auto id = dictionary.FindIri(name(i % known));
      if (!id || dictionary.Decode(*id).lexical != name(i % known)) wrong = true;
      if (dictionary.FindIri(absl::StrCat("http://e/refused", i % 5000))) wrong = true;
    }
  });
  uint32_t dice = 1;
  const auto roll = [&dice](uint32_t sides) { return (dice = dice * 1664525 + 1013904223) / 65536 % sides; };
  for (int turn = 0; turn < 400; ++turn) {
    const bool refused = roll(2) == 0;
    dictionary.BeginTurn();
    const uint32_t count = roll(roll(10) == 0 ? 5000 : 50);
    for (uint32_t i = 0; i < count; ++i) {
      if (refused) {
        dictionary.InternIri(absl::StrCat("http://e/refused", roll(5000)));
        continue;
      }
      const size_t number = kept_terms.load() + i;
      if (dictionary.InternIri(name(number)) != without.InternIri(name(number))) wrong = true;
    }
    if (refused) {
      dictionary.DropTurn();
    } else {
      dictionary.KeepTurn();
      kept_terms += count;
    }
    if (dictionary.size() != without.size()) wrong = true;
  }
  done = true;
  reader.join();
  EXPECT_FALSE(wrong);
  for (size_t i = 0; i < kept_terms; ++i) ASSERT_EQ(dictionary.FindIri(name(i)), without.FindIri(name(i)));
}

}  // namespace
}  // namespace docent
