#include "withy/results/report/gltf.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "withy/results/report/morph.hpp"

namespace withy {
namespace {

using Json = nlohmann::ordered_json;

constexpr double tolerance = 1e-4;
// Constants of the format.
constexpr int array_buffer = 34962, element_array_buffer = 34963, float_type = 5126, unsigned_type = 5125;

/// A file as it grows: its JSON, and the bytes that this refers to.
class Binary {
 public:
  Binary() {
    json_ = {{"asset", {{"version", "2.0"}, {"generator", "withy"}}}, {"scene", 0}};
    for (const char* list : {"scenes", "nodes", "meshes", "materials", "accessors", "bufferViews", "animations"})
      json_[list] = Json::array();
    // Colours that are told apart by those who do not see colours: of flexible and of rigid bodies.
    add_material("flexible", {0.0, 0.168, 0.445, 1.0});
    add_material("rigid", {0.55, 0.55, 0.58, 1.0});
    json_["animations"].push_back({{"name", "run"}, {"samplers", Json::array()}, {"channels", Json::array()}});
  }

  /// The runs' nodes are those of the scene. \param origin which place of the world is the file's origin [m]
  void add(const Animation& run, const Vector3& origin) {
    const std::size_t times = scalars(run.times());
    // Numbers of 32 bits tell places near the first body, which a node of its own carries along.
    std::vector<Vector3> carried(run.times().size(), origin);
    for (std::size_t m = 0; run.far() && m < carried.size(); ++m) carried[m] = run.pose(0, m).p;
    Json children = Json::array();
    for (std::size_t b = 0; b < run.bodies(); ++b) children.push_back(add_body(run, b, carried, times));
    const Eigen::Quaterniond upright(rotation_between(run.up(), Vector3::UnitY()));
    Json root{{"name", run.title()}, {"rotation", {upright.x(), upright.y(), upright.z(), upright.w()}}};
    if (run.far()) {
      root["extras"] = {{"origin", {origin.x(), origin.y(), origin.z()}}};
      const std::size_t carrier = add_to("nodes", {{"name", run.title() + ", carried"}, {"children", children}});
      for (Vector3& p : carried) p -= origin;
      add_places(carrier, carried, times);
      children = Json::array({carrier});
    }
    root["children"] = std::move(children);
    roots_.push_back(add_to("nodes", std::move(root)));
  }

  [[nodiscard]] std::string text() {
    json_["scenes"].push_back({{"nodes", roots_}});
    json_["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    std::string head = json_.dump(-1, ' ', true, Json::error_handler_t::replace);
    head.append((4 - head.size() % 4) % 4, ' ');
    std::string file = "glTF";
    const auto add = [&](std::size_t number) {
      const auto n = static_cast<std::uint32_t>(number);
      for (int byte = 0; byte < 4; ++byte) file += static_cast<char>(n >> (8 * byte) & 0xff);
    };
    add(2);
    add(12 + 8 + head.size() + 8 + bytes_.size());
    add(head.size());
    file += "JSON" + head;
    add(bytes_.size());
    file += std::string("BIN\0", 4) + bytes_;
    return file;
  }

 private:
  std::size_t add_to(const char* list, Json item) {
    json_[list].push_back(std::move(item));
    return json_[list].size() - 1;
  }

  void add_material(const char* name, const Json& color) {
    // Both sides are seen: meshes may be sheets without a thickness.
    add_to("materials", {{"name", name},
                         {"doubleSided", true},
                         {"pbrMetallicRoughness",
                          {{"baseColorFactor", color}, {"metallicFactor", 0.05}, {"roughnessFactor", 0.55}}}});
  }

  /// \param target what the numbers are for; 0: neither vertices nor indices
  template <class Number>
  std::size_t add_numbers(const std::vector<Number>& numbers, const char* type, std::size_t width, int target,
                          Json bounds) {
    Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", numbers.size() * sizeof(Number)}};
    if (target != 0) view["target"] = target;
    const auto raw = std::as_bytes(std::span(numbers));
    bytes_.append(reinterpret_cast<const char*>(raw.data()), raw.size());
    Json accessor{{"bufferView", add_to("bufferViews", std::move(view))},
                  {"componentType", std::is_same_v<Number, float> ? float_type : unsigned_type},
                  {"count", numbers.size() / width},
                  {"type", type}};
    accessor.update(bounds);
    return add_to("accessors", std::move(accessor));
  }

  std::size_t scalars(const std::vector<double>& values) {
    const std::vector<float> numbers(values.begin(), values.end());
    const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
    return add_numbers(numbers, "SCALAR", 1, 0, {{"min", Json::array({*low})}, {"max", Json::array({*high})}});
  }

  std::size_t positions(const std::vector<float>& numbers) {
    Eigen::AlignedBox3f room;
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) room.extend(Eigen::Map<const Eigen::Vector3f>(&numbers[i]));
    const auto corner = [](const Eigen::Vector3f& v) -> Json { return {v.x(), v.y(), v.z()}; };
    return add_numbers(numbers, "VEC3", 3, array_buffer, {{"min", corner(room.min())}, {"max", corner(room.max())}});
  }

  std::size_t add_mesh(const Surface& surface, const std::string& name, std::size_t material, const Morph& morph) {
    std::vector<float> vertices;
    for (const Vector3& v : surface.vertices)
      for (const double x : v) vertices.push_back(static_cast<float>(x));
    std::vector<std::uint32_t> indices;
    for (const auto& triangle : surface.triangles) indices.insert(indices.end(), triangle.begin(), triangle.end());
    const std::size_t position = positions(vertices);
    Json primitive{{"attributes", {{"POSITION", position}}},
                   {"indices", add_numbers(indices, "SCALAR", 1, element_array_buffer, Json::object())},
                   {"material", material}};
    for (Eigen::Index s = 0; s < morph.shapes.cols(); ++s) {
      const Eigen::VectorXf shape = morph.shapes.col(s).cast<float>();
      const std::size_t target = positions({shape.data(), shape.data() + shape.size()});
      primitive["targets"].push_back({{"POSITION", target}});
    }
    Json mesh{{"name", name}, {"primitives", Json::array({std::move(primitive)})}};
    if (morph.shapes.cols() > 0) mesh["weights"] = std::vector<double>(static_cast<std::size_t>(morph.shapes.cols()));
    return add_to("meshes", std::move(mesh));
  }

  void add_channel(std::size_t node, const char* path, std::size_t times, std::size_t output) {
    Json& animation = json_["animations"].back();
    animation["samplers"].push_back({{"input", times}, {"output", output}, {"interpolation", "LINEAR"}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  }

  /// What plays nothing shows the first moment, not all bodies on one place.
  void add_places(std::size_t node, const std::vector<Vector3>& at, std::size_t times) {
    std::vector<float> places;
    for (const Vector3& p : at)
      for (const double x : p) places.push_back(static_cast<float>(x));
    json_["nodes"][node]["translation"] = std::vector<float>(places.begin(), places.begin() + 3);
    add_channel(node, "translation", times, add_numbers(places, "VEC3", 3, 0, Json::object()));
  }

  /// \param carried the place from which the body's is told, at each moment, world axes [m]
  std::size_t add_body(const Animation& run, std::size_t body, const std::vector<Vector3>& carried, std::size_t times) {
    Json json{{"name", run.name(body)}};
    const Surface surface = run.surface(body);
    Morph morph;
    if (run.flexible(body)) morph = morph_of(run, body, tolerance);
    if (!surface.triangles.empty()) {
      const std::size_t material = run.flexible(body) ? 0 : 1;
      json["mesh"] = add_mesh(surface, run.name(body), material, morph);
    }
    const std::size_t node = add_to("nodes", std::move(json));
    std::vector<Vector3> places;
    std::vector<float> turns;
    Eigen::Quaternionf before = Eigen::Quaternionf::Identity();
    for (std::size_t m = 0; m < run.times().size(); ++m) {
      const Pose X = run.pose(body, m);
      Eigen::Quaternionf q = Eigen::Quaterniond(X.R).cast<float>().normalized();
      if (q.dot(before) < 0) q.coeffs() *= -1;  // the short way to the next key
      before = q;
      places.emplace_back(X.p - carried[m]);
      turns.insert(turns.end(), {q.x(), q.y(), q.z(), q.w()});
    }
    json_["nodes"][node]["rotation"] = std::vector<float>(turns.begin(), turns.begin() + 4);
    add_places(node, places, times);
    add_channel(node, "rotation", times, add_numbers(turns, "VEC4", 4, 0, Json::object()));
    if (morph.shapes.cols() > 0 && !surface.triangles.empty()) {
      const Eigen::MatrixXf w = morph.weights.cast<float>();  // by columns: all weights of a key together
      json_["nodes"][node]["weights"] = std::vector<float>(w.data(), w.data() + w.rows());
      add_channel(node, "weights", times,
                  add_numbers(std::vector<float>(w.data(), w.data() + w.size()), "SCALAR", 1, 0, Json::object()));
    }
    return node;
  }

  Json json_;
  Json roots_ = Json::array();
  std::string bytes_;
};

}  // namespace

std::string gltf_binary(const std::vector<Animation>& runs) {
  Binary file;
  // Far from the world's origin, where the first such run begins.
  const auto far = std::find_if(runs.begin(), runs.end(), [](const Animation& run) { return run.far(); });
  const Vector3 origin = far != runs.end() ? far->pose(0, 0).p : Vector3(Vector3::Zero());
  for (const Animation& run : runs) file.add(run, origin);
  return file.text();
}

}  // namespace withy
