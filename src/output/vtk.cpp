#include "src/output/vtk.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string_view>

#include "src/output/whole_file.h"

namespace exitance {
namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

class PolyDataWriter {
 public:
  PolyDataWriter(std::ostream& out, const Faces& faces) : out_(out), faces_(faces) {}

  void write(std::span<const VtkArray> arrays) {
    out_ << "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\">\n<PolyData>\n"
         << fmt::format(
                "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                "NumberOfPolys=\"{}\">\n<CellData>\n",
                faces_.points().size(), faces_.size());
    for (const VtkArray& array : arrays) write_values(array);
    write_integers("Int64", "element", [&](std::size_t f) { line_ += fmt::format("{}", faces_.element(f)); });
    write_integers("Int64", "patch", [&](std::size_t f) { line_ += fmt::format("{}", faces_.patch(f)); });
    write_integers("Int64", "surface", [&](std::size_t f) { line_ += fmt::format("{}", faces_.surface(f)); });
    out_ << "</CellData>\n<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" "
            "format=\"ascii\">\n";
    for (const Vec3& p : faces_.points()) out_ << fmt::format("{} {} {}\n", p.x, p.y, p.z);
    out_ << "</DataArray>\n</Points>\n<Polys>\n";
    write_integers("Int64", "connectivity",
                   [&](std::size_t f) { line_ += fmt::format("{}", fmt::join(faces_.corners(f), " ")); });
    std::size_t end = 0;
    write_integers("Int64", "offsets", [&](std::size_t f) {
      end += faces_.corners(f).size();
      line_ += fmt::format("{}", end);
    });
    out_ << "</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  }

 private:
  void write_values(const VtkArray& array) {
    const std::size_t components = std::max<std::size_t>(1, array.components.size());
    out_ << fmt::format("<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\"", escaped(array.name),
                        components);
    for (std::size_t c = 0; c < array.components.size(); ++c) {
      out_ << fmt::format(" ComponentName{}=\"{}\"", c, escaped(array.components[c]));
    }
    out_ << " format=\"ascii\">\n";
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto values = array.values.subspan(faces_.element(f) * components, components);
      for (const double value : values) {
        if (!std::isfinite(value))
          throw std::invalid_argument("write_vtp: " + array.name + " is not finite everywhere");
      }
      out_ << fmt::format("{}\n", fmt::join(values, " "));
    }
    if (!array.unit.empty()) {
      out_ << fmt::format("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">\n{}\n</InformationKey>\n",
                          escaped(array.unit));
    }
    out_ << "</DataArray>\n";
  }

  // One line a face.
  void write_integers(std::string_view type, std::string_view name, const std::function<void(std::size_t)>& add_face) {
    out_ << fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">\n", type, name);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      line_.clear();
      add_face(f);
      out_ << line_ << '\n';
    }
    out_ << "</DataArray>\n";
  }

  std::ostream& out_;
  const Faces& faces_;
  std::string line_;
};

}  // namespace

void write_vtp(const std::filesystem::path& path, const Faces& faces, std::span<const VtkArray> arrays) {
  write_whole_file(path, [&](std::ostream& out) { PolyDataWriter(out, faces).write(arrays); });
}

}  // namespace exitance
