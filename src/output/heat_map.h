#pragma once
// Tables as pictures: a coloured field for every number (.svg).

#include <filesystem>
#include <string>
#include <vector>

namespace exitance {

struct HeatMap {
  struct Cell {
    double value = 0;  ///< coloured by its logarithm; what is not positive and finite is white
    std::string mark;  ///< printed on the field
  };
  struct Panel {
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;  ///< as many as there are row names, each as long as the columns
  };

  std::string title;
  std::vector<std::string> row_names;
  std::vector<Panel> panels;           ///< side by side
  double lowest = 1e-18, highest = 1;  ///< ends of the scale of colours; 0 < lowest < highest
  std::string scale_label;
  std::string note;  ///< in small print below all: what it was made with
};

/// Throws InputError when the file cannot be written.
void write_heat_map(const std::filesystem::path& path, const HeatMap& map);

}  // namespace exitance
