// Regular expressions of XPath and XQuery Functions 3.1 (5.6) and XSD 1.1 part 2 (appendix G). RE2 and our
// own matcher both search each expression if both can.
#include "graph/sparql/regex/regex.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "graph/sparql/regex/regex_matcher.h"

namespace docent::sparql {
namespace {

class NoGuard : public MatchGuard {
 public:
  bool Worked(size_t) override { return true; }
  bool Charge(size_t bytes) override { return (held += bytes) <= most; }
  void Release(size_t bytes) override { held -= bytes; }
  size_t held = 0;
  size_t most = 64u << 20;
};

std::string Mistake(std::string_view pattern, std::string_view flags = "") {
  std::unique_ptr<Regex> regex;
  const auto mistake = Regex::Compile(pattern, flags, false, &regex);
  return mistake ? mistake->message : "";
}

// "no" or the texts of the groups, from the whole match on, each in brackets.
std::string FoundBy(RegexMatcher* matcher, const RegexTree& tree, std::string_view text) {
  NoGuard guard;
  matcher->Begin(text, &guard);
  std::string out = matcher->Find(0) ? "" : "no";
  for (int i = 0; out != "no" && i <= tree.groups; ++i)
    out += "[" + std::string(matcher->Group(i).value_or("")) + "]";
  EXPECT_TRUE(matcher->status().ok()) << matcher->status();
  matcher->End();
  EXPECT_EQ(guard.held, 0u);
  return out;
}

std::string Found(std::string_view pattern, std::string_view text, std::string_view flags = "") {
  std::unique_ptr<Regex> regex;
  if (const auto mistake = Regex::Compile(pattern, flags, true, &regex))
    return "mistake: " + mistake->message;
  NoGuard guard;
  std::vector<std::string_view> groups(static_cast<size_t>(regex->groups()) + 1);
  std::string out = "no";
  {
    Regex::Searches searches(regex.get(), text, &guard);
    const auto found = searches.Find(0, absl::MakeSpan(groups));
    EXPECT_TRUE(found.ok()) << found.status();
    if (found.ok() && *found) {
      out.clear();
      for (const std::string_view group : groups) out += "[" + std::string(group) + "]";
    }
  }
  EXPECT_EQ(guard.held, 0u);
  RegexTree tree;
  EXPECT_FALSE(ParseRegex(pattern, flags, &tree).has_value());
  const RegexProgram program = CompileRegexProgram(tree);
  RegexMatcher matcher(program);
  EXPECT_EQ(FoundBy(&matcher, tree, text), out) << "our matcher, " << pattern << " on " << text;
  return out;
}

bool Matches(std::string_view pattern, std::string_view text, std::string_view flags = "") {
  const std::string found = Found(pattern, text, flags);
  EXPECT_NE(found.substr(0, 7), "mistake") << found << " in " << pattern;
  return found != "no";
}

struct Case {
  const char* pattern;
  const char* text;
  bool matches;
  const char* flags = "";
};

void Check(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    EXPECT_EQ(Matches(c.pattern, c.text, c.flags), c.matches)
        << c.pattern << " on \"" << c.text << "\" with flags \"" << c.flags << '"';
  }
}

TEST(Regex, QuantifiersAlternativesAndGroups) {
  EXPECT_EQ(Found("", "abc"), "[]");
  EXPECT_EQ(Found("a|", "b"), "[]");
  EXPECT_EQ(Found("()", "b"), "[][]");
  EXPECT_EQ(Found("a||b", "b"), "[]");
  EXPECT_EQ(Found("(a|ab)(c|bcd)(d*)", "abcd"),
            "[abcd][a][bcd][]");  // the first alternative that leads to a match
  EXPECT_EQ(Found("x{2}", "xxx"), "[xx]");
  EXPECT_EQ(Found("x{2,}", "xxx"), "[xxx]");
  EXPECT_EQ(Found("x{1,2}", "xxx"), "[xx]");
  EXPECT_EQ(Found("x{0}y", "xy"), "[y]");
  EXPECT_EQ(Found("x{0,0}", "x"), "[]");
  EXPECT_EQ(Found("x{1,2}?", "xxx"), "[x]");
  EXPECT_EQ(Found("x+?", "xxx"), "[x]");
  EXPECT_EQ(Found("x*?y", "xxy"), "[xxy]");
  EXPECT_EQ(Found("x??y", "xy"), "[xy]");
  EXPECT_EQ(Found("x{2,}?", "xxx"), "[xx]");
  EXPECT_EQ(Found("(?:ab)+(c)", "ababc"), "[ababc][c]");
  EXPECT_EQ(Found("((a)|b)*", "ab"), "[ab][b][a]");
  EXPECT_EQ(Found("(a)|(b)", "b"), "[b][][b]");
  EXPECT_EQ(Found("(?:)a", "a"), "[a]");
  EXPECT_TRUE(Matches("(a*)*b", "aab"));
}

TEST(Regex, BoundsMayBeLarge) {
  const std::string a1500(1500, 'a'), a1499(1499, 'a');
  EXPECT_TRUE(Matches("^a{1500}$", a1500));
  EXPECT_FALSE(Matches("^a{1500}$", a1499));
  EXPECT_TRUE(Matches("^(?:a{40}){30,}$", a1500 + std::string(20, 'a')));
  EXPECT_TRUE(Matches("^(a{50}){1,40}$", a1500));
  EXPECT_FALSE(Matches("^(a{50}){1,29}$", a1500));
  EXPECT_TRUE(Matches("^\\w{1,255}$", "name"));
  EXPECT_FALSE(Matches("^\\w{1,255}$", a1500));
  EXPECT_NE(Mistake("a{100001}").find("regex_instructions = 100000"), std::string::npos);
  EXPECT_EQ(Mistake("a{100000}"), "");
  EXPECT_NE(Mistake("a{99999999999999999999}").find("regex_instructions"), std::string::npos);
  EXPECT_NE(Mistake("(a{1000}){1000}").find("regex_instructions"), std::string::npos);
  EXPECT_NE(Mistake("(a{0}){1000000}").find("regex_instructions"), std::string::npos);
  EXPECT_NE(Mistake("(?:a{60000})(?:b{60000})").find("regex_instructions"), std::string::npos);
}

TEST(Regex, ClassesAndTheirSubtraction) {
  Check({{"^[a-z-[aeiou]]$", "h", true},
         {"^[a-z-[aeiou]]$", "e", false},
         {"^[a-z-[aeiou]]$", "-", false},
         {"^[a-z-[b-y-[m]]]$", "m", true},
         {"^[a-z-[b-y-[m]]]$", "n", false},
         {"^[a-z-[b-y-[m]]]$", "a", true},
         {"^[^a-c-[d]]$", "d", false},
         {"^[^a-c-[d]]$", "a", false},
         {"^[^a-c-[d]]$", "e", true},
         {"^[a-z-[^aeiou]]$", "e", true},
         {"^[a-z-[^aeiou]]$", "b", false},
         {"^[\\w-[\\d]]$", "5", false},
         {"^[\\w-[\\d]]$", "x", true},
         {"^[\\p{L}-[\\p{IsBasicLatin}]]$", "x", false},
         {"^[\\p{L}-[\\p{IsBasicLatin}]]$", "é", true},
         {"[a-a-[a]]", "a", false},
         {"^[-]$", "-", true},
         {"^[-a]$", "-", true},
         {"^[a-]$", "-", true},
         {"^[^-]$", "-", false},
         {"^[--]$", "-", true},
         {"^[a-z-0]$", "-", true},
         {"^[a-z-0]$", "0", true},
         {"^[a-c-1-4x-z-7-9]+$", "a-1x-7", true},
         {"^[a-c-1-4x-z-7-9]+$", "5", false},
         {"^[a-z--[aeiou]]$", "-", true},
         {"^[a-z--[aeiou]]$", "e", false},
         {"^[a--[a]]$", "-", true},
         {"^[a--[a]]$", "a", false},
         {"^[--[-]]$", "-", false},
         {"^[\\d-z]$", "-", true},
         {"^[\\d-z]$", "q", false},
         {"^[\\--a]$", "A", true},
         {"^[+-\\-]$", ",", true},
         {"^[\\d\\-]$", "-", true},
         {"^[a^]$", "^", true},
         {"^[\\^a]$", "^", true},
         {"^[^^]$", "^", false},
         {"^[.*+?(){}|$]+$", ".*+?(){}|$", true},
         {"^[\\]\\[\\\\]+$", "[]\\", true},
         {"^[^\\s\\d]$", "x", true},
         {"^[^\\s\\d]$", "5", false},
         {"^[\\S]$", " ", false},
         {"^[\\D\\d]$", "x", true}});
}

TEST(Regex, Escapes) {
  Check({{"^\\n\\r\\t$", "\n\r\t", true},
         {"^\\.\\\\\\?\\*\\+\\{\\}\\(\\)\\[\\]\\|\\-\\^\\$$", ".\\?*+{}()[]|-^$", true},
         {"^\\s+$", " \t\n\r", true},
         {"\\s", "\u00A0", false},  // a space of Unicode, none of XML
         {"\\s", "\f", false},
         {"\\S", "\u00A0", true},
         {"^\\d+$", "0٣९", true},  // digits of Arabic and Devanagari
         {"\\d", "²", false},
         {"\\D", "٣", false},
         {"^\\w+$", "aé中٣", true},
         {"\\w", "_", false},  // punctuation
         {"\\w", "-", false},
         {"^\\w$", "+", true},  // a symbol
         {"^\\w$", "€", true},
         {"^\\W+$", "_-!. ", true},
         {"^\\i\\c*$", "a1_", true},
         {"^\\i\\c*$", "_:a.b-c·", true},
         {"^\\i", "1", false},
         {"^\\i", "-", false},
         {"^\\i", "é", true},
         {"\\I", "a", false},
         {"^\\I$", "1", true},
         {"^\\C$", " ", true},
         {"\\C", "a-.1", false},
         {"^[\\i-[:]][\\c-[:]]*$", "a:b", false},
         {"^[\\i-[:]][\\c-[:]]*$", "ab", true}});
}

TEST(Regex, CategoriesAndBlocks) {
  Check({{"^\\p{L}+$", "aZé中", true},
         {"\\p{L}", "5", false},
         {"^\\P{L}$", "5", true},
         {"^\\p{Lu}$", "É", true},
         {"\\p{Lu}", "é", false},
         {"^\\p{Lt}$", "ǅ", true},
         {"^\\p{Mn}$", "\u0301", true},
         {"^\\p{Nl}$", "Ⅷ", true},
         {"^\\p{No}$", "²", true},
         {"^\\p{Pc}\\p{Pd}\\p{Ps}\\p{Pe}\\p{Pi}\\p{Pf}\\p{Po}$", "_-()«»!", true},
         {"^\\p{Sm}\\p{Sc}\\p{Sk}\\p{So}$", "+€^©", true},
         {"^\\p{Zs}$", " ", true},
         {"^\\p{Cc}$", "\x01", true},
         {"^\\p{Co}$", "\uE000", true},
         {"^\\p{Cn}$", "\u0378", true},
         {"^\\p{C}$", "\u200B", true},  // Cf
         {"^\\p{IsGreek}$", "α", true},
         {"^\\p{IsGreekandCoptic}$", "α", true},
         {"\\p{IsGreek}", "a", false},
         {"^\\P{IsGreek}$", "a", true},
         {"^\\p{IsBasicLatin}+$", "aZ~\x01", true},
         {"\\p{IsBasicLatin}", "é", false},
         {"^\\p{IsLatin-1Supplement}$", "é", true},
         {"^\\p{IsLatinExtended-A}$", "ő", true},
         {"^\\p{IsCyrillic}$", "я", true},
         {"^\\p{IsHangulSyllables}$", "한", true},
         {"^\\p{IsCJKUnifiedIdeographs}$", "中", true},
         {"^\\p{IsCombiningMarksforSymbols}$", "\u20D0", true},
         {"^\\p{IsCombiningDiacriticalMarksforSymbols}$", "\u20D0", true},
         {"^\\p{IsPrivateUse}$", "\U000F0000", true},
         {"^\\p{IsEmoticons}$", "😀", true},
         {"\\p{IsHighSurrogates}", "a", false}});
}

TEST(Regex, DotAndAnchors) {
  Check({{"^a.b$", "a\nb", false},
         {"^a.b$", "a\rb", false},
         {"^a.b$", "a\nb", true, "s"},
         {"^a.b$", "a😀b", true},
         {"^b$", "a\nb\nc", false},
         {"^b$", "a\nb\nc", true, "m"},
         {"b$", "ab\n", false},  // the end of the text, not the place before its last newline
         {"b$", "ab\n", true, "m"},
         {"^$", "", true},
         {"^$", "", true, "m"},
         {"^$", "abcd\ndefg\n", false, "m"},  // the text does not have an empty line at its end
         {"^$", "abcd\n\ndefg\n", true, "m"},
         {"^$", "\n", true, "m"},
         {"\\n^", "a\n", false, "m"},
         {"\\n$", "a\n", false, "m"},
         {"\\n^", "a\n\n", true, "m"},
         {"a\\s$", "a\n", false, "m"},
         {"a\\s", "a\n", true, "m"},
         {"a\\s(^|x)", "a\nx", true, "m"},
         {"^a$", "b\r\na\r\n", false, "m"},  // lines end with \n alone
         {"a^b", "ab", false},
         {"a$b", "a\nb", false, "m"},
         {"a$\\nb", "a\nb", true, "m"},
         {"(^a)*b", "b", true},
         {"^*a", "a", true},
         {"a$?", "ab", true},
         {"^^a$$", "a", true}});
}

TEST(Regex, FlagIKnowsCaseVariants) {
  Check({{"hello", "HeLLo", true, "i"},
         {"^[a-c]$", "B", true, "i"},
         {"^[A-Z]$", "\u212A", true, "i"},  // the Kelvin sign: its lower case is k
         {"^k$", "\u212A", true, "i"},
         {"^s$", "ſ", true, "i"},
         {"^σ$", "ς", true, "i"},
         {"^Σ$", "ς", true, "i"},
         {"^É$", "é", true, "i"},
         {"^ß$", "ẞ", true, "i"},
         {"^ß$", "SS", false, "i"},
         {"^[A-Z-[IO]]$", "b", true, "i"},
         {"^[A-Z-[IO]]$", "i", false, "i"},
         {"^[A-Z-[IO]]$", "O", false, "i"},
         {"^[^Q]$", "q", false, "i"},
         {"^[^Q]$", "r", true, "i"},
         {"^\\p{Lu}$", "a", false, "i"},  // categories are as they are
         {"^[\\p{Lu}x]$", "a", false, "i"},
         {"^[\\p{Lu}x]$", "X", true, "i"},
         {"^\\P{Lu}$", "A", false, "i"},
         {"^([md])[aeiou]\\1$", "Mum", true, "i"},
         {"^([md])[aeiou]\\1$", "mom", true, "i"},
         {"^([md])[aeiou]\\1$", "DUD", true, "i"},
         {"^([md])[aeiou]\\1$", "mud", false, "i"},
         {"^(σ)\\1$", "ΣΣ", true, "i"},
         {"A.B", "a.b", true, "iq"},
         {"A.B", "a+b", false, "iq"}});
}

TEST(Regex, FlagsXAndQ) {
  Check({{"hello world", "helloworld", true, "x"},
         {"hello\\ sworld", "hello world", true, "x"},
         {"hello[ ]world", "hello world", true, "x"},
         {"[a b-[ ]]", " ", false, "x"},
         {"[a b-[c]]", " ", true, "x"},
         {"a { 2 }", "aa", true, "x"},
         {"( ?: a ) \\p{ L u }", "aB", true, "x"},
         {"a\tb\r\nc", "abc", true, "x"},
         {"a\u00A0b", "ab", false, "x"},
         {"^(a)(b)\\ 1$", "aba", true, "x"},
         {"\\[ a", "[a", true, "x"},
         {"a.b[", "a.b[", true, "q"},
         {"a.b", "axb", false, "q"},
         {"^", "a", false, "q"},
         {"a b", "a b", true, "qx"},
         {"", "a", true, "q"},
         {"a", "b\na", true, "qsm"}});
  EXPECT_EQ(Mistake("a", "z"), "'z' is not a flag");
  EXPECT_EQ(Mistake("a", "I"), "'I' is not a flag");
  EXPECT_EQ(Mistake("a", " "), "' ' is not a flag");
  EXPECT_EQ(Mistake("a", "ii"), "");
  EXPECT_NE(Mistake("a\\ b", "x"), "");  // \b
}

TEST(Regex, BackReferences) {
  Check({{"^(ab)\\1$", "abab", true},
         {"^(ab)\\1$", "abba", false},
         {"(['\"]).*?\\1", "say 'it' now", true},
         {"^(a*)b\\1$", "aabaa", true},
         {"^(a*)b\\1$", "aaba", false},
         {"^(a)(b)(c)(d)(e)(f)(g)(h)(i)(j)(k)\\11$", "abcdefghijkk", true},
         {"^(a)\\11$", "aa1", true},  // one group: \1 and the digit 1
         {"^(a)(b)(c)(d)(e)(f)(g)(h)(i)(j)\\11$", "abcdefghija1", true},
         {"^(a)|\\1b$", "b", true},  // a group that has not matched stands for nothing
         {"^(?:(a)|b)\\1$", "b", true},
         {"^(?:(a)|b)*\\1$", "aba", true},
         {"^(a?)\\1$", "", true},
         {"^((a)\\2)+$", "aaaa", true},
         {"^(.)\\1{2}$", "xxx", true},
         {"^(.)\\1{2}$", "xx", false},
         {"^(é)\\1$", "éé", true},
         {"^(?:(a*))*\\1$", "aaa", true},
         {"^(\\w+)\\s+\\1$", "the the", true}});
  EXPECT_EQ(Found("^(a+)\\1$", "aaaa"), "[aaaa][aa]");
}

TEST(Regex, WhatXPathDoesNotHaveIsAMistake) {
  for (const char* const pattern : {"(?i)a",
                                    "(?i:a)",
                                    "(?=a)",
                                    "(?!a)",
                                    "(?<=a)",
                                    "(?<!a)",
                                    "(?<n>a)",
                                    "(?P<n>a)",
                                    "(?>a)",
                                    "(?#c)",
                                    "(?-i)a",
                                    "(?",
                                    "(?|a)",
                                    "\\A",
                                    "\\Z",
                                    "\\z",
                                    "\\b",
                                    "\\B",
                                    "\\G",
                                    "\\x41",
                                    "\\x{41}",
                                    "\\u0041",
                                    "\\Qa\\E",
                                    "\\E",
                                    "\\0",
                                    "\\01",
                                    "\\a",
                                    "\\e",
                                    "\\f",
                                    "\\v",
                                    "\\h",
                                    "\\R",
                                    "\\K",
                                    "\\N",
                                    "\\X",
                                    "\\k<n>",
                                    "\\g1",
                                    "\\cA!\\m",
                                    "\\_",
                                    "\\/",
                                    "\\ ",
                                    "\\\"",
                                    "\\'",
                                    "\\,",
                                    "\\:",
                                    "\\@",
                                    "\\#",
                                    "\\=",
                                    "\\<",
                                    "\\é",
                                    "\\pL",
                                    "\\p",
                                    "\\p{",
                                    "\\p{}",
                                    "\\p{L",
                                    "\\p{Greek}",
                                    "\\p{Alpha}",
                                    "\\p{IsNone}",
                                    "\\p{Isgreek}",
                                    "\\p{IsLatin-1 Supplement}",
                                    "\\p{LC}",
                                    "\\p{Cs}",
                                    "\\p{^L}",
                                    "\\p{l}",
                                    "\\p{Latin}",
                                    "\\p{Is}",
                                    "[[:alpha:]]",
                                    "[:alpha:]]",
                                    "[a[b]]",
                                    "[a&&[b]]",
                                    "[]",
                                    "[^]",
                                    "[]a]",
                                    "[a",
                                    "[a-",
                                    "[a-z",
                                    "[z-a]",
                                    "[a-\\d]",
                                    "[a--b]",
                                    "[--z]",
                                    "[+--]",
                                    "[---]",
                                    "[-[a]]",
                                    "[a-z-[aeiou]x]",
                                    "[a-z-[aeiou]",
                                    "[\\b]",
                                    "[\\1]",
                                    "[\\x41]",
                                    "[a-\\]",
                                    "a**",
                                    "a++",
                                    "a*+",
                                    "a?+",
                                    "a???",
                                    "a{2}{3}",
                                    "a{2}*",
                                    "a{1}+",
                                    "*",
                                    "+a",
                                    "?",
                                    "{2}",
                                    "|*",
                                    "(*a)",
                                    "a{",
                                    "a}",
                                    "a{}",
                                    "a{,2}",
                                    "a{2,1}",
                                    "a{x}",
                                    "a{1,2",
                                    "a{-1}",
                                    "a{1 }",
                                    "{",
                                    "}",
                                    "]",
                                    "a]",
                                    "(",
                                    ")",
                                    "(a",
                                    "a)",
                                    "(a))",
                                    "\\",
                                    "a\\",
                                    "\\1",
                                    "(a)\\2",
                                    "(a\\1)",
                                    "\\1(a)",
                                    "(?:a)\\1",
                                    "((a)\\1)"}) {
    EXPECT_NE(Mistake(pattern), "") << pattern;
  }
}

TEST(Regex, AMistakeSaysWhatAndWhere) {
  std::unique_ptr<Regex> regex;
  const auto mistake = [&](std::string_view pattern, std::string_view flags = "") {
    return *Regex::Compile(pattern, flags, false, &regex);
  };
  EXPECT_EQ(mistake("ab(?i)").offset, 2u);
  EXPECT_EQ(mistake("ab(?i)").message, "'(?i' is not a group of XPath's regular expressions");
  EXPECT_NE(mistake("ab(?i)").hint.find("third argument of REGEX"), std::string::npos);
  EXPECT_EQ(mistake("é\\b").offset, 2u);
  EXPECT_EQ(mistake("é\\b").length, 2u);
  EXPECT_EQ(mistake("a b \\A", "x").offset, 4u);
  EXPECT_EQ(mistake("x[[:alpha:]]").offset, 2u);
  EXPECT_EQ(mistake("\\p{IsGrek}").hint, "did you mean IsGreek?");
  EXPECT_EQ(mistake("a", "iz").offset, 1u);
  EXPECT_EQ(mistake("a", "iz").where, RegexMistake::Where::kFlags);
  EXPECT_EQ(mistake("a{2,1}").message, "the quantity '{2,1}' has its numbers in the wrong order");
}

TEST(Regex, LimitsOfTextAndNesting) {
  EXPECT_EQ(Mistake(std::string(64u << 10, 'a')), "");
  EXPECT_NE(Mistake(std::string((64u << 10) + 1, 'a')).find("regex_pattern_bytes"), std::string::npos);
  const auto nested = [](int n) { return std::string(n, '(') + 'a' + std::string(n, ')'); };
  EXPECT_EQ(Mistake(nested(200)), "");
  EXPECT_TRUE(Matches(nested(200), "a"));
  EXPECT_NE(Mistake(nested(201)).find("regex_nesting = 200"), std::string::npos);
  std::string classes = "[a-z", ends = "]";
  for (int i = 1; i < 200; ++i) classes += "-[a-z", ends += "]";
  EXPECT_EQ(Mistake(classes + ends), "");
  EXPECT_NE(Mistake(classes + "-[a]" + ends).find("regex_nesting"), std::string::npos);
  std::string words;
  for (int i = 0; i < 2000; ++i) words += "[\\w]";
  EXPECT_NE(Mistake(words).find("regex_ranges"), std::string::npos);
}

TEST(Regex, ASearchThatWouldNotEndStopsAtItsLimit) {
  std::unique_ptr<Regex> regex;
  RegexLimits limits;
  limits.regex_backtracking_steps = 100000;
  ASSERT_FALSE(Regex::Compile("^(a+)+\\1$", "", false, &regex, limits).has_value());
  const std::string text = std::string(40, 'a') + "b";
  NoGuard guard;
  Regex::Searches searches(regex.get(), text, &guard);
  const auto found = searches.Find(0, {});
  EXPECT_EQ(found.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(found.status().message().find("regex_backtracking_steps = 100000"), std::string::npos)
      << found.status();
}

TEST(Regex, WithoutBackReferencesNoTextTakesExponentialTime) {
  const std::string text = std::string(2000, 'a') + "b";
  EXPECT_FALSE(Matches("^(a+)+$", text));
  EXPECT_FALSE(Matches("^(a|a)*$", text));
  EXPECT_FALSE(Matches("^(a?){300}c$", text));
  EXPECT_FALSE(Matches("^(?:(?:a*)*)*$", text));
}

TEST(Regex, MemoryOfASearchIsCounted) {
  std::unique_ptr<Regex> regex;
  ASSERT_FALSE(Regex::Compile("^(.*)(.*)\\1$", "", false, &regex).has_value());
  const std::string text(100000, 'a');
  NoGuard guard;
  guard.most = 100000;
  {
    Regex::Searches searches(regex.get(), text, &guard);
    EXPECT_FALSE(searches.Find(0, {}).ok());
  }
  EXPECT_EQ(guard.held, 0u);
}

TEST(Regex, SearchesFollowEachOtherInOneText) {
  for (const char* const pattern : {"a+", "(a)\\1*", "(?:a){1,2000}"}) {
    std::unique_ptr<Regex> regex;
    ASSERT_FALSE(Regex::Compile(pattern, "", true, &regex).has_value());
    NoGuard guard;
    const std::string text = "aabaaab";
    Regex::Searches searches(regex.get(), text, &guard);
    std::string all;
    std::string_view whole;
    for (size_t at = 0; *searches.Find(at, {&whole, 1}); at = static_cast<size_t>(whole.end() - text.data()))
      all += std::string(whole) + ' ';
    EXPECT_EQ(all, "aa aaa ") << pattern;
  }
}

}  // namespace
}  // namespace docent::sparql
