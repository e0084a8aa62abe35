#pragma once
// Line plots with logarithmic axes (.svg).

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace exitance {

struct PlotSeries {
  std::string name;                               ///< in the legend
  std::vector<std::pair<double, double>> points;  ///< x, y in the order in which they are joined
  bool dashed = false;                            ///< for lines that are there for comparison, without marks
};

struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series = {};
  std::string note = {};  ///< in small print below all: what it was made with
};

/// Both axes are logarithmic and span whole decades. Points that are not positive and finite have no place and are left
/// out, together with the line to them; a plot without any point has axes from 1 to 10. Throws InputError when the file
/// cannot be written.
void write_plot(const std::filesystem::path& path, const Plot& plot);

}  // namespace exitance
