#include "src/output/plot.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "src/output/whole_file.h"

namespace exitance {
namespace {

constexpr double kWidth = 780, kHeight = 480, kLeft = 80, kRight = 270, kTop = 50, kBottom = 60;
/// Okabe and Ito's colours, which colour-blind people can tell apart.
constexpr std::array<std::string_view, 7> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                      "#e69f00", "#56b4e9", "#000000"};
/// Marks around the origin, so that series can be told apart without colours, too. Seven
/// colours and five marks repeat together after 35 series.
constexpr std::array<std::string_view, 5> kMarks = {
    "<circle r=\"3\"", "<rect x=\"-3\" y=\"-3\" width=\"6\" height=\"6\"", "<path d=\"M0 -4 L3.6 3 L-3.6 3 Z\"",
    "<path d=\"M0 -4.2 L4.2 0 L0 4.2 L-4.2 0 Z\"", "<path d=\"M0 4 L3.6 -3 L-3.6 -3 Z\""};

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else {
      result += c;
    }
  }
  return result;
}

bool has_place(const std::pair<double, double>& point) {
  return std::isfinite(point.first) && std::isfinite(point.second) && point.first > 0 && point.second > 0;
}

/// Decades from `first` to `last` along `length` pixels from `start`.
struct Axis {
  int first = 0, last = 1;
  double start = 0, length = 1;

  double at(double value) const { return start + length * (std::log10(value) - first) / (last - first); }
  /// Decades that get a number: not more than nine of them.
  int step() const { return (last - first + 8) / 9; }
};

Axis axis_over(const Plot& plot, bool is_x, double start, double length) {
  Axis axis{.start = start, .length = length};
  bool any = false;
  for (const PlotSeries& series : plot.series) {
    for (const auto& point : series.points) {
      if (!has_place(point)) continue;
      const double decade = std::log10(is_x ? point.first : point.second);
      const int low = static_cast<int>(std::floor(decade)), high = static_cast<int>(std::ceil(decade));
      axis.first = any ? std::min(axis.first, low) : low;
      axis.last = any ? std::max(axis.last, high) : high;
      any = true;
    }
  }
  if (axis.last == axis.first) ++axis.last;
  return axis;
}

void write_axes(std::ostream& out, const Plot& plot, const Axis& x, const Axis& y) {
  const double right = kWidth - kRight, bottom = kHeight - kBottom;
  for (int decade = x.first; decade <= x.last; ++decade) {
    const double at = x.at(std::pow(10, decade));
    fmt::print(out, "<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"#ddd\"/>\n", at, kTop, bottom);
    if ((decade - x.first) % x.step() == 0)
      fmt::print(out, "<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">1e{}</text>\n", at, bottom + 18, decade);
  }
  for (int decade = y.first; decade <= y.last; ++decade) {
    const double at = y.at(std::pow(10, decade));
    fmt::print(out, "<line x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\" stroke=\"#ddd\"/>\n", at, kLeft, right);
    if ((decade - y.first) % y.step() == 0)
      fmt::print(out, "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">1e{}</text>\n", kLeft - 6, at + 4, decade);
  }
  fmt::print(out, "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#000\"/>\n", kLeft, kTop,
             right - kLeft, bottom - kTop);
  fmt::print(out, "<text x=\"{}\" y=\"28\" text-anchor=\"middle\" font-size=\"15\">{}</text>\n", (kLeft + right) / 2,
             escaped(plot.title));
  fmt::print(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", (kLeft + right) / 2, kHeight - 18,
             escaped(plot.x_label));
  fmt::print(out, "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
             (kTop + bottom) / 2, escaped(plot.y_label));
  fmt::print(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" font-size=\"9\" fill=\"#555\">{}</text>\n", kWidth - 8,
             kHeight - 4, escaped(plot.note));
}

/// How a series is drawn.
struct Pen {
  explicit Pen(std::size_t series)
      : colour(kColours[series % kColours.size()]), shape(kMarks[series % kMarks.size()]) {}

  void mark(std::ostream& out, double x, double y) const {
    fmt::print(out, "{} transform=\"translate({:.2f} {:.2f})\" fill=\"{}\"/>\n", shape, x, y, colour);
  }

  std::string_view colour, shape;
};

void write_series(std::ostream& out, const PlotSeries& series, const Pen& pen, const Axis& x, const Axis& y) {
  std::string path;
  bool joined = false;
  for (const auto& point : series.points) {
    if (!has_place(point)) {
      joined = false;
      continue;
    }
    const double px = x.at(point.first), py = y.at(point.second);
    path += fmt::format("{}{:.2f} {:.2f} ", joined ? "L" : "M", px, py);
    joined = true;
    if (!series.dashed) pen.mark(out, px, py);
  }
  fmt::print(out, "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{}/>\n", path, pen.colour,
             series.dashed ? " stroke-dasharray=\"5 4\"" : "");
}

}  // namespace

void write_plot(const std::filesystem::path& path, const Plot& plot) {
  const Axis x = axis_over(plot, true, kLeft, kWidth - kLeft - kRight);
  const Axis y = axis_over(plot, false, kHeight - kBottom, kTop + kBottom - kHeight);
  write_whole_file(path, [&](std::ostream& out) {
    fmt::print(out,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
               "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
               kWidth, kHeight);
    write_axes(out, plot, x, y);
    for (std::size_t s = 0; s < plot.series.size(); ++s) {
      const Pen pen(s);
      write_series(out, plot.series[s], pen, x, y);
      const double at = kTop + 12 + 20 * static_cast<double>(s), left = kWidth - kRight + 14;
      fmt::print(out, "<line x1=\"{0}\" y1=\"{2}\" x2=\"{1}\" y2=\"{2}\" stroke=\"{3}\" stroke-width=\"2\"{4}/>\n",
                 left, left + 22, at, pen.colour, plot.series[s].dashed ? " stroke-dasharray=\"5 4\"" : "");
      if (!plot.series[s].dashed) pen.mark(out, left + 11, at);
      fmt::print(out, "<text x=\"{}\" y=\"{}\">{}</text>\n", left + 28, at + 4, escaped(plot.series[s].name));
    }
    out << "</svg>\n";
  });
}

}  // namespace exitance
