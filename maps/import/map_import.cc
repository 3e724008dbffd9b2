#include "maps/import/map_import.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "maps/hall_layout.h"
#include "maps/import/building_map.h"
#include "maps/import/floor_shape.h"
#include "maps/import/hall_writer.h"
#include "maps/import/occupancy_map.h"
#include "maps/import/topological_map.h"
#include "maps/import/yaml_document.h"

namespace docent::maps {
namespace {

// Bytes of a pixel in the longest form of an image, with a header of any kind.
constexpr uint64_t kBytesAPixel = 6;
constexpr uint64_t kHeaderBytes = 1 << 16;

absl::StatusOr<std::string> ReadWhole(const std::string& path, uint64_t most) {
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    return absl::InvalidArgumentError(absl::StrCat(path, " is not a file"));
  const uint64_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return absl::NotFoundError(absl::StrCat("cannot read ", path));
  if (size > most)
    return absl::InvalidArgumentError(absl::StrCat(path, " has ", size, " bytes, more than ", most));
  std::ostringstream content;
  content << file.rdbuf();
  return std::move(content).str();
}

enum class Kind { kMap, kTopology, kBuilding };

struct Source {
  std::string file;
  std::string text;
  YamlValue document;
};

class Importer {
 public:
  explicit Importer(const MapImportOptions& options) : options_(options) {}

  absl::StatusOr<ImportedHall> Import(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      if (absl::Status read = Add(file); !read.ok()) return read;
    }
    const bool building = sources_.contains(Kind::kBuilding), map = sources_.contains(Kind::kMap);
    if (building == map || (building && sources_.contains(Kind::kTopology))) {
      return absl::InvalidArgumentError(
          "an import needs the description of a map (with image and resolution) and, if there is one, a "
          "topological map; or a building alone");
    }
    if (absl::Status read = building ? ReadBuildingOf() : ReadMapOf(); !read.ok()) return read;
    return Write(files);
  }

 private:
  absl::Status Add(const std::string& file) {
    absl::StatusOr<std::string> text = ReadWhole(file, kMapLimits.map_yaml_bytes);
    if (!text.ok()) return text.status();
    Diagnostics diagnostics;
    std::optional<YamlValue> document = ParseYaml(*text, file, &diagnostics);
    if (!document) return ToStatus(diagnostics, *text);
    Kind kind = Kind::kMap;
    if (document->Find("levels") != nullptr) {
      kind = Kind::kBuilding;
    } else if (document->IsList() || document->Find("nodes") != nullptr) {
      kind = Kind::kTopology;
    } else if (document->Find("image") == nullptr && document->Find("resolution") == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat(
          file,
          " is neither the description of a map (image, resolution, origin), nor a topological map (a list "
          "of nodes), nor a building (levels)"));
    }
    const auto [first, is_new] = sources_.emplace(kind, Source{file, *std::move(text), *std::move(document)});
    if (is_new) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrCat(first->second.file, " and ", file, " are of the same kind; one of them is enough"));
  }

  absl::Status ReadMapOf() {
    const Source& source = sources_.at(Kind::kMap);
    Diagnostics diagnostics;
    const auto description = ReadMapDescription(source.document, source.file, &diagnostics);
    if (!description) return ToStatus(diagnostics, source.text);
    const auto at_image = [&](const absl::Status& status) {
      diagnostics.push_back({source.file, description->image_place, std::string(status.message()), ""});
      return ToStatus(diagnostics, source.text);
    };
    const std::filesystem::path path = std::filesystem::path(source.file).parent_path() / description->image;
    const absl::StatusOr<std::string> bytes =
        ReadWhole(path.string(), kMapLimits.map_image_pixels * kBytesAPixel + kHeaderBytes);
    if (!bytes.ok()) return at_image(bytes.status());
    const absl::StatusOr<GreyImage> image = ReadPgm(*bytes);
    if (!image.ok())
      return at_image(
          absl::InvalidArgumentError(absl::StrCat(path.string(), ": ", image.status().message())));
    absl::StatusOr<ImportedFloor> shape = ShapeOf(GridOf(*description, *image));
    if (!shape.ok()) return at_image(shape.status());
    floor_ = *std::move(shape);
    const auto topology = sources_.find(Kind::kTopology);
    if (topology == sources_.end()) return absl::OkStatus();
    places_ = &topology->second;
    return Finish(ReadTopologicalMap(places_->document, places_->file, &floor_, &found_));
  }

  absl::Status ReadBuildingOf() {
    places_ = &sources_.at(Kind::kBuilding);
    return Finish(ReadBuilding(places_->document, places_->file, options_.level, &floor_, &found_));
  }

  absl::Status Finish(bool good) const { return good ? absl::OkStatus() : ToStatus(found_, places_->text); }

  absl::StatusOr<ImportedHall> Write(const std::vector<std::string>& files) {
    std::string of_file = std::filesystem::path(files[0]).stem().string();
    if (!options_.name.empty()) floor_.name = options_.name;
    if (floor_.name.empty()) floor_.name = of_file.empty() ? "hall" : of_file;
    std::string head = "Imported from";
    for (const std::string& file : files)
      absl::StrAppend(&head, " ", std::filesystem::path(file).filename().string());
    const size_t tests = floor_.places.size() * floor_.obstacles.size();
    if (tests > kMapLimits.map_wall_tests) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "there are ", floor_.places.size(), " places and ", floor_.obstacles.size(),
          " walls; their product is beyond the limit map_wall_tests = ", kMapLimits.map_wall_tests,
          ": import a smaller part of the building"));
    }
    HallText written = WriteHall(floor_, options_.name_space, options_.height_m, head + ".");
    for (const size_t place : written.unreachable) {
      found_.push_back({places_->file, floor_.places[place].span,
                        Concat("place ", floor_.places[place].name,
                               " lies in a wall or outside of the hall; it has no service point"),
                        "", Diagnostic::Severity::kWarning});
    }
    // What the robots will read.
    const ParsedRdf parsed =
        ParseRdf(written.turtle, RdfFormat::kTurtle, {"hall.ttl", "urn:docent:import", ""});
    if (!parsed.ok()) return ToStatus(parsed.diagnostics, written.turtle);
    if (const auto layout = HallLayout::FromQuads(parsed.quads); !layout.ok()) return layout.status();
    ImportedHall out;
    const Bounds bounds = BoundsOf(floor_.outline);
    out.width_m = bounds.max_x_m - bounds.min_x_m;
    out.depth_m = bounds.max_y_m - bounds.min_y_m;
    out.turtle = std::move(written.turtle);
    if (!found_.empty()) out.warnings = Render(found_, places_->text);
    out.corners = floor_.outline.size();
    out.walls = floor_.obstacles.size();
    out.places = floor_.places.size();
    out.connections = floor_.connections.size();
    return out;
  }

  const MapImportOptions& options_;
  std::map<Kind, Source> sources_;
  ImportedFloor floor_;
  const Source* places_ = nullptr;  // where places come from
  Diagnostics found_;               // in it
};

}  // namespace

absl::StatusOr<ImportedHall> ImportMaps(const std::vector<std::string>& files,
                                        const MapImportOptions& options) {
  return Importer(options).Import(files);
}

}  // namespace docent::maps
