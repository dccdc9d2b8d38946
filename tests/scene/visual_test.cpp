// What bodies look like in pictures: meshes that are read, and what a scene may not ask for.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>

#include "scene_fixture.hpp"
#include "withy/scene/mesh_file.hpp"

namespace withy::test {
namespace {

using testing::HasSubstr;

/// A file that is there while this is.
class MeshFile {
 public:
  MeshFile(const std::string& name, const std::string& bytes)
      : path_(std::filesystem::temp_directory_path() / ("withy-mesh-" + std::to_string(::getpid()) + name)) {
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  ~MeshFile() { std::filesystem::remove(path_); }
  MeshFile(const MeshFile&) = delete;
  MeshFile& operator=(const MeshFile&) = delete;
  [[nodiscard]] TriangleMesh read() const { return read_mesh(path_); }
  [[nodiscard]] std::string text() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::string refusal(const MeshFile& file) {
  try {
    (void)file.read();
  } catch (const std::domain_error& e) {
    return e.what();
  }
  return {};
}

/// What a closed surface encloses, by the divergence theorem.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  return sum;
}

// A pyramid of height 3 over a square of edge 2: volume 4.
constexpr const char* pyramid_obj = R"(# a comment
mtllib pyramid.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vn 0 0 1
v 0 0 3
f 4//1 3//1 2//1 1//1
f 1 2 5
f 2/1 3/2 5/3
f -3 -2 -1
f 4 1 5
)";

std::string as_stl_text(const TriangleMesh& mesh) {
  std::string text = "solid pyramid\n";
  for (const auto& t : mesh.triangles) {
    text += "  facet normal 0 0 0\n    outer loop\r\n";
    for (const auto v : t) {
      const Vector3& p = mesh.vertices[v];
      text +=
          "      vertex " + std::to_string(p.x()) + " " + std::to_string(p.y()) + "\t" + std::to_string(p.z()) + "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid pyramid\n";
}

std::string as_stl_bytes(const TriangleMesh& mesh, float scale = 1) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // as some programs begin binary files too
  const auto add = [&bytes](const auto& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) add(0.0F);
    for (const auto v : t)
      for (const double x : mesh.vertices[v]) add(scale * static_cast<float>(x));
    bytes += std::string(2, '\0');
  }
  return bytes;
}

TEST(MeshFiles, OneBodyIsTheSameInAllFormsAndItsEqualVerticesAreOne) {
  const TriangleMesh obj = MeshFile(".obj", pyramid_obj).read();
  EXPECT_EQ(obj.triangles.size(), 6U) << "a polygon becomes a fan";
  EXPECT_NEAR(volume(obj), 4, 1e-12);
  for (const auto& bytes : {as_stl_text(obj), as_stl_bytes(obj)}) {
    const TriangleMesh stl = MeshFile(".STL", bytes).read();
    EXPECT_EQ(stl.vertices.size(), 5U);
    EXPECT_EQ(stl.triangles.size(), 6U);
    EXPECT_NEAR(volume(stl), 4, 1e-12);
  }
}

TEST(MeshFiles, WhatCannotBeReadIsSaidWithItsLine) {
  const TriangleMesh pyramid = MeshFile(".obj", pyramid_obj).read();
  const std::string binary = as_stl_bytes(pyramid);
  const std::string with_nan = as_stl_bytes(pyramid, std::numeric_limits<float>::infinity());
  for (const auto& [name, bytes, why] : std::vector<std::array<std::string, 3>>{
           {".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: got '4'; need one of the 3 vertices before it"},
           {".obj", "v 0 0\n", "line 1: got ''; need a coordinate"},
           {".obj", "v 0 0 0\nv 1 0 nan\n", "line 2: got 'nan'; need a coordinate"},
           {".obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: a face of 2 vertices"},
           {".obj", "", "it has no triangles"},
           {".stl", "", "it is no STL"},
           {".stl", binary.substr(0, binary.size() - 1), "it is no STL"},
           {".stl", with_nan, "facet 1 has a coordinate that is no finite number"},
           {".stl", "solid\nfacet normal 0 0 1\nvertex 0 0 0\nvertex 1 0 0\nendfacet\n",
            "line 5: a facet with 2 vertices"},
           {".stl", as_stl_text(pyramid).substr(0, as_stl_text(pyramid).size() - 20), "not all of one"},
           {".step", "", "need a file that ends in .stl or .obj"}}) {
    EXPECT_THAT(refusal(MeshFile(name, bytes)), HasSubstr(why)) << name << why;
  }
}

// A triangle with one mode and its second order.
constexpr const char* triangle_vtk = R"(# vtk DataFile Version 3.0
by hand
ASCII
DATASET POLYDATA
POINTS 3 float
0 0 0 1 0 0
0 1 0
POLYGONS 1 4
3 0 1 2
POINT_DATA 3
VECTORS mode_1_1 float
0 0 0  -1 0 0  0 -2 0
VECTORS mode_1 float
0 0 0
0 0 1
0 0 2
)";

TEST(MeshFiles, SurfacesOfBodiesThatBendHaveTheirModesInOrder) {
  const MeshFile file(".vtk", triangle_vtk);
  const ModeSurface surface = read_mode_surface(file.text());
  ASSERT_EQ(surface.mesh.triangles.size(), 1U);
  EXPECT_EQ(surface.mesh.vertices[2], Vector3(0, 1, 0));
  ASSERT_EQ(surface.first.cols(), 1);
  EXPECT_EQ(surface.first(8, 0), 2);
  ASSERT_EQ(surface.second.cols(), 1);
  EXPECT_EQ(surface.second(3, 0), -1);
  const auto refused = [](const std::string& name, const std::string& from, const std::string& to) {
    const MeshFile bad(name, replaced(triangle_vtk, from, to));
    try {
      (void)read_mode_surface(bad.text());
    } catch (const std::domain_error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused(".obj", "by", "by"), HasSubstr("need a file that ends in .vtk"));
  EXPECT_THAT(refused(".vtk", "ASCII", "BINARY"), HasSubstr("line 5: need a VTK file in text"));
  EXPECT_THAT(refused(".vtk", "POLYDATA", "UNSTRUCTURED_GRID"), HasSubstr("line 4: need DATASET POLYDATA"));
  EXPECT_THAT(refused(".vtk", "3 0 1 2", "3 0 1 3"), HasSubstr("line 9: got 3; need a whole number from 0 to 2"));
  EXPECT_THAT(refused(".vtk", "0 0 2\n", "0 0\n"), HasSubstr("the file ends within its numbers"));
  EXPECT_THAT(refused(".vtk", "0 0 2\n", "0 0 up\n"), HasSubstr("line 16: got 'up'; need a coordinate"));
  EXPECT_THAT(refused(".vtk", "mode_1 ", "displacement "),
              HasSubstr("line 13: got vectors 'displacement'; need mode_1"));
  EXPECT_THAT(refused(".vtk", "mode_1 ", "mode_2 "), HasSubstr("it has no vectors 'mode_1'"));
  EXPECT_THAT(refused(".vtk", "mode_1_1", "mode_1_2"), HasSubstr("it has no vectors 'mode_1_1'"));
  EXPECT_THAT(refused(".vtk", "POLYGONS 1 4\n3 0 1 2\n", ""), HasSubstr("no VTK file with POLYGONS"));
}

TEST_F(SceneTest, ABodyOfModesIsDrawnWithTheShapesOfItsOwn) {
  const MeshFile triangle(".vtk", triangle_vtk);
  const auto modal = [&](const std::string& visual) {
    return problems(
        "format: withy/1\ntime: {end: 1}\nbodies:\n  boom:\n    type: modal\n    file: " WITHY_SOURCE_DIRECTORY
        "/scenes/cantilever.SID_FEM\n    visual: " +
            visual + "\nhinges: {axle: {type: revolute, axis: [0, 1, 0], parent: world, child: boom}}\n",
        registry);
  };
  EXPECT_EQ(modal("{mesh: " WITHY_SOURCE_DIRECTORY "/scenes/cantilever.vtk}"), "");
  EXPECT_THAT(modal("{mesh: \"" + triangle.text() + "\"}"),
              HasSubstr("7:20: /bodies/boom/visual/mesh: got '" + triangle.text() +
                        "'; it has the shapes of 1 modes, the body has 8; need the file that withy import wrote"));
  EXPECT_THAT(modal("{mesh: " WITHY_SOURCE_DIRECTORY "/scenes/cantilever.vtk, scale: 1 mm}"),
              HasSubstr("need no position, orientation"));
  EXPECT_THAT(modal("{mesh: bus.stl}"), HasSubstr("there is no file 'bus.stl'"));
  EXPECT_THAT(modal("{radius: 1}"), HasSubstr("got radius; need mesh, with the .vtk file that withy import wrote"));
}

TEST_F(SceneTest, AMeshIsForPicturesAlone) {
  const MeshFile mesh(".obj", pyramid_obj);
  const auto with = [](const std::string& visual) {
    return replaced(good_scene, "    mass: 20.0", "    mass: 20.0\n    visual: " + visual);
  };
  const Scene plain = parse_scene(good_scene, "s.yaml", registry);
  const Scene drawn = parse_scene(with("{mesh: \"" + mesh.text() + "\", scale: 1 mm}"), "s.yaml", registry);
  EXPECT_EQ(drawn.sources.files.size(), plain.sources.files.size()) << "no result depends on it";
  EXPECT_EQ(drawn.source.at("bodies").at("hub").at("visual").number_at("scale"), 1e-3);
  const MeshFile broken(".stl", "solid?\nendsolid\n");
  EXPECT_THAT(problems(with("{mesh: \"" + broken.text() + "\"}"), registry),
              HasSubstr("s.yaml:8:20: /bodies/hub/visual/mesh: got '" + broken.text() + "'; it has no triangles"));
  EXPECT_THAT(problems(with("{mesh: nowhere.stl}"), registry), HasSubstr("there is no file 'nowhere.stl'"));
}

TEST_F(SceneTest, ABodyIsDrawnWithOneShapeThatItCanHave) {
  const auto hub = [this](const std::string& visual) {
    return problems(replaced(good_scene, "    mass: 20.0", "    mass: 20.0\n    visual: " + visual), registry);
  };
  const auto boom = [this](const std::string& visual) {
    return problems(replaced(good_scene, "    length: 0.9", "    length: 0.9\n    visual: " + visual), registry);
  };
  for (const char* good :
       {"{box: [1, 2, 300 mm], position: [0, 0, 1]}", "{sphere: 0.1}", "{cylinder: {radius: 1, length: 2}}"})
    EXPECT_EQ(hub(good), "");
  for (const char* good : {"{radius: 5 mm}", "{width: [[0, 0.1], [0.9, 0.05]], height: 0.02}"})
    EXPECT_EQ(boom(good), "");
  EXPECT_THAT(hub("{}"), HasSubstr("8:13: /bodies/hub/visual: got no shape; need box, sphere"));
  EXPECT_THAT(hub("{box: [1, 1, 1], sphere: 1}"), HasSubstr("got box, sphere; need one shape"));
  EXPECT_THAT(hub("{box: [1, 0, 1]}"), HasSubstr("/bodies/hub/visual/box"));
  EXPECT_THAT(hub("{radius: 0.1}"), HasSubstr("got radius; need box, sphere, cylinder or mesh, for a rigid body"));
  EXPECT_THAT(hub("{thickness: 0.1}"), HasSubstr("got thickness; need box"));
  EXPECT_THAT(boom("{width: 0.1}"), HasSubstr("got width alone; need width and height"));
  EXPECT_THAT(boom("{box: [1, 1, 1]}"), HasSubstr("got box; need radius, or width and height, for a beam"));
  const auto panel = [this](const std::string& visual) {
    return problems(
        "format: withy/1\ntime: {end: 1}\nbodies: {panel: {type: plate, length: 1, width: 1, mass_per_area: "
        "2, stiffness: 5, visual: " +
            visual + "}}\nhinges: {edge: {type: weld, parent: world, child: panel}}\n",
        registry);
  };
  EXPECT_EQ(panel("{thickness: 20 mm}"), "");
  EXPECT_THAT(panel("{radius: 0.1}"), HasSubstr("got radius; need thickness, for a plate"));
  EXPECT_THAT(boom("{radus: 1}"), HasSubstr("did you mean 'radius'?"));
}

}  // namespace
}  // namespace withy::test
