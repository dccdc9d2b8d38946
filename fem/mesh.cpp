#include "mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "element_faces.hpp"
#include "element_shape.hpp"
#include "text_lines.hpp"

namespace withy::fem {
namespace {

constexpr int most_includes = 8;  ///< one in the other

std::string capitals(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::toupper(c); });
  return out;
}

/// A keyword line of an input deck: "*NSET, NSET=TIP, GENERATE".
struct Keyword {
  std::string name;                               ///< "NSET", without spaces
  std::map<std::string, std::string> parameters;  ///< names in capitals, values as they stand
};

Keyword keyword_of(std::string_view line) {
  Keyword k;
  const auto fields = split(line.substr(1), ",");
  for (const char c : capitals(fields.empty() ? "" : fields[0])) {
    if (c != ' ') k.name += c;
  }
  for (std::size_t i = 1; i < fields.size(); ++i) {
    const std::size_t equals = fields[i].find('=');
    const std::string_view value = equals == std::string_view::npos ? "" : trimmed(fields[i].substr(equals + 1));
    k.parameters[capitals(trimmed(fields[i].substr(0, equals)))] = std::string(value);
  }
  return k;
}

/// Reads input decks, included ones too.
class DeckReader {
 public:
  explicit DeckReader(Mesh& mesh) : mesh_(mesh) {}

  void read(const std::filesystem::path& file, int depth) {
    if (depth > most_includes) throw InputError(file.string() + ": files include each other too deeply");
    const std::string text = text_of(file);
    Lines lines(text);
    std::string_view line;
    Keyword keyword;
    while (lines.next(line)) {
      where_ = fmt::format("{}:{}", file.string(), lines.number());
      line = trimmed(line);
      if (line.empty() || line.starts_with("**")) continue;
      if (line.front() != '*') {
        data(keyword, line);
        continue;
      }
      keyword = keyword_of(line);
      begin(keyword);
      if (keyword.name == "INCLUDE") {
        read(file.parent_path() / keyword.parameters["INPUT"], depth + 1);
      } else if (keyword.parameters.contains("INPUT") && (keyword.name == "NODE" || keyword.name == "NSET")) {
        fault("the data are in another file; put them into this one, or *INCLUDE it");
      }
    }
  }

 private:
  [[noreturn]] void fault(const std::string& message) const { throw InputError(where_ + ": " + message); }

  /// A keyword line: what it says itself.
  void begin(const Keyword& keyword) {
    open_ = nullptr;
    if (keyword.name == "MATERIAL") material_ = name_in(keyword, "NAME");
    if (keyword.name == "SOLIDSECTION" && !keyword.parameters.contains("ORIENTATION") &&
        !keyword.parameters.contains("COMPOSITE"))
      mesh_.sections.push_back({name_in(keyword, "ELSET"), name_in(keyword, "MATERIAL")});
  }

  void data(const Keyword& keyword, std::string_view line) {
    if (keyword.name == "NODE") node(keyword, line);
    if (keyword.name == "ELEMENT") element(keyword, line);
    if (keyword.name == "NSET") members(keyword, line, "NSET", mesh_.sets);
    if (keyword.name == "ELSET") members(keyword, line, "ELSET", mesh_.element_sets);
    if (keyword.name == "ELASTIC") elastic(keyword, line);
    if (keyword.name == "INSTANCE") fault("an instance that is moved; write the deck without parts and assembly");
  }

  void node(const Keyword& keyword, std::string_view line) {
    const auto fields = split(line, ",");
    const auto number = number_of<long>(fields[0]);
    if (!number || *number <= 0) fault(fmt::format("got node '{}'; need a number", fields[0]));
    Vector3 X = Vector3::Zero();
    for (std::size_t i = 1; i < std::min<std::size_t>(fields.size(), 4); ++i) {
      if (fields[i].empty()) continue;
      const auto x = number_of<double>(fields[i]);
      if (!x || !std::isfinite(*x)) fault(fmt::format("got coordinate '{}'; need a finite number", fields[i]));
      X[static_cast<Eigen::Index>(i) - 1] = *x;
    }
    const auto [it, fresh] = mesh_.nodes.emplace(*number, X);
    if (!fresh && it->second != X) fault(fmt::format("node {} is at two places; need one part only", *number));
    if (const auto set = keyword.parameters.find("NSET"); set != keyword.parameters.end())
      add(*number, mesh_.sets[capitals(set->second)]);
  }

  /// A parameter's value in capitals; empty where there is none.
  static std::string name_in(const Keyword& keyword, const char* parameter) {
    const auto name = keyword.parameters.find(parameter);
    return name == keyword.parameters.end() ? std::string() : capitals(name->second);
  }

  /// Number and nodes, on as many lines as they need.
  void element(const Keyword& keyword, std::string_view line) {
    auto fields = split(line, ",");
    std::erase_if(fields, [](std::string_view f) { return f.empty(); });
    std::size_t first = 0;
    if (open_ == nullptr) {
      const auto number = fields.empty() ? std::nullopt : number_of<long>(fields[0]);
      if (!number || *number <= 0) fault(fmt::format("got '{}'; need an element's number and nodes", line));
      const std::string type = name_in(keyword, "TYPE");
      // Of other elements it is not known how many lines they take.
      if (element_faces(type) == nullptr) {
        mesh_.other_elements.insert(type);
        return;
      }
      const bool known = element_shape(type) != nullptr;
      const auto [it, fresh] = (known ? mesh_.elements : mesh_.drawn_only).emplace(*number, Element{type, {}});
      if (!fresh || (known ? mesh_.drawn_only : mesh_.elements).contains(*number))
        fault(fmt::format("element {} is there twice", *number));
      open_ = &it->second;
      if (const std::string set = name_in(keyword, "ELSET"); !set.empty()) add(*number, mesh_.element_sets[set]);
      first = 1;
    }
    for (std::size_t i = first; i < fields.size(); ++i) {
      const auto node = number_of<long>(fields[i]);
      if (!node) fault(fmt::format("got '{}'; need a node's number", fields[i]));
      open_->nodes.push_back(*node);
    }
    const std::size_t count = element_faces(open_->type)->nodes;
    if (open_->nodes.size() > count)
      fault(fmt::format("got {} nodes; {} has {}", open_->nodes.size(), open_->type, count));
    if (open_->nodes.size() == count) open_ = nullptr;
  }

  /// Constants of a material; other kinds, and such that depend on temperature, are left out.
  void elastic(const Keyword& keyword, std::string_view line) {
    const std::string type = name_in(keyword, "TYPE");
    const auto fields = split(line, ",");
    const auto modulus = number_of<double>(fields[0]);
    const auto ratio = fields.size() > 1 ? number_of<double>(fields[1]) : std::nullopt;
    const bool fresh = elastic_.insert(material_).second;
    if ((!type.empty() && type != "ISO" && type != "ISOTROPIC") || !fresh || !modulus || !ratio) {
      mesh_.materials.erase(material_);
    } else {
      mesh_.materials[material_] = {*modulus, *ratio};
    }
  }

  using Sets = std::map<std::string, std::vector<long>>;
  void members(const Keyword& keyword, std::string_view line, const char* parameter, Sets& sets) {
    const std::string name = name_in(keyword, parameter);
    if (name.empty()) fault(fmt::format("need *{0}, {0}=name", parameter));
    const auto fields = split(line, ",");
    if (keyword.parameters.contains("GENERATE")) return generate(fields, sets[name]);
    for (const std::string_view field : fields) {
      if (field.empty()) continue;
      if (const auto number = number_of<long>(field)) {
        add(*number, sets[name]);
      } else if (const auto other = sets.find(capitals(field)); other == sets.end()) {
        fault(fmt::format("got '{}'; need a number or a set defined before", field));
      } else if (std::vector<long>& set = sets[name]; &other->second != &set) {  // it holds itself already
        for (const long member : other->second) add(member, set);
      }
    }
  }

  void generate(const std::vector<std::string_view>& fields, std::vector<long>& set) {
    const auto from = number_of<long>(fields[0]);
    const auto to = fields.size() > 1 ? number_of<long>(fields[1]) : from;
    const auto by = fields.size() > 2 && !fields[2].empty() ? number_of<long>(fields[2]) : std::optional<long>(1);
    if (!from || !to || !by || *from <= 0 || *to < *from || *to > greatest_number || *by <= 0 || *by > greatest_number)
      fault(fmt::format("need from, to, step: numbers from 1 to {}, the second not below the first", greatest_number));
    for (long n = *from; n <= *to; n += *by) add(n, set);
  }

  void add(long member, std::vector<long>& set) {
    if (++members_ > most_members) fault(fmt::format("all sets have more than {} members", most_members));
    set.push_back(member);
  }

  static constexpr long greatest_number = 1'000'000'000'000;
  static constexpr std::size_t most_members = 32'000'000;  // 256 MB

  Mesh& mesh_;
  std::size_t members_ = 0;  ///< of all sets
  std::string where_;
  Element* open_ = nullptr;        ///< lacks nodes yet
  std::string material_;           ///< the one that properties are of
  std::set<std::string> elastic_;  ///< materials that had constants
};

/// The block "2C" of a result file: " -1", the number in 10 columns, three coordinates in 12 columns each.
void read_result_file(const std::filesystem::path& file, Mesh& mesh) {
  const std::string text = text_of(file);
  Lines lines(text);
  std::string_view line;
  bool inside = false;
  while (lines.next(line)) {
    if (!inside) {
      inside = trimmed(line).starts_with("2C");
      continue;
    }
    if (line.starts_with(" -3")) return;
    const auto fault = [&] {
      throw InputError(fmt::format("{}:{}: need ' -1', a node's number and three coordinates in columns of 10 and 12",
                                   file.string(), lines.number()));
    };
    if (!line.starts_with(" -1") || line.size() < 49) fault();
    const auto number = number_of<long>(line.substr(3, 10));
    Vector3 X;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto x = number_of<double>(line.substr(13 + 12 * i, 12));
      if (!number || !x) fault();
      X[static_cast<Eigen::Index>(i)] = *x;
    }
    mesh.nodes.emplace(*number, X);
  }
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& file) {
  Mesh mesh;
  if (capitals(file.extension().string()) == ".FRD") {
    read_result_file(file, mesh);
  } else {
    DeckReader(mesh).read(file, 0);
  }
  if (mesh.nodes.empty()) throw InputError(file.string() + ": there are no nodes in it");
  for (auto& [name, set] : mesh.sets) {
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }
  return mesh;
}

std::vector<long> nodes_of(const Mesh& mesh, const std::string& text) {
  std::vector<long> numbers;
  if (const auto set = mesh.sets.find(capitals(text)); set != mesh.sets.end()) {
    numbers = set->second;
  } else {
    for (const std::string_view field : split(text, ",")) {
      const auto number = number_of<long>(field);
      if (!number) {
        std::string known;
        for (const auto& [name, members] : mesh.sets) known += (known.empty() ? "" : ", ") + name;
        throw InputError(fmt::format("got nodes '{}'; need a node set or numbers separated by commas; sets: {}", text,
                                     known.empty() ? "none" : known));
      }
      numbers.push_back(*number);
    }
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  if (numbers.empty()) throw InputError(fmt::format("got nodes '{}': there are none in it", text));
  for (const long n : numbers) {
    if (!mesh.nodes.contains(n)) throw InputError(fmt::format("got nodes '{}': the mesh has no node {}", text, n));
  }
  return numbers;
}

}  // namespace withy::fem
