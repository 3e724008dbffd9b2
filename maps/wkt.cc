#include "maps/wkt.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/charconv.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace docent::maps {
namespace {

class WktReader {
 public:
  explicit WktReader(std::string_view text) : text_(text) {}

  // POINT, POLYGON: case is ignored (OGC 06-103r4, 7.2.1).
  absl::Status Keyword(std::string_view word) {
    SkipReferenceSystem();
    SkipSpace();
    for (size_t i = 0; i < word.size(); ++i) {
      if (at_ + i >= text_.size() ||
          absl::ascii_toupper(static_cast<unsigned char>(text_[at_ + i])) != word[i]) {
        return Expected("'" + std::string(word) + "'");
      }
    }
    at_ += word.size();
    return absl::OkStatus();
  }

  bool Take(char c) {
    SkipSpace();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  absl::Status Require(char c) { return Take(c) ? absl::OkStatus() : Expected(std::string("'") + c + "'"); }

  absl::StatusOr<Point2> Coordinates() {
    absl::StatusOr<double> x = Number();
    if (!x.ok()) return x.status();
    absl::StatusOr<double> y = Number();
    if (!y.ok()) return y.status();
    return Point2{*x, *y};
  }

  absl::Status End() {
    SkipSpace();
    return at_ == text_.size() ? absl::OkStatus() : Expected("the end");
  }

  absl::Status Expected(const std::string& what) {
    SkipSpace();
    const std::string found = at_ < text_.size() ? "'" + std::string(text_.substr(at_, 12)) + "'" : "the end";
    return absl::InvalidArgumentError(
        absl::StrCat("well-known text: expected ", what, " at character ", at_ + 1, ", found ", found));
  }

 private:
  void SkipSpace() {
    while (at_ < text_.size() && absl::ascii_isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }

  void SkipReferenceSystem() {
    SkipSpace();
    if (at_ >= text_.size() || text_[at_] != '<') return;
    const size_t end = text_.find('>', at_);
    if (end != std::string_view::npos) at_ = end + 1;
  }

  absl::StatusOr<double> Number() {
    SkipSpace();
    double value = 0;
    const char* first = text_.data() + at_;
    const char* last = text_.data() + text_.size();
    const char* digits = first < last && *first == '+' ? first + 1 : first;
    const absl::from_chars_result result = absl::from_chars(digits, last, value);
    if (result.ec != std::errc() || !std::isfinite(value)) return Expected("a finite number");
    at_ += static_cast<size_t>(result.ptr - first);
    return value;
  }

  std::string_view text_;
  size_t at_ = 0;
};

double Cross(const Point2& o, const Point2& a, const Point2& b) {
  return (a.x_m - o.x_m) * (b.y_m - o.y_m) - (a.y_m - o.y_m) * (b.x_m - o.x_m);
}

// True if the open segments cross in one point (touching ends do not count).
bool Cross(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  return Cross(a, b, c) * Cross(a, b, d) < 0 && Cross(c, d, a) * Cross(c, d, b) < 0;
}

absl::StatusOr<Polygon> Checked(Polygon ring) {
  if (ring.size() < 4)
    return absl::InvalidArgumentError("well-known text: a polygon needs at least three corners");
  if (!(ring.front() == ring.back())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("well-known text: the polygon does not close: it begins at %g %g and ends at %g %g",
                        ring.front().x_m, ring.front().y_m, ring.back().x_m, ring.back().y_m));
  }
  ring.pop_back();
  if (CrossesItself(ring)) return absl::InvalidArgumentError("well-known text: edges of the polygon cross");
  if (Area(ring) <= 0) return absl::InvalidArgumentError("well-known text: the polygon has no area");
  return ring;
}

}  // namespace

bool CrossesItself(const Polygon& ring) {
  struct Edge {
    Point2 a, b;
    Bounds bounds;
  };
  std::vector<Edge> edges;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Point2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
    edges.push_back({a, b, BoundsOf({a, b})});
  }
  // A sweep along x: only edges whose ranges overlap are compared.
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return a.bounds.min_x_m < b.bounds.min_x_m; });
  for (size_t i = 0; i < edges.size(); ++i) {
    const Edge& one = edges[i];
    for (size_t j = i + 1; j < edges.size() && edges[j].bounds.min_x_m <= one.bounds.max_x_m; ++j) {
      const Edge& other = edges[j];
      const bool apart =
          other.bounds.min_y_m > one.bounds.max_y_m || other.bounds.max_y_m < one.bounds.min_y_m;
      const bool neighbours = one.a == other.b || one.b == other.a;
      if (!apart && !neighbours && Cross(one.a, one.b, other.a, other.b)) return true;
    }
  }
  return false;
}

absl::StatusOr<Point2> ReadWktPoint(std::string_view text) {
  WktReader reader(text);
  if (absl::Status s = reader.Keyword("POINT"); !s.ok()) return s;
  if (absl::Status s = reader.Require('('); !s.ok()) return s;
  absl::StatusOr<Point2> point = reader.Coordinates();
  if (!point.ok()) return point;
  if (absl::Status s = reader.Require(')'); !s.ok()) return s;
  if (absl::Status s = reader.End(); !s.ok()) return s;
  return point;
}

absl::StatusOr<Polygon> ReadWktPolygon(std::string_view text) {
  WktReader reader(text);
  if (absl::Status s = reader.Keyword("POLYGON"); !s.ok()) return s;
  if (absl::Status s = reader.Require('('); !s.ok()) return s;
  if (absl::Status s = reader.Require('('); !s.ok()) return s;
  Polygon ring;
  do {
    absl::StatusOr<Point2> corner = reader.Coordinates();
    if (!corner.ok()) return corner.status();
    ring.push_back(*corner);
  } while (reader.Take(','));
  if (absl::Status s = reader.Require(')'); !s.ok()) return s;
  if (reader.Take(',')) {
    return absl::InvalidArgumentError("well-known text: a polygon with a hole; a footprint here has none");
  }
  if (absl::Status s = reader.Require(')'); !s.ok()) return s;
  if (absl::Status s = reader.End(); !s.ok()) return s;
  return Checked(std::move(ring));
}

}  // namespace docent::maps
