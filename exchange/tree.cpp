#include "tree.hpp"

#include <fmt/format.h>

#include <cctype>
#include <set>
#include <type_traits>

#include "withy/scene/names.hpp"

namespace withy::exchange {
namespace {

/// The name with `_` for what a scene's names may not have.
std::string scene_name(const std::string& name) {
  std::string made = name.substr(0, 64);
  for (char& c : made)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
  if (made.empty() || (std::isalpha(static_cast<unsigned char>(made.front())) == 0 && made.front() != '_'))
    made = '_' + made.substr(0, 63);
  // YAML reads these as no text.
  for (const char* other : {"null", "Null", "NULL", "true", "True", "TRUE", "false", "False", "FALSE"})
    if (made == other) return '_' + made;
  return name == "world" ? "_world" : made;
}

/// The name, or with a number at its end where it is taken already.
std::string distinct(const std::string& name, const std::set<std::string>& taken) {
  std::string made = name;
  for (int number = 2; taken.contains(made); ++number) {
    const std::string end = fmt::format("_{}", number);
    made = name.substr(0, 64 - end.size()) + end;
  }
  return made;
}

/// Names that scenes may have stay; others become such, each another.
template <class Part>
void name_parts(std::vector<Part>& parts, const char* what, Tree& tree, Diagnostics& diagnostics) {
  const auto made_of = [](const Part& part) {
    std::string made = scene_name(part.name);
    if constexpr (std::is_same_v<Part, Joint>)
      if (is_column_of_all(made)) made.insert(0, "_");
    return made;
  };
  std::set<std::string> own, taken;
  for (const Part& part : parts) {
    if (!own.insert(part.name).second)
      diagnostics.error(part.place,
                        fmt::format("a second {} of the name {}; need names of their own", what, in_quotes(part.name)));
    if (made_of(part) == part.name) taken.insert(part.name);
  }
  for (Part& part : parts) {
    std::string made = made_of(part);
    if (made == part.name) continue;
    made = distinct(made, taken);
    taken.insert(made);
    tree.remarks.push_back(fmt::format("{} {} is called {} here", what, in_quotes(part.name), made));
    part.name = std::move(made);
  }
}

/// Whether a link resists any motion: a wheel may have an inertia alone.
bool resists(const Link& link) { return link.mass > 0 || !link.inertia.isZero(0); }

/// Joints that move on the rigid part that a link is of, without the one that holds it; `solid` becomes true where that
/// part has mass or inertia.
std::vector<const Joint*> moving_on(const Tree& tree, int link, bool& solid) {
  solid = solid || resists(tree.links[static_cast<std::size_t>(link)]);
  std::vector<const Joint*> all;
  for (const Joint& joint : tree.joints) {
    if (joint.parent != link) continue;
    const auto more = joint.type == "weld" ? moving_on(tree, joint.child, solid) : std::vector<const Joint*>{&joint};
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

/// A free part without mass and inertia and with a single joint on it: the part can go back as far as the joint goes
/// forth, and nothing that has mass moves.
void check_free(const Tree& tree, Diagnostics& diagnostics) {
  for (const Joint& joint : tree.joints) {
    if (joint.type != "free") continue;
    bool solid = false;
    const auto on_it = moving_on(tree, joint.child, solid);
    if (!solid && on_it.size() == 1)
      diagnostics.error(
          tree.links[static_cast<std::size_t>(joint.child)].place,
          fmt::format("the link floats by the joint {}, has no mass and no inertia, and only the joint {} moves on "
                      "it: its acceleration would be undefined; give it an inertia, or fix a joint",
                      in_quotes(joint.name), in_quotes(on_it.front()->name)));
  }
}

}  // namespace

void check_tree(Tree& tree, Diagnostics& diagnostics) {
  name_parts(tree.links, "link", tree, diagnostics);
  name_parts(tree.joints, "joint", tree, diagnostics);
  // Of each joint, whether anything beyond it has mass or inertia: else the mass matrix is singular.
  std::vector<bool> beyond(tree.links.size());
  for (std::size_t i = 0; i < tree.links.size(); ++i) beyond[i] = resists(tree.links[i]);
  // Joints may stand in any order: as many passes as the tree is deep.
  std::vector<int> parent(tree.links.size(), -1);
  for (const Joint& joint : tree.joints) parent[static_cast<std::size_t>(joint.child)] = joint.parent;
  for (std::size_t i = 0; i < tree.links.size(); ++i)
    for (int above = parent[i]; above >= 0; above = parent[static_cast<std::size_t>(above)])
      if (resists(tree.links[i])) beyond[static_cast<std::size_t>(above)] = true;
  for (const Joint& joint : tree.joints) {
    const Link& child = tree.links[static_cast<std::size_t>(joint.child)];
    if (joint.type != "weld" && !beyond[static_cast<std::size_t>(joint.child)])
      diagnostics.error(
          child.place,
          fmt::format("the link moves by the joint {}, and neither it nor what hangs on it has mass or inertia: its "
                      "acceleration would be undefined; give it an inertia, or fix the joint",
                      in_quotes(joint.name)));
  }
  if (diagnostics.ok()) check_free(tree, diagnostics);
}

}  // namespace withy::exchange
