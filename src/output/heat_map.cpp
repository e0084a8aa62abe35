#include "src/output/heat_map.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "src/output/whole_file.h"

namespace exitance {
namespace {

constexpr double kCellWidth = 38, kCellHeight = 16, kNames = 130, kTop = 96, kBetween = 18, kBottom = 64;

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  return result;
}

/// Share of the way from the lowest to the highest value; below 0 without a colour.
double place_of(double value, const HeatMap& map) {
  if (!(value > 0) || !std::isfinite(value)) return -1;
  return std::clamp(std::log(value / map.lowest) / std::log(map.highest / map.lowest), 0.0, 1.0);
}

/// From blue over pale yellow to red, as colour-blind people tell apart, too (ColorBrewer's RdYlBu).
std::string colour_at(double place) {
  static constexpr std::array<std::array<double, 3>, 5> kColours{
      {{69, 117, 180}, {171, 217, 233}, {255, 255, 191}, {253, 174, 97}, {215, 48, 39}}};
  if (place < 0) return "#fff";
  const double at = place * (kColours.size() - 1);
  const auto k = std::min<std::size_t>(static_cast<std::size_t>(at), kColours.size() - 2);
  const double t = at - static_cast<double>(k);
  const auto mixed = [&](std::size_t c) {
    return static_cast<int>(std::lround(kColours[k][c] + t * (kColours[k + 1][c] - kColours[k][c])));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mixed(0), mixed(1), mixed(2));
}

void write_panel(std::ostream& out, const HeatMap& map, const HeatMap::Panel& panel, double left) {
  fmt::print(out, "<text x=\"{:.0f}\" y=\"52\" font-size=\"13\">{}</text>\n", left, escaped(panel.title));
  for (std::size_t c = 0; c < panel.columns.size(); ++c) {
    fmt::print(out, "<text x=\"{:.0f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
               left + (static_cast<double>(c) + 0.5) * kCellWidth, kTop - 8, escaped(panel.columns[c]));
  }
  for (std::size_t r = 0; r < panel.rows.size(); ++r) {
    const double top = kTop + static_cast<double>(r) * kCellHeight;
    for (std::size_t c = 0; c < panel.rows[r].size(); ++c) {
      const HeatMap::Cell& cell = panel.rows[r][c];
      const double x = left + static_cast<double>(c) * kCellWidth;
      fmt::print(out, "<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#fff\"/>\n", x,
                 top, kCellWidth, kCellHeight, colour_at(place_of(cell.value, map)));
      if (!cell.mark.empty())
        fmt::print(out, "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" font-size=\"9\">{}</text>\n",
                   x + kCellWidth / 2, top + 12, escaped(cell.mark));
    }
  }
}

void write_scale(std::ostream& out, const HeatMap& map, double top) {
  constexpr int kSteps = 60;
  constexpr double kLength = 240;
  for (int k = 0; k < kSteps; ++k) {
    fmt::print(out, "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"10\" fill=\"{}\"/>\n",
               kNames + k * kLength / kSteps, top, kLength / kSteps + 0.2, colour_at((k + 0.5) / kSteps));
  }
  fmt::print(out, "<text x=\"{}\" y=\"{:.0f}\">{:g}</text>\n", kNames, top + 24, map.lowest);
  fmt::print(out, "<text x=\"{}\" y=\"{:.0f}\" text-anchor=\"end\">{:g}</text>\n", kNames + kLength, top + 24,
             map.highest);
  fmt::print(out, "<text x=\"{}\" y=\"{:.0f}\">{}</text>\n", kNames + kLength + 12, top + 9, escaped(map.scale_label));
}

}  // namespace

void write_heat_map(const std::filesystem::path& path, const HeatMap& map) {
  double width = kNames;
  for (const HeatMap::Panel& panel : map.panels)
    width += static_cast<double>(panel.columns.size()) * kCellWidth + kBetween;
  const double bottom = kTop + static_cast<double>(map.row_names.size()) * kCellHeight, height = bottom + kBottom;
  write_whole_file(path, [&](std::ostream& out) {
    fmt::print(out,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
               "{1:.0f}\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" "
               "fill=\"#fff\"/>\n",
               width, height);
    fmt::print(out, "<text x=\"{}\" y=\"26\" font-size=\"15\">{}</text>\n", kNames, escaped(map.title));
    for (std::size_t r = 0; r < map.row_names.size(); ++r) {
      fmt::print(out, "<text x=\"{}\" y=\"{:.0f}\" text-anchor=\"end\">{}</text>\n", kNames - 6,
                 kTop + static_cast<double>(r) * kCellHeight + 12, escaped(map.row_names[r]));
    }
    double left = kNames;
    for (const HeatMap::Panel& panel : map.panels) {
      write_panel(out, map, panel, left);
      left += static_cast<double>(panel.columns.size()) * kCellWidth + kBetween;
    }
    write_scale(out, map, bottom + 14);
    fmt::print(out, "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"end\" font-size=\"9\" fill=\"#555\">{}</text>\n",
               width - 8, height - 4, escaped(map.note));
    out << "</svg>\n";
  });
}

}  // namespace exitance
