#include "src/output/vtk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

using testing::ElementsAre;

// An independent reader of well-formed XML without comments or mixed quotes: elements, attributes, text before
// children.
struct XmlElement {
  std::string name, text;
  std::map<std::string, std::string> attributes;
  std::vector<XmlElement> children;

  const XmlElement& child(const std::string& tag, const std::string& with_name = "") const {
    for (const XmlElement& c : children) {
      if (c.name == tag && (with_name.empty() || c.attributes.at("Name") == with_name)) return c;
    }
    throw std::runtime_error("no <" + tag + " Name=" + with_name + "> in <" + name + ">");
  }

  std::vector<double> numbers() const {
    std::istringstream in(text);
    std::vector<double> result;
    for (std::string word; in >> word;) result.push_back(std::stod(word));
    return result;
  }
};

class XmlReader {
 public:
  explicit XmlReader(std::string text) : text_(std::move(text)) {}

  XmlElement read() {
    take("<?xml version=\"1.0\"?>");
    XmlElement root = element();
    skip_space();
    if (at_ != text_.size()) throw std::runtime_error("something follows the root element");
    return root;
  }

 private:
  XmlElement element() {
    take("<");
    XmlElement e;
    e.name = until(" >");
    for (skip_space(); text_.at(at_) != '>'; skip_space()) {
      const std::string key = until("=");
      take("=\"");
      if (!e.attributes.emplace(key, unescaped(until("\""))).second) throw std::runtime_error("attribute twice");
      take("\"");
    }
    take(">");
    e.text = unescaped(until("<"));
    while (text_.compare(at_, 2, "</") != 0) {
      e.children.push_back(element());
      skip_space();
    }
    take("</" + e.name + ">");
    return e;
  }

  static std::string unescaped(std::string text) {
    const std::pair<const char*, const char*> entities[] = {
        {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}};
    for (const auto& [entity, character] : entities) {
      for (std::size_t k; (k = text.find(entity)) != std::string::npos;)
        text.replace(k, std::strlen(entity), character);
    }
    return text;
  }

  void skip_space() { at_ = std::min(text_.find_first_not_of(" \n", at_), text_.size()); }
  std::string until(const char* any_of) {
    const std::size_t end = text_.find_first_of(any_of, at_);
    if (end == std::string::npos) throw std::runtime_error("unexpected end");
    const std::size_t begin = std::exchange(at_, end);
    return text_.substr(begin, end - begin);
  }
  void take(const std::string& expected) {
    skip_space();
    if (text_.compare(at_, expected.size(), expected) != 0) throw std::runtime_error("expected " + expected);
    at_ += expected.size();
  }

  std::string text_;
  std::size_t at_ = 0;
};

Faces two_faces() {
  Faces faces(0);
  faces.add(4, 2, 1, std::vector<Vec3>{{0, 0, 0}, {1.0 / 3, 0, 0}, {1, 1, 1e-300}, {0, 1, 0}});
  faces.add(4, 3, 0, std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {-1, 0, 1e6}});
  return faces;
}

TEST(Vtp, ComesBackAsWritten) {
  const ScratchFolder folder;
  const std::vector<double> B{0.1, 0.2, 0.3, 1.0 / 3, 2.0 / 3, 5e-324}, residual{1e-17, -0.0};
  const std::vector<VtkArray> arrays{{"B", "W/m^2", {"R", "G", "B"}, B},
                                     {"residual <&\">", "lm & \"m\"", {}, residual}};
  write_vtp(folder / "s.vtp", two_faces(), arrays);
  const XmlElement root = XmlReader(contents(folder / "s.vtp")).read();

  EXPECT_EQ(root.name, "VTKFile");
  EXPECT_EQ(root.attributes.at("type"), "PolyData");
  const XmlElement& piece = root.child("PolyData").child("Piece");
  EXPECT_EQ(piece.attributes.at("NumberOfPoints"), "5");
  EXPECT_EQ(piece.attributes.at("NumberOfPolys"), "2");
  EXPECT_THAT(piece.child("Points").child("DataArray").numbers(),
              ElementsAre(0, 0, 0, 1.0 / 3, 0, 0, 1, 1, 1e-300, 0, 1, 0, -1, 0, 1e6));
  EXPECT_THAT(piece.child("Polys").child("DataArray", "connectivity").numbers(), ElementsAre(0, 1, 2, 3, 0, 3, 4));
  EXPECT_THAT(piece.child("Polys").child("DataArray", "offsets").numbers(), ElementsAre(4, 7));

  const XmlElement& data = piece.child("CellData");
  const XmlElement& values = data.child("DataArray", "B");
  EXPECT_EQ(values.attributes.at("type"), "Float64");
  EXPECT_EQ(values.attributes.at("NumberOfComponents"), "3");
  EXPECT_EQ(values.attributes.at("ComponentName1"), "G");
  EXPECT_THAT(values.text, testing::HasSubstr("0.1 0.2 0.3"));
  EXPECT_THAT(values.text, testing::HasSubstr("5e-324"));
  const XmlElement& unit = values.child("InformationKey");
  EXPECT_EQ(unit.attributes.at("name"), "UNITS_LABEL");
  EXPECT_EQ(unit.text, "\nW/m^2\n");
  // Face 0 is element 1, face 1 is element 0.
  EXPECT_THAT(data.child("DataArray", "residual <&\">").numbers(), ElementsAre(-0.0, 1e-17));
  EXPECT_EQ(data.child("DataArray", "residual <&\">").child("InformationKey").text, "\nlm & \"m\"\n");
  EXPECT_THAT(data.child("DataArray", "element").numbers(), ElementsAre(1, 0));
  EXPECT_THAT(data.child("DataArray", "patch").numbers(), ElementsAre(2, 3));
  EXPECT_THAT(data.child("DataArray", "surface").numbers(), ElementsAre(4, 4));
}

TEST(Vtp, NumbersThatVtkCannotReadAreRefusedAndNothingIsWritten) {
  const ScratchFolder folder;
  const std::vector<double> values{1, std::numeric_limits<double>::quiet_NaN()};
  const std::vector<VtkArray> arrays{{"B", "", {}, values}};
  EXPECT_THROW(write_vtp(folder / "s.vtp", two_faces(), arrays), std::invalid_argument);
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace exitance
