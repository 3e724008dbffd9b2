// An imported floor as a hall layout in Turtle, as maps/hall_layout.h reads it. Pure; any thread.
#ifndef DOCENT_MAPS_IMPORT_HALL_WRITER_H_
#define DOCENT_MAPS_IMPORT_HALL_WRITER_H_

#include <string>
#include <vector>

#include "maps/import/imported_floor.h"

namespace docent::maps {

struct HallText {
  std::string turtle;
  std::vector<size_t>
      unreachable;  // places that lie in a wall or outside of the hall: they have no service point
};

// `name_space`: IRIs of places are it and their names; those of walls and connections have "wall/" and the like between.
// `head`: a comment for the first line.
HallText WriteHall(const ImportedFloor& floor, const std::string& name_space, double height_m,
                   const std::string& head);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_HALL_WRITER_H_
