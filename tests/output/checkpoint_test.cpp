#include "src/output/checkpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tests/output/damage.h"
#include "tests/output/error_of.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kKey = "mesh 1234\ntolerance 1e-9\nversion 0.1";
constexpr auto kForgotten = Checkpoint::OtherRun::forgotten;

void add(Checkpoint& checkpoint, double value) {
  checkpoint.add([&](ArchiveWriter& file) { file.write("value", std::span(&value, 1)); });
}

std::vector<double> values_in(const Checkpoint& checkpoint) {
  std::vector<double> values;
  for (const auto& part : checkpoint.parts()) values.push_back(checkpoint.open(part).doubles("value").at(0));
  return values;
}

TEST(Checkpoint, IsRemovedWithEverythingOfItsOwn) {
  const ScratchFolder folder;
  Checkpoint first(folder / "a.parts", kKey);
  add(first, 1);
  first.remove();
  EXPECT_EQ(folder.files(), 0u);
  Checkpoint second(folder / "b.parts", kKey);
  add(second, 1);
  put(folder / "b.parts" / "notes.txt", "mine");
  second.remove();
  EXPECT_EQ(contents(folder / "b.parts" / "notes.txt"), "mine");
}

TEST(Checkpoint, OfAnotherRunIsNamedWithWhatDiffers) {
  const ScratchFolder folder;
  {
    Checkpoint checkpoint(folder / "a.parts", kKey);
    add(checkpoint, 1);
  }
  const Checkpoint other(folder / "a.parts", "mesh 1234\ntolerance 1e-6\nversion 0.1");
  EXPECT_FALSE(other.has_forgotten());
  EXPECT_THAT(error_of([&] { values_in(other); }),
              AllOf(HasSubstr("part-000001.h5"), HasSubstr("\"tolerance 1e-9\" there, \"tolerance 1e-6\" here")));
}

TEST(Checkpoint, OfAShorterKeyIsNamedToo) {
  const ScratchFolder folder;
  {
    Checkpoint checkpoint(folder / "a.parts", kKey);
    add(checkpoint, 1);
  }
  const Checkpoint other(folder / "a.parts", std::string(kKey) + "\nseed 2");
  EXPECT_THAT(error_of([&] { values_in(other); }), HasSubstr("\"\" there, \"seed 2\" here"));
}

TEST(Checkpoint, BelongsToOneRunAtATime) {
  const ScratchFolder folder;
  const Checkpoint first(folder / "a.parts", kKey);
  EXPECT_THAT(error_of([&] { Checkpoint(folder / "a.parts", kKey); }), HasSubstr("another run"));
  put(folder / "file", "");
  EXPECT_THAT(error_of([&] { Checkpoint(folder / "file", kKey); }), HasSubstr("cannot be kept there"));
  EXPECT_THAT(error_of([&] { Checkpoint(folder / "file" / "a.parts", kKey); }), HasSubstr("cannot be kept there"));
}

TEST(Checkpoint, OfAnotherRunIsForgottenWhereThatIsAskedFor) {
  const ScratchFolder folder;
  const auto path = folder / "a.parts";
  {
    Checkpoint checkpoint(path, kKey);
    add(checkpoint, 1);
    add(checkpoint, 2);
  }
  {
    const Checkpoint own(path, kKey, kForgotten);
    EXPECT_THAT(values_in(own), ElementsAre(1, 2));
    EXPECT_FALSE(own.has_forgotten());
  }
  {
    Checkpoint other(path, "mesh 5678", kForgotten);
    EXPECT_TRUE(other.parts().empty());
    EXPECT_TRUE(other.has_forgotten());
    add(other, 3);
  }
  put(path / "part-000004.h5", "damaged");
  EXPECT_TRUE(Checkpoint(path, "mesh 5678", kForgotten).parts().empty());
  EXPECT_EQ(folder.files(), 0u) << "nothing was kept in it since";
}

TEST(Checkpoint, ForgetsOnePartAndGivesItsNameToNoOther) {
  const ScratchFolder folder;
  Checkpoint checkpoint(folder / "a.parts", kKey, kForgotten);
  for (const double value : {1, 2, 3}) add(checkpoint, value);
  checkpoint.forget(checkpoint.parts()[1]);
  EXPECT_THAT(values_in(checkpoint), ElementsAre(1, 3));
  checkpoint.forget(checkpoint.parts()[1]);
  add(checkpoint, 4);
  EXPECT_THAT(values_in(checkpoint), ElementsAre(1, 4));
  EXPECT_EQ(checkpoint.parts()[1].filename(), "part-000004.h5");
  EXPECT_FALSE(exists(folder / "a.parts" / "part-000003.h5"));
}

TEST(Checkpoint, OfAStateHoldsTheLastOne) {
  const ScratchFolder folder;
  const auto path = folder / "a.parts";
  {
    Checkpoint checkpoint(path, kKey);
    for (const double state : {1.0, 2.0, 3.0})
      checkpoint.replace([&](ArchiveWriter& file) { file.write("value", std::span(&state, 1)); });
  }
  EXPECT_THAT(values_in(Checkpoint(path, kKey)), ElementsAre(3));
}

}  // namespace
}  // namespace exitance
