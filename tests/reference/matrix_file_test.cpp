#include "src/reference/matrix_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "src/output/archive.h"
#include "src/scene/scene.h"
#include "tests/output/damage.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// About a third of the entries there, of all magnitudes; the first, a middle and the last row empty.
MatrixRecord random_record(std::uint32_t rows) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-300, 0), unit(0.5, 1);
  MatrixRecord record{.mesh_hash = "hash", .manifest = "{\n \"threads\": 2\n}"};
  record.matrix.columns = rows;
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j < rows && i != 0 && i != rows / 2 && i + 1 != rows; ++j) {
      if (random() % 3 != 0) continue;
      record.matrix.column.push_back(j);
      record.matrix.F.push_back(unit(random) * std::pow(10, exponent(random)));
      record.matrix.F_error.push_back(1e-13 * unit(random));
    }
    record.matrix.row_first.push_back(record.matrix.column.size());
    record.area.push_back(unit(random) / 3);
    record.emissivity.push_back(unit(random));
    record.name.push_back(fmt::format("wall {}", i));
  }
  return record;
}

void expect_equal(const FormFactorMatrix& a, const FormFactorMatrix& b) {
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.row_first, b.row_first);
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.F, b.F);
  EXPECT_EQ(a.F_error, b.F_error);
}

class MatrixFile : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::string error_of(const std::string& name, const std::string& content,
                       std::optional<std::uint32_t> rows = {}) const {
    put(path(name), content);
    try {
      read_matrix(path(name), rows);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }

 private:
  ScratchFolder folder_;
};

TEST_F(MatrixFile, ArchiveComesBackWhole) {
  const MatrixRecord record = random_record(40);
  write_matrix(path("a.H5"), record);
  const MatrixRecord read = read_matrix(path("a.H5"));
  expect_equal(read.matrix, record.matrix);
  EXPECT_EQ(read.area, record.area);
  EXPECT_EQ(read.emissivity, record.emissivity);
  EXPECT_EQ(read.name, record.name);
  EXPECT_EQ(read.mesh_hash, record.mesh_hash);
  EXPECT_EQ(read.manifest, record.manifest);
}

TEST_F(MatrixFile, ArchiveHoldsRectanglesAndNothing) {
  MatrixRecord record{.matrix = {.row_first = {0, 1, 1, 2}, .column = {6, 0}, .F = {0.5, 1}, .F_error = {0, kInfinity}},
                      .area = {1, 2, 3}};
  record.matrix.columns = 7;
  write_matrix(path("a.h5"), record);
  expect_equal(read_matrix(path("a.h5")).matrix, record.matrix);
  write_matrix(path("b.h5"), {});
  EXPECT_EQ(read_matrix(path("b.h5")).matrix.rows(), 0u);
}

TEST_F(MatrixFile, ArchiveThatIsNoMatrixIsNamed) {
  const auto error_with = [&](const std::function<void(MatrixRecord&)>& change) {
    MatrixRecord record = random_record(9);
    change(record);
    // By hand, as write_matrix would refuse some of these.
    ArchiveWriter file(path("a.h5"), "exitance form factors 1");
    file.write("columns", std::span<const std::uint32_t>(&record.matrix.columns, 1));
    file.write("row_first", std::span<const std::uint64_t>(record.matrix.row_first));
    file.write("column", std::span<const std::uint32_t>(record.matrix.column));
    file.write("F", std::span<const double>(record.matrix.F));
    file.write("F_error", std::span<const double>(record.matrix.F_error));
    file.write("area", std::span<const double>(record.area));
    file.write("emissivity", std::span<const double>(record.emissivity));
    file.write("name", std::span<const std::string>(record.name));
    file.write("mesh_hash", record.mesh_hash);
    file.write("manifest", record.manifest);
    file.publish();
    try {
      read_matrix(path("a.h5"));
    } catch (const DamagedFile& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(error_with([](MatrixRecord&) {}), "");
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.row_first.back() += 1; }), HasSubstr("row_first"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.row_first.front() = 1; }), HasSubstr("row_first"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.row_first.clear(); }), HasSubstr("row_first"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { std::swap(r.matrix.row_first[2], r.matrix.row_first[3]); }),
              HasSubstr("row_first"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.F.pop_back(); }), HasSubstr("entries"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.F_error.push_back(0); }), HasSubstr("entries"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.columns = 1; }), HasSubstr("column"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.column.front() = 8; }), HasSubstr("column"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.F[1] = std::nan(""); }), HasSubstr("\"F\""));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.matrix.F_error[1] = -1e-30; }), HasSubstr("\"F_error\""));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.area.pop_back(); }), HasSubstr("area"));
  EXPECT_THAT(error_with([](MatrixRecord& r) { r.name.pop_back(); }), HasSubstr("name"));
}

TEST_F(MatrixFile, TripletsComeBackBitForBit) {
  const MatrixRecord record = random_record(40);
  write_matrix(path("a.csv"), record);
  expect_equal(read_matrix(path("a.csv"), 40).matrix, record.matrix);
}

TEST_F(MatrixFile, TripletsAreWhatIsPromised) {
  MatrixRecord record{
      .matrix = {.row_first = {0, 2, 2, 3}, .column = {0, 1, 2}, .F = {0, 0.1, 1e-300}, .F_error = {1e-9, 1e-15, 0}}};
  record.matrix.columns = 3;
  write_matrix(path("a.csv"), record);
  EXPECT_EQ(contents(path("a.csv")), "i,j,F,F_error\n0,1,0.10000000000000001,1.0000000000000001e-15\n2,2,1e-300,0\n");
}

TEST_F(MatrixFile, TripletsOfOthersComeInAnyOrderAndWithoutErrors) {
  put(path("a.csv"), "i,j,F\r\n2, 0, .5\r\n\r\n0,2,+1e-3\r\n0,1,0.25\r\n");
  const MatrixRecord read = read_matrix(path("a.csv"));
  EXPECT_EQ(read.matrix.rows(), 3u);
  EXPECT_THAT(read.matrix.row_first, ElementsAre(0, 2, 2, 3));
  EXPECT_THAT(read.matrix.column, ElementsAre(1, 2, 0));
  EXPECT_THAT(read.matrix.F, ElementsAre(0.25, 1e-3, 0.5));
  EXPECT_THAT(read.matrix.F_error, Each(kInfinity));
  put(path("empty.csv"), "i,j,F,F_error");
  EXPECT_EQ(read_matrix(path("empty.csv")).matrix.rows(), 0u);
  EXPECT_EQ(read_matrix(path("empty.csv"), 5).matrix.rows(), 5u);
}

TEST_F(MatrixFile, BadTripletsAreNamed) {
  const std::string header = "i,j,F,F_error\n0,1,0.5,0\n";
  const auto at = [](int line, const char* what) {
    return AllOf(HasSubstr(fmt::format("a.csv:{}: ", line)), HasSubstr(what));
  };
  EXPECT_THAT(error_of("a.csv", ""), HasSubstr("i,j,F,F_error"));
  EXPECT_THAT(error_of("a.csv", "row,column,F\n"), at(1, "i,j,F,F_error"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,0.5\n"), at(3, "3 values where 4"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,0.5,0,0\n"), at(3, "5 values"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,,0\n"), at(3, "missing"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,half,0\n"), at(3, "\"half\""));
  EXPECT_THAT(error_of("a.csv", header + "1,0,nan,0\n"), at(3, "not a finite"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,1e999,0\n"), at(3, "range"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,0.5,-1\n"), at(3, "at least 0"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,0.5,nan\n"), at(3, "at least 0"));
  EXPECT_THAT(error_of("a.csv", header + "-1,0,0.5,0\n"), at(3, "index -1"));
  EXPECT_THAT(error_of("a.csv", header + "1.5,0,0.5,0\n"), at(3, "\"1.5\""));
  EXPECT_THAT(error_of("a.csv", header + "1,4294967295,0.5,0\n"), at(3, "index 4294967295"));
  EXPECT_THAT(error_of("a.csv", header + "1,4294967294,0.5,0\n"), at(3, "index 4294967294 leaves nearly all rows"));
  EXPECT_THAT(error_of("a.csv", header + "0,2,0.5,0\n", 2), at(3, "index 2 is not within 0 … 1"));
  EXPECT_THAT(error_of("a.csv", header + "1,0,0.5,0\n0,1,0.25,0\n"), at(4, "0,1 is there already, in line 2"));
}

TEST_F(MatrixFile, View3DsLayoutComesBackBitForBit) {
  const MatrixRecord record = random_record(40);
  write_matrix(path("a.txt"), record);
  const MatrixRecord read = read_matrix(path("a.txt"));
  EXPECT_EQ(read.matrix.columns, 40u);
  EXPECT_EQ(read.matrix.row_first, record.matrix.row_first);
  EXPECT_EQ(read.matrix.column, record.matrix.column);
  EXPECT_EQ(read.matrix.F, record.matrix.F);
  EXPECT_THAT(read.matrix.F_error, Each(kInfinity));
  EXPECT_EQ(read.area, record.area);
  EXPECT_EQ(read.emissivity, record.emissivity);
  EXPECT_THAT(read.warnings, IsEmpty());
}

TEST_F(MatrixFile, View3DsLayoutIsWhatItsReadersExpect) {
  MatrixRecord record{.matrix = {.row_first = {0, 1, 2}, .column = {1, 0}, .F = {0.25, 0.125}, .F_error = {0, 0}},
                      .area = {1, 2},
                      .emissivity = {0.5, 0.75}};
  record.matrix.columns = 2;
  write_matrix(path("a.txt"), record);
  const std::string text = contents(path("a.txt"));
  const std::string header = text.substr(0, text.find('\n'));
  EXPECT_EQ(header.size(), 30u);
  EXPECT_THAT(header, testing::MatchesRegex("exitance [0-9.]+ 0 0 0 2 *"));
  EXPECT_EQ(text.substr(header.size()), "\n1 2\n0 0.25\n0.125 0\n0.5 0.75\n");
}

TEST_F(MatrixFile, View3DsOwnOutputIsRead) {
  put(path("a.txt"), "View3D 3.3.1 0 1 0 2          \n1 2.5\n0.000000 0.200044\n0.080018 0.000000\n0.500 0.900\n\n");
  const MatrixRecord read = read_matrix(path("a.txt"));
  EXPECT_THAT(read.matrix.F, ElementsAre(0.200044, 0.080018));
  EXPECT_THAT(read.matrix.column, ElementsAre(1, 0));
  EXPECT_THAT(read.area, ElementsAre(1, 2.5));
  EXPECT_THAT(read.emissivity, ElementsAre(0.5, 0.9));
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("View3D 3.3.1 has scaled the rows")));
}

TEST_F(MatrixFile, BadTextIsNamed) {
  const std::string head = "View3D 3.3 0 0 0 2\n1 2\n";
  const auto at = [](int line, const char* what) {
    return AllOf(HasSubstr(fmt::format("a.txt:{}: ", line)), HasSubstr(what));
  };
  EXPECT_THAT(error_of("a.txt", ""), HasSubstr("empty"));
  EXPECT_THAT(error_of("a.txt", "1 2\n0 1\n"), at(1, "first line of a matrix"));
  EXPECT_THAT(error_of("a.txt", "View3D 3.3 0 0 0\n"), at(1, "first line of a matrix"));
  EXPECT_THAT(error_of("a.txt", "View3D 3.3 0 0 0 0\n"), at(1, "0 rows"));
  EXPECT_THAT(error_of("a.txt", "View3D 3.3 0 0 0 99999999999\n"), at(1, "99999999999 rows"));
  EXPECT_THAT(error_of("a.txt", "View3D 3.3 0 0 1 2\n1 2\n"), at(1, "script F"));
  EXPECT_THAT(error_of("a.txt", "View3D 3.3 1 0 0 2\r\n\x01\x02\x03\n"), at(2, "not a number"));
  EXPECT_THAT(error_of("a.txt", "View3D 3.3 0 0 0 2\n1 0\n"), at(2, "not positive"));
  EXPECT_THAT(error_of("a.txt", head + "0 0.5\n"), at(3, "truncated"));
  EXPECT_THAT(error_of("a.txt", head + "0 0.5\n0.25 0\n"), at(4, "truncated"));
  EXPECT_THAT(error_of("a.txt", head + "0 0.5 1\n0.25 0\n.5 .5\n"), at(3, "3 values"));
  EXPECT_THAT(error_of("a.txt", head + "0 0.5\n0.25\n.5 .5\n"), at(4, "1 values"));
  EXPECT_THAT(error_of("a.txt", head + "0 -nan\n0.25 0\n.5 .5\n"), at(3, "\"-nan\""));
  EXPECT_THAT(error_of("a.txt", head + "0 o.5\n0.25 0\n.5 .5\n"), at(3, "\"o.5\""));
  EXPECT_THAT(error_of("a.txt", head + "0 0.5\n0.25 0\n.5 .5\n1 1\n"), at(6, "goes on"));
}

TEST_F(MatrixFile, WhatAFormatCannotHoldIsRefused) {
  EXPECT_THROW(write_matrix(path("a.dat"), {}), InputError);
  EXPECT_THROW(matrix_format("out/matrix"), InputError);
  EXPECT_EQ(matrix_format("out/matrix.CSV"), MatrixFormat::triplets);
  MatrixRecord record = random_record(5);
  record.emissivity.clear();
  EXPECT_THROW(write_matrix(path("a.txt"), record), std::invalid_argument);
  record.area.pop_back();
  EXPECT_THROW(write_matrix(path("a.h5"), record), std::invalid_argument);
  record = random_record(5);
  record.matrix.columns = 6;
  EXPECT_THROW(write_matrix(path("a.csv"), record), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path("a.csv")));
}

TEST_F(MatrixFile, GroupsAreNamedAfterTheirFirstAndWeighedByArea) {
  MatrixRecord record{.matrix = {.row_first = {0, 1, 2, 2}, .column = {2, 2}, .F = {0.5, 0.25}, .F_error = {0, 0}},
                      .area = {1, 3, 2},
                      .emissivity = {0.5, 0.9, 1},
                      .name = {"a", "b", "c"}};
  record.matrix.columns = 3;
  const MatrixRecord groups = combine(record, make_groups(std::vector<std::uint32_t>{4, 4, kNoGroup}));
  EXPECT_THAT(groups.area, ElementsAre(4, 2));
  EXPECT_THAT(groups.name, ElementsAre("a", "c"));
  EXPECT_NEAR(groups.emissivity.at(0), 0.8, 1e-15);
  EXPECT_EQ(groups.emissivity.at(1), 1);
  EXPECT_THAT(groups.matrix.F, ElementsAre((0.5 + 3 * 0.25) / 4));
}

}  // namespace
}  // namespace exitance
