#include "src/scene/edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "src/scene/input_error.h"
#include "src/scene/patch_mesh.h"
#include "src/scene/scene_file.h"
#include "tests/dynamic/rooms.h"
#include "tests/scene/scene_files.h"

namespace exitance {
namespace {

using testing::HasSubstr;

TEST(EditedScene, ObjectsComeAndGoInTheirPlace) {
  EditedScene edited(test_room());
  EXPECT_FALSE(edited.is_present(3));
  EXPECT_EQ(edited.scene().surfaces.size(), 6u + 6 + 12 + 2);
  EXPECT_TRUE(edited.apply({Operation::add, 3, {}, {}, {}}).geometry);
  EXPECT_TRUE(std::ranges::is_sorted(edited.scene().surfaces, {}, &Surface::object));
  EXPECT_EQ(edited.surfaces_of(3).last - edited.surfaces_of(3).first, 6u);
  edited.apply({Operation::remove, 2, {}, {}, {}});
  EXPECT_EQ(edited.surfaces_of(2).last, edited.surfaces_of(2).first);
  edited.apply({Operation::add, 2, {}, {}, {}});
  EXPECT_EQ(edited.scene().surfaces[12].polygon.outer, test_room().surfaces[12].polygon.outer) << "where it was";
}

TEST(EditedScene, MovesDoNotAddUp) {
  EditedScene edited(test_room());
  const auto before = edited.scene().surfaces[8].polygon.outer;
  for (int k = 1; k <= 20; ++k) {
    Edit move{Operation::move, 1, Placement{rotation({1, 2, 3}, 17.0 * k), {0.1, 0, 0.01}}, {}, {}};
    edited.apply(move);
  }
  EXPECT_NE(edited.scene().surfaces[8].polygon.outer, before);
  edited.apply({Operation::move, 1, Placement{}, {}, {}});
  EXPECT_EQ(edited.scene().surfaces[8].polygon.outer, before) << "bit for bit";
}

TEST(EditedScene, MaterialsStayWithTheObjectWhereverItGoes) {
  EditedScene edited(test_room());
  const EditedScene::Effect effect = edited.apply({Operation::change, 2, {}, {}, {{2, 3}}});
  EXPECT_TRUE(effect.materials);
  EXPECT_FALSE(effect.geometry);
  edited.apply({Operation::move, 2, Placement{{}, {0.1, 0, 0}}, {}, {}});
  for (std::uint32_t s = edited.surfaces_of(2).first; s < edited.surfaces_of(2).last; ++s)
    EXPECT_EQ(edited.scene().surfaces[s].material, 3u);
  EXPECT_FALSE(edited.apply({Operation::change, 2, {}, {}, {{MaterialChange::kEvery, 3}}}).materials);
}

TEST(EditedScene, EditsWithoutMeaningAreRefusedAndChangeNothing) {
  EditedScene edited(test_room());
  const auto refused = [&](const Edit& edit, const char* what) {
    const auto before = edited.scene().surfaces.size();
    try {
      edited.apply(edit);
      ADD_FAILURE() << "was not refused: " << what;
    } catch (const InvalidEdit& wrong) {
      EXPECT_THAT(wrong.what(), HasSubstr(what));
    }
    EXPECT_EQ(edited.scene().surfaces.size(), before);
  };
  refused({Operation::move, 9, Placement{}, {}, {}}, "no object 9");
  refused({Operation::add, 1, {}, {}, {}}, "there already");
  refused({Operation::remove, 3, {}, {}, {}}, "not there");
  refused({Operation::move, 3, Placement{}, {}, {}}, "not there");
  refused({Operation::reshape, 1, {}, {}, {}}, "no surfaces");
  refused({Operation::change, 1, {}, {}, {{3, 0}}}, "has no surface of material 'lamp'");
  refused({Operation::change, 1, {}, {}, {{MaterialChange::kEvery, 77}}}, "no material 77");
  refused({Operation::move, 1, Placement{{}, {1e60, 0, 0}}, {}, {}}, "cannot be put there");
  refused({Operation::move, 1, Placement{{}, {NAN, 0, 0}}, {}, {}}, "cannot be put there");
}

TEST(CameraPath, RunsEvenlyBetweenItsPlaces) {
  const CameraAt path[] = {{1, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 40}}, {3, {{2, 4, 0}, {1, 2, 0}, {0, 0, 1}, 60}}};
  EXPECT_EQ(camera_at(path, 0).eye, (Vec3{0, 0, 0}));
  EXPECT_EQ(camera_at(path, 2).eye, (Vec3{1, 2, 0}));
  EXPECT_EQ(camera_at(path, 2).vertical_fov_degrees, 50);
  EXPECT_EQ(camera_at(path, 9).target, (Vec3{1, 2, 0}));
}

class EventFile : public SceneFiles {
 protected:
  static constexpr std::string_view kScene = R"(
[mesh]
patch_size = 0.5
elements = 2
small_patch = 0.02
[[material]]
name = "white"
rho = 0.5
[[material]]
name = "only in events"
rho = [0.1, 0.2, 0.3]
E = 2
[[material]]
name = "nowhere"
rho = 0.9
[[object]]
name = "room"
box = {min = [0,0,0], max = [3,3,3]}
flip = true
material = "white"
[[object]]
name = "cube"
box = {min = [1,1,0], max = [2,2,1]}
material = "white"
absent = true
)";
  DynamicScene read(const std::string& events) const {
    return read_dynamic_scene(write("scene.toml", std::string(kScene) + events), Emission::exitance);
  }
  std::string error_of(const std::string& events) const {
    try {
      read(events);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static std::string event(double time, const std::string& object, const std::string& operation,
                           const std::string& more = "") {
    return "[[event]]\ntime = " + std::to_string(time) + "\nobject = \"" + object + "\"\noperation = \"" + operation +
           "\"\n" + more + "\n";
  }
};

TEST_F(EventFile, EverythingAtOnce) {
  const DynamicScene scene =
      read(event(1, "cube", "add", "translate = [0.5, 0, 0]") +
           event(2, "cube", "move", "rotate = {axis = [0,0,1], degrees = 90}\npivot = [1.5,1.5,0]") +
           event(3, "cube", "change", "material = \"only in events\"") +
           event(4, "cube", "reshape", "box = {min = [0.5,0.5,0], max = [1,1,2]}\nmaterial = \"white\"") +
           event(5, "cube", "select") + event(6, "cube", "deselect") + event(7, "cube", "remove") +
           "[[camera_path]]\ntime = 0\neye = [1,1,1]\ntarget = [2,2,2]\n");
  EXPECT_EQ(scene.scene.surfaces.size(), 6u);
  EXPECT_EQ(scene.scene.absent.size(), 6u);
  EXPECT_EQ(scene.scene.bands, 3u) << "a material that only an event names counts";
  EXPECT_EQ(scene.scene.materials.size(), 2u) << "one that nothing names is dropped";
  ASSERT_EQ(scene.events.size(), 7u);
  EditedScene edited(scene.scene);
  edited.apply(scene.events[0].edit);
  EXPECT_EQ(edited.scene().surfaces[6].polygon.outer[0], (Vec3{1.5, 1, 0}));
  edited.apply(scene.events[1].edit);
  EXPECT_EQ(edited.scene().surfaces[6].polygon.outer[0], (Vec3{2, 1, 0})) << "turned about its middle, exactly";
  edited.apply(scene.events[2].edit);
  EXPECT_EQ(edited.scene().materials[edited.scene().surfaces[6].material].E[2], 2);
  edited.apply(scene.events[3].edit);
  EXPECT_EQ(edited.scene().surfaces[6].polygon.outer[0], (Vec3{0.5, 0.5, 0}));
  EXPECT_EQ(scene.camera_path.size(), 1u);
  EXPECT_EQ(scene.scene.mesh.elements_per_edge, 2u);
}

TEST_F(EventFile, ANewShapeIsOfWhatTheObjectWasMadeOf) {
  const std::string box = "box = {min = [0.5,0.5,0], max = [1,1,2]}\n", own = "material = \"only in events\"\n";
  const auto material_after = [&](const std::string& events) {
    const DynamicScene scene = read(event(1, "cube", "add") + events);
    EditedScene edited(scene.scene);
    for (const Event& e : scene.events) edited.apply(e.edit);
    return edited.scene().materials[edited.scene().surfaces.back().material].name;
  };
  EXPECT_EQ(material_after(event(2, "cube", "reshape", box)), "white");
  EXPECT_EQ(material_after(event(2, "cube", "reshape", box + own)), "only in events");
  const std::string changed = event(2, "cube", "change", own);
  EXPECT_EQ(material_after(changed + event(3, "cube", "reshape", box)), "only in events");
  EXPECT_EQ(material_after(changed + event(3, "cube", "reshape", box + "material = \"white\"\n")), "white");
  EXPECT_EQ(material_after(event(2, "cube", "reshape", box + own) + event(3, "cube", "reshape", box)),
            "only in events");
  EXPECT_EQ(material_after(event(2, "cube", "change", "materials = {white = \"nowhere\"}") +
                           event(3, "cube", "reshape", box)),
            "nowhere");
}

TEST_F(EventFile, ANewMeshIsOfWhatItsMaterialsWereReplacedBy) {
  write("tin.mtl", "newmtl tin\nKd 0.3 0.3 0.3\n");
  for (const char* name : {"one.obj", "two.obj"})
    write(name, "mtllib tin.mtl\nv 0 0 1\nv 1 0 1\nv 0 1 1\nusemtl tin\nf 1 2 3\n");
  write("bare.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  const auto material_after = [&](const std::string& given, const std::string& mesh, const std::string& events = "") {
    const DynamicScene scene =
        read("[[object]]\nname = \"flag\"\nmesh = \"one.obj\"\n" + given + event(1, "cube", "add") + events +
             event(9, "flag", "reshape", "mesh = \"" + mesh + "\""));
    EditedScene edited(scene.scene);
    for (const Event& e : scene.events) edited.apply(e.edit);
    const Material& material = edited.scene().materials[edited.scene().surfaces.back().material];
    return material.name + (material.rho[0] == 0.3 ? " 0.3" : "");
  };
  EXPECT_EQ(material_after("", "two.obj"), "tin 0.3") << "its own";
  EXPECT_EQ(material_after("", "bare.obj"), "tin 0.3") << "it has none: what the object was of";
  EXPECT_EQ(material_after("material = \"white\"\n", "two.obj"), "white");
  EXPECT_EQ(material_after("materials = {tin = \"white\"}\n", "two.obj"), "white");
  EXPECT_EQ(material_after("", "two.obj", event(2, "flag", "change", "materials = {tin = \"nowhere\"}")), "nowhere");
  const std::string two =
      "[[object]]\nname = \"screen\"\npolygons = [{polygon = [[0,0,2],[1,0,2],[0,1,2]], material = "
      "\"white\"}, {polygon = [[0,0,2.5],[1,0,2.5],[0,1,2.5]], material = \"nowhere\"}]\n";
  EXPECT_THAT(error_of(two + event(1, "screen", "reshape", "mesh = \"bare.obj\"")),
              HasSubstr("'screen' is of 2 materials and its new shape names none"));
  EXPECT_EQ(error_of(two + event(1, "screen", "reshape", "mesh = \"bare.obj\"\nmaterial = \"white\"")), "");
}

TEST_F(EventFile, SmallPatchesAreOneElement) {
  const DynamicScene read_scene = read("");
  Scene scene = read_scene.scene;
  Surface small;
  small.polygon.outer = {{1, 1, 1}, {1.15, 1, 1}, {1.15, 1.1, 1}, {1, 1.1, 1}};
  scene.surfaces.push_back(small);
  const PolygonSoup soup = make_soup(scene);
  MeshOptions options{scene.mesh.patch_size, scene.mesh.elements_per_edge};
  options.small_patch = scene.mesh.small_patch;
  const PatchMesh mesh = make_patch_mesh(scene, soup, options);
  EXPECT_EQ(mesh.patches.size(), 6u * 36 + 1);
  EXPECT_EQ(mesh.elements.size(), 6u * 36 * 4 + 1);
}

TEST_F(EventFile, BadEventsNameTheirLineAndWhatIsWrong) {
  EXPECT_THAT(error_of(event(1, "cup", "add")), HasSubstr("there is no object 'cup'"));
  EXPECT_THAT(error_of(event(1, "cup", "add")), HasSubstr("scene.toml:28"));
  EXPECT_THAT(error_of(event(1, "cube", "fly")), HasSubstr("'fly' is not known"));
  EXPECT_THAT(error_of(event(2, "cube", "add") + event(1, "cube", "remove")), HasSubstr("in order of time"));
  EXPECT_THAT(error_of(event(2, "cube", "add") + event(2, "cube", "remove")), HasSubstr("another event at 2"));
  EXPECT_THAT(error_of(event(1, "cube", "remove")), HasSubstr("not there"));
  const std::string added = event(1, "cube", "add");
  EXPECT_THAT(error_of(added + event(2, "cube", "deselect")), HasSubstr("'cube' is not selected"));
  EXPECT_THAT(error_of(added + event(2, "cube", "select") + event(3, "room", "remove")),
              HasSubstr("'cube' is selected; deselect it before"));
  EXPECT_EQ(error_of(added + event(2, "cube", "select") + event(3, "room", "select") + event(4, "room", "deselect")),
            "");
  EXPECT_THAT(error_of(event(1, "cube", "add") + event(2, "cube", "add")), HasSubstr("there already"));
  EXPECT_THAT(error_of(event(1, "cube", "add") + event(2, "cube", "change")), HasSubstr("needs \"material\""));
  EXPECT_THAT(error_of(event(1, "cube", "add") + event(2, "cube", "change", "material = \"blue\"")),
              HasSubstr("'blue' is not defined"));
  EXPECT_THAT(error_of(event(1, "cube", "add", "scale = 0")), HasSubstr("must not be zero"));
  EXPECT_THAT(error_of(event(1, "cube", "add", "translate = [1e60, 0, 0]")), HasSubstr("cannot be put there"));
  EXPECT_THAT(error_of(event(1, "cube", "add", "speed = 3")), HasSubstr("\"speed\" is not known"));
  EXPECT_THAT(error_of("[[event]]\nobject = \"cube\"\noperation = \"add\"\n"), HasSubstr("\"time\" is missing"));
  EXPECT_THAT(error_of(event(-1, "cube", "add")), HasSubstr("the event is at -1, but the scene begins at 0"));
  EXPECT_THAT(error_of("[[event]]\ntime = nan\nobject = \"cube\"\noperation = \"add\"\n"), HasSubstr("finite"));
  EXPECT_THAT(
      error_of("[[camera_path]]\ntime = 1\neye=[0,0,0]\ntarget=[1,1,1]\n[[camera_path]]\ntime = 1\neye=[0,0,0]\n"
               "target=[1,1,1]\n"),
      HasSubstr("must ascend"));
}

}  // namespace
}  // namespace exitance
