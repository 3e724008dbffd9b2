#include "maps/hall_picture.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include "absl/strings/str_format.h"

namespace docent::maps {
namespace {

constexpr double kMargin_px = 48;
constexpr double kTitle_px = 84;
constexpr double kLegend_px = 64;
constexpr Color kPaper = {1, 1, 1};
constexpr Color kFloor = {0.985, 0.982, 0.972};
constexpr Color kRegion = {0.90, 0.935, 0.925};
constexpr Color kBooth = {0.965, 0.925, 0.85};
constexpr Color kHighlight = {0.995, 0.87, 0.55};
constexpr Color kWall = {0.22, 0.24, 0.28};
constexpr Color kCounter = {0.62, 0.53, 0.42};
constexpr Color kInk = {0.15, 0.16, 0.19};
constexpr Color kPale = {0.46, 0.48, 0.52};
constexpr Color kGoal = {0.12, 0.55, 0.33};
constexpr Color kPerson = {0.55, 0.25, 0.60};

class Painter {
 public:
  Painter(const HallLayout& layout, const HallPicture& picture) : layout_(layout), picture_(picture) {
    bounds_ = BoundsOf(layout.outline);
    const double width_m = bounds_.max_x_m - bounds_.min_x_m, depth_m = bounds_.max_y_m - bounds_.min_y_m;
    scale_ = (picture.width_px - 2 * kMargin_px) / width_m;
    height_px_ = std::clamp(depth_m * scale_ + kTitle_px + kLegend_px + kMargin_px, 200.0, 16000.0);
    surface_.reset(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width_px, static_cast<int>(height_px_)));
    cairo_.reset(cairo_create(surface_.get()));
    cr_ = cairo_.get();
  }

  cairo_status_t Draw(const std::string& file) {
    Set(kPaper);
    cairo_paint(cr_);
    FillPolygon(layout_.outline, kFloor);
    for (const Region* region : LargestFirst()) DrawRegion(*region);
    if (picture_.background != nullptr) DrawBackground(*picture_.background);
    for (const Obstacle& obstacle : layout_.obstacles) DrawObstacle(obstacle);
    DrawOutline();
    for (const PicturePath& path : picture_.paths) DrawPath(path);
    for (const Region* region : LargestFirst()) DrawName(*region);
    for (const PictureMark& mark : picture_.marks) DrawMark(mark);
    DrawTitle();
    DrawLegend();
    cairo_surface_flush(surface_.get());
    return cairo_surface_write_to_png(surface_.get(), file.c_str());
  }

 private:
  struct Release {
    void operator()(cairo_t* cr) const { cairo_destroy(cr); }
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  };

  double X(double x_m) const { return kMargin_px + (x_m - bounds_.min_x_m) * scale_; }
  double Y(double y_m) const { return kTitle_px + (bounds_.max_y_m - y_m) * scale_; }
  void Set(const Color& c, double alpha = 1) { cairo_set_source_rgba(cr_, c.red, c.green, c.blue, alpha); }

  void Trace(const Polygon& polygon) {
    cairo_new_path(cr_);
    for (const Point2& p : polygon) cairo_line_to(cr_, X(p.x_m), Y(p.y_m));
    cairo_close_path(cr_);
  }

  void FillPolygon(const Polygon& polygon, const Color& color) {
    Trace(polygon);
    Set(color);
    cairo_fill(cr_);
  }

  std::vector<const Region*> LargestFirst() const {
    std::vector<const Region*> regions;
    for (const Region& region : layout_.regions) regions.push_back(&region);
    std::stable_sort(regions.begin(), regions.end(),
                     [](const Region* a, const Region* b) { return Area(a->outline) > Area(b->outline); });
    return regions;
  }

  bool Highlighted(const Region& region) const {
    return std::find(picture_.highlighted.begin(), picture_.highlighted.end(), region.iri) !=
           picture_.highlighted.end();
  }

  void DrawRegion(const Region& region) {
    Trace(region.outline);
    Set(Highlighted(region) ? kHighlight : region.is_booth ? kBooth : kRegion);
    cairo_fill_preserve(cr_);
    Set(kPale, 0.5);
    cairo_set_line_width(cr_, 1);
    const double dashes[] = {4, 3};
    cairo_set_dash(cr_, dashes, region.is_booth ? 0 : 2, 0);
    cairo_stroke(cr_);
    cairo_set_dash(cr_, nullptr, 0, 0);
  }

  void DrawBackground(const DistanceGrid& grid) {
    cairo_save(cr_);
    Trace(layout_.outline);
    cairo_clip(cr_);
    Set(kWall);
    const double cell_px = std::max(1.5, grid.resolution_m * scale_);
    for (int j = 0; j < grid.height; ++j) {
      for (int i = 0; i < grid.width; ++i) {
        if (grid.state[static_cast<size_t>(j) * grid.width + i] != CellState::kOccupied) continue;
        const Point2 center = grid.CenterOf(i, j);
        cairo_rectangle(cr_, X(center.x_m) - cell_px / 2, Y(center.y_m) - cell_px / 2, cell_px, cell_px);
      }
    }
    cairo_fill(cr_);
    cairo_restore(cr_);
  }

  void DrawObstacle(const Obstacle& obstacle) {
    cairo_new_path(cr_);
    if (obstacle.disc) {
      const Disc& d = *obstacle.disc;
      cairo_arc(cr_, X(d.center.x_m), Y(d.center.y_m), d.radius_m * scale_, 0, 2 * std::numbers::pi);
    } else {
      Trace(obstacle.outline);
    }
    Set(obstacle.kind == ObstacleKind::kCounter || obstacle.kind == ObstacleKind::kOther ? kCounter : kWall);
    cairo_fill(cr_);
  }

  void DrawOutline() {
    Trace(layout_.outline);
    Set(kWall);
    cairo_set_line_width(cr_, picture_.background == nullptr ? 5 : 1);
    cairo_stroke(cr_);
  }

  void DrawPath(const PicturePath& path) {
    if (path.points.empty()) return;
    cairo_new_path(cr_);
    for (const Point2& p : path.points) cairo_line_to(cr_, X(p.x_m), Y(p.y_m));
    cairo_set_line_join(cr_, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cr_, CAIRO_LINE_CAP_ROUND);
    StrokePath(path);
  }

  void StrokePath(const PicturePath& path) {
    const double dashes[] = {1, 7};
    cairo_set_line_width(cr_, path.dashed ? 4 : 3);
    cairo_set_dash(cr_, dashes, path.dashed ? 2 : 0, 0);
    Set(path.color, 0.95);
    cairo_stroke(cr_);
    cairo_set_dash(cr_, nullptr, 0, 0);
  }

  void Font(double size_px, bool bold) {
    cairo_select_font_face(cr_, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr_, size_px);
  }

  double TextWidth(const std::string& text) {
    cairo_text_extents_t extents;
    cairo_text_extents(cr_, text.c_str(), &extents);
    return extents.x_advance;
  }

  // Text with a light halo, readable over lines.
  void Text(double x_px, double y_px, const std::string& text, const Color& color) {
    cairo_new_path(cr_);
    cairo_move_to(cr_, x_px, y_px);
    cairo_text_path(cr_, text.c_str());
    Set(kPaper, 0.8);
    cairo_set_line_width(cr_, 3);
    cairo_stroke_preserve(cr_);
    Set(color);
    cairo_fill(cr_);
  }

  void DrawName(const Region& region) {
    const Bounds b = BoundsOf(region.outline);
    const Point2 at = Centroid(region.outline);
    double size = region.is_booth ? 17 : 14;
    Font(size, region.is_booth);
    const double room = (b.max_x_m - b.min_x_m) * scale_ - 8;
    const double width = TextWidth(region.name);
    if (width > room) Font(size = std::max(9.0, size * room / width), region.is_booth);
    Text(X(at.x_m) - TextWidth(region.name) / 2, Y(at.y_m) + size / 3, region.name,
         region.is_booth ? kInk : kPale);
    if (region.exhibitor.empty()) return;
    Font(11, false);
    if (TextWidth(region.exhibitor) <= room) {
      Text(X(at.x_m) - TextWidth(region.exhibitor) / 2, Y(at.y_m) + size / 3 + 15, region.exhibitor, kPale);
    }
  }

  void DrawMark(const PictureMark& mark) {
    const double x = X(mark.pose.x_m), y = Y(mark.pose.y_m);
    cairo_new_path(cr_);
    if (mark.kind == PictureMark::Kind::kRobot) {
      const double c = std::cos(mark.pose.heading_rad), s = -std::sin(mark.pose.heading_rad);
      for (const auto& [ahead, left] : {std::pair(14.0, 0.0), {-9.0, 8.0}, {-5.0, 0.0}, {-9.0, -8.0}}) {
        cairo_line_to(cr_, x + ahead * c + left * s, y + ahead * s - left * c);
      }
      cairo_close_path(cr_);
      Set(kEstimateColor);
    } else if (mark.kind == PictureMark::Kind::kGoal) {
      cairo_move_to(cr_, x, y);
      cairo_rel_line_to(cr_, 0, -26);
      cairo_rel_line_to(cr_, 17, 6);
      cairo_rel_line_to(cr_, -14, 6);
      cairo_rel_line_to(cr_, 0, 14);
      cairo_close_path(cr_);
      Set(kGoal);
    } else {
      cairo_arc(cr_, x, y, mark.kind == PictureMark::Kind::kPerson ? 9 : 7, 0, 2 * std::numbers::pi);
      Set(mark.kind == PictureMark::Kind::kPerson ? kPerson : kTruthColor);
    }
    cairo_fill_preserve(cr_);
    Set(kPaper);
    cairo_set_line_width(cr_, 1.5);
    cairo_stroke(cr_);
    Font(14, true);
    if (!mark.label.empty()) Text(x + 13, y - 8, mark.label, kInk);
  }

  void DrawTitle() {
    Font(26, true);
    Text(kMargin_px, 36, picture_.title.empty() ? layout_.name : picture_.title, kInk);
    Font(15, false);
    Text(kMargin_px, 62, picture_.subtitle, kPale);
  }

  void DrawLegend() {
    double x = kMargin_px;
    const double y = height_px_ - kLegend_px / 2;
    Font(15, false);
    for (const PicturePath& path : picture_.paths) {
      cairo_new_path(cr_);
      cairo_move_to(cr_, x, y);
      cairo_line_to(cr_, x + 44, y);
      StrokePath(path);
      Text(x + 54, y + 5, path.label, kInk);
      x += 54 + TextWidth(path.label) + 36;
    }
    DrawScaleBar(y);
  }

  // A bar of 1, 2 or 5 times a power of ten metres, about a tenth of the picture wide.
  void DrawScaleBar(double y) {
    const double wanted_m = picture_.width_px / 10.0 / scale_;
    double length_m = std::pow(10, std::floor(std::log10(wanted_m)));
    if (length_m * 5 <= wanted_m) {
      length_m *= 5;
    } else if (length_m * 2 <= wanted_m) {
      length_m *= 2;
    }
    const double right = picture_.width_px - kMargin_px, left = right - length_m * scale_;
    cairo_new_path(cr_);
    cairo_move_to(cr_, left, y - 5);
    cairo_line_to(cr_, left, y);
    cairo_line_to(cr_, right, y);
    cairo_line_to(cr_, right, y - 5);
    Set(kInk);
    cairo_set_line_width(cr_, 2);
    cairo_stroke(cr_);
    const std::string label = absl::StrFormat("%g m", length_m);
    Text((left + right - TextWidth(label)) / 2, y + 18, label, kInk);
  }

  const HallLayout& layout_;
  const HallPicture& picture_;
  Bounds bounds_;
  double scale_ = 1;  // pixels a metre
  double height_px_ = 0;
  std::unique_ptr<cairo_surface_t, Release> surface_;
  std::unique_ptr<cairo_t, Release> cairo_;
  cairo_t* cr_ = nullptr;
};

}  // namespace

absl::Status WritePng(const HallLayout& layout, const HallPicture& picture, const std::string& path) {
  if (layout.outline.empty()) return absl::InvalidArgumentError("hall picture: the layout has no outline");
  if (picture.width_px < 200 || picture.width_px > 8000) {
    return absl::InvalidArgumentError(
        absl::StrFormat("hall picture: width %d is not in 200..8000", picture.width_px));
  }
  const std::string temporary = path + ".new";
  const cairo_status_t status = Painter(layout, picture).Draw(temporary);
  if (status != CAIRO_STATUS_SUCCESS || std::rename(temporary.c_str(), path.c_str()) != 0) {
    return absl::UnavailableError("cannot write the picture " + path + ": " + cairo_status_to_string(status));
  }
  return absl::OkStatus();
}

}  // namespace docent::maps
