#include "graph/rdf/iri.h"

#include <gtest/gtest.h>

#include "graph/rdf/utf8.h"

namespace docent {
namespace {

TEST(IriTest, Absolute) {
  EXPECT_TRUE(IsAbsoluteIri("http://a"));
  EXPECT_TRUE(IsAbsoluteIri("urn:x"));
  EXPECT_TRUE(IsAbsoluteIri("a+b-c.d:"));
  for (const char* text : {"", "a", "/a:b", "1a:b", ":a", "a/b:c", "#x", "?x:y"})
    EXPECT_FALSE(IsAbsoluteIri(text)) << text;
}

TEST(IriTest, ValidTermIri) {
  EXPECT_TRUE(IsValidTermIri("http://a/\xC3\xA9?x=1#y"));
  for (const char* text : {"a", "http://a b", "http://a<", "http://a{", "http://a\\", "http://a\n"}) {
    EXPECT_FALSE(IsValidTermIri(text)) << text;
  }
}

// RFC 3986 section 5.4: all examples, normal and abnormal.
TEST(IriTest, ResolvesTheExamplesOfTheRfc) {
  struct Example {
    const char* reference;
    const char* result;
  };
  for (const Example& e : std::initializer_list<Example>{{"g:h", "g:h"},
                                                         {"g", "http://a/b/c/g"},
                                                         {"./g", "http://a/b/c/g"},
                                                         {"g/", "http://a/b/c/g/"},
                                                         {"/g", "http://a/g"},
                                                         {"//g", "http://g"},
                                                         {"?y", "http://a/b/c/d;p?y"},
                                                         {"g?y", "http://a/b/c/g?y"},
                                                         {"#s", "http://a/b/c/d;p?q#s"},
                                                         {"g#s", "http://a/b/c/g#s"},
                                                         {"g?y#s", "http://a/b/c/g?y#s"},
                                                         {";x", "http://a/b/c/;x"},
                                                         {"g;x", "http://a/b/c/g;x"},
                                                         {"g;x?y#s", "http://a/b/c/g;x?y#s"},
                                                         {"", "http://a/b/c/d;p?q"},
                                                         {".", "http://a/b/c/"},
                                                         {"./", "http://a/b/c/"},
                                                         {"..", "http://a/b/"},
                                                         {"../", "http://a/b/"},
                                                         {"../g", "http://a/b/g"},
                                                         {"../..", "http://a/"},
                                                         {"../../", "http://a/"},
                                                         {"../../g", "http://a/g"},
                                                         {"../../../g", "http://a/g"},
                                                         {"../../../../g", "http://a/g"},
                                                         {"/./g", "http://a/g"},
                                                         {"/../g", "http://a/g"},
                                                         {"g.", "http://a/b/c/g."},
                                                         {".g", "http://a/b/c/.g"},
                                                         {"g..", "http://a/b/c/g.."},
                                                         {"..g", "http://a/b/c/..g"},
                                                         {"./../g", "http://a/b/g"},
                                                         {"./g/.", "http://a/b/c/g/"},
                                                         {"g/./h", "http://a/b/c/g/h"},
                                                         {"g/../h", "http://a/b/c/h"},
                                                         {"g;x=1/./y", "http://a/b/c/g;x=1/y"},
                                                         {"g;x=1/../y", "http://a/b/c/y"},
                                                         {"g?y/./x", "http://a/b/c/g?y/./x"},
                                                         {"g#s/../x", "http://a/b/c/g#s/../x"}}) {
    EXPECT_EQ(ResolveIri(e.reference, "http://a/b/c/d;p?q"), e.result) << e.reference;
  }
}

TEST(IriTest, BasesWithoutPathOrAuthority) {
  EXPECT_EQ(ResolveIri("x", "http://a"), "http://a/x");
  EXPECT_EQ(ResolveIri("x", "urn:docent"), "urn:x");
  EXPECT_EQ(ResolveIri("#x", "urn:docent:hall"), "urn:docent:hall#x");
}

TEST(Utf8Test, FindsTheFirstBadByte) {
  EXPECT_FALSE(
      FindInvalidUtf8("plain and \xC3\xA9 and \xE2\x82\xAC and \xF0\x9F\x98\x80 long enough").has_value());
  EXPECT_EQ(FindInvalidUtf8("ab\xC3"), 2u);
  EXPECT_EQ(FindInvalidUtf8("ab\x80 and more text behind"), 2u);
  EXPECT_EQ(FindInvalidUtf8("\xC0\x80"), 0u);          // overlong
  EXPECT_EQ(FindInvalidUtf8("\xE0\x80\x80"), 0u);      // overlong
  EXPECT_EQ(FindInvalidUtf8("x\xED\xA0\x80"), 1u);     // surrogate
  EXPECT_EQ(FindInvalidUtf8("\xF4\x90\x80\x80"), 0u);  // past U+10FFFF
  EXPECT_EQ(FindInvalidUtf8("01234567\xFFxxxxxxxx"), 8u);
}

TEST(Utf8Test, WritesWhatItReads) {
  for (char32_t c : {U'\0', U'a', U'\x7F', U'\x80', U'\x7FF', U'\x800', U'\xFFFD', U'\x10000', U'\x10FFFF'}) {
    std::string text;
    AppendUtf8(c, &text);
    EXPECT_FALSE(FindInvalidUtf8(text).has_value());
    size_t at = 0;
    EXPECT_EQ(NextCodePoint(text, &at), c);
    EXPECT_EQ(at, text.size());
  }
}

}  // namespace
}  // namespace docent
