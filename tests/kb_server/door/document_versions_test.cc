#include "kb_server/door/document_versions.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace docent::server {
namespace {

const VersionHistory::Key kTour{Document::Kind::kRsel, "Tour"};

TEST(VersionHistory, TheSameTextAgainIsNoNewVersion) {
  VersionHistory history;
  history.Put(kTour, "1", "a", Revision(3), 100);
  history.Put(kTour, "1", "a", Revision(4), 200);
  ASSERT_EQ(history.Find(kTour)->kept.size(), 1u);
  EXPECT_EQ(history.Find(kTour)->newest().revision, Revision(3));
  history.Put(kTour, "2", "b", Revision(5), 300);
  history.Put(kTour, "1", "a", Revision(6), 400);  // back to the first: another version
  ASSERT_EQ(history.Find(kTour)->kept.size(), 3u);
  EXPECT_EQ(history.Find(kTour)->newest().number, 3u);
  EXPECT_EQ(history.Find({Document::Kind::kCawl, "Tour"}), nullptr);
}

TEST(VersionHistory, VersionsOutliveTheDocument) {
  VersionHistory history;
  history.Put(kTour, "1", "a", Revision(3), 100);
  history.Remove(kTour, Revision(4));
  EXPECT_FALSE(history.Find(kTour)->live);
  history.Put(kTour, "1", "a", Revision(5), 200);
  EXPECT_TRUE(history.Find(kTour)->live);
  EXPECT_EQ(history.Find(kTour)->kept.size(), 1u);
  history.Remove({Document::Kind::kRsel, "Other"}, Revision(6));  // was never there
}

TEST(VersionHistory, TheNewestTextsAreKept) {
  VersionHistory history;
  const size_t most = kDocumentLimits.version_texts;
  for (size_t i = 1; i <= most; ++i) history.Put(kTour, "", absl::StrCat(i), Revision(i), 0);
  EXPECT_EQ(history.Find(kTour)->kept.front()->number, 1u);
  history.Put(kTour, "", "one more", Revision(most + 1), 0);
  EXPECT_EQ(history.Find(kTour)->kept.size(), most);
  EXPECT_EQ(history.Find(kTour)->kept.front()->number, 2u);
  EXPECT_EQ(history.Find(kTour)->newest().number, most + 1);
}

TEST(VersionHistory, LargeTextsPushOlderOnesOut) {
  VersionHistory history;
  const size_t half = kDocumentLimits.version_text_bytes / 2;
  history.Put(kTour, "", std::string(half, 'a'), Revision(1), 0);
  history.Put(kTour, "", std::string(half, 'b'), Revision(2), 0);
  EXPECT_EQ(history.Find(kTour)->kept.size(), 2u);
  history.Put(kTour, "", "c", Revision(3), 0);
  EXPECT_EQ(history.Find(kTour)->kept.size(), 2u);
  history.Put(kTour, "", std::string(3 * half, 'd'), Revision(4), 0);
  EXPECT_EQ(history.Find(kTour)->kept.size(), 1u) << "the newest stays whatever its size";
}

TEST(VersionHistory, TheDocumentsRemovedLastAreRemembered) {
  VersionHistory history;
  const size_t most = kDocumentLimits.removed_documents;
  history.Put(kTour, "", "live", Revision(1), 0);
  const auto key = [](size_t i) { return VersionHistory::Key{Document::Kind::kRsel, absl::StrCat("d", i)}; };
  for (size_t i = 0; i <= most; ++i) {
    history.Put(key(i), "", "x", Revision(10 + 2 * i), 0);
    history.Remove(key(i), Revision(11 + 2 * i));
    if (i + 1 == most) {
      EXPECT_NE(history.Find(key(0)), nullptr);
    }
  }
  EXPECT_EQ(history.Find(key(0)), nullptr);
  EXPECT_NE(history.Find(key(1)), nullptr);
  EXPECT_TRUE(history.Find(kTour)->live);
}

TEST(VersionHistory, ACopyIsIndependent) {
  VersionHistory history;
  history.Put(kTour, "", "a", Revision(1), 0);
  const VersionHistory before = history;
  history.Put(kTour, "", "b", Revision(2), 0);
  EXPECT_EQ(before.Find(kTour)->kept.size(), 1u);
  EXPECT_EQ(history.Find(kTour)->kept.size(), 2u);
}

}  // namespace
}  // namespace docent::server
