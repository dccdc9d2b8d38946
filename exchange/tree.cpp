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
  return name == "world" ? "_world" : made;
}

template <class Part>
void name_parts(std::vector<Part>& parts, const char* what, Tree& tree, Diagnostics& diagnostics) {
  std::set<std::string> taken;
  for (Part& part : parts) {
    std::string made = scene_name(part.name);
    if constexpr (std::is_same_v<Part, Joint>)
      if (is_column_of_all(made)) made.insert(0, "_");
    if (made != part.name)
      tree.remarks.push_back(fmt::format("{} {} is called {} here", what, in_quotes(part.name), made));
    part.name = made;
    if (!taken.insert(made).second)
      diagnostics.error(part.place,
                        fmt::format("a second {} of the name {}; need names of their own", what, in_quotes(made)));
  }
}

/// Joints that move on the rigid part that a link is of, without the one that holds it; `mass` grows by that part's.
std::vector<const Joint*> moving_on(const Tree& tree, int link, double& mass) {
  mass += tree.links[static_cast<std::size_t>(link)].mass;
  std::vector<const Joint*> all;
  for (const Joint& joint : tree.joints) {
    if (joint.parent != link) continue;
    const auto more = joint.type == "weld" ? moving_on(tree, joint.child, mass) : std::vector<const Joint*>{&joint};
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

/// A free part without mass and with a single joint on it: the part can go back as far as the joint goes forth, and
/// nothing that has mass moves.
void check_free(const Tree& tree, Diagnostics& diagnostics) {
  for (const Joint& joint : tree.joints) {
    if (joint.type != "free") continue;
    double mass = 0;
    const auto on_it = moving_on(tree, joint.child, mass);
    if (mass == 0 && on_it.size() == 1)
      diagnostics.error(tree.links[static_cast<std::size_t>(joint.child)].place,
                        fmt::format("the link floats by the joint {}, carries no mass, and only the joint {} moves on "
                                    "it: its acceleration would be undefined; give it an inertia, or fix a joint",
                                    in_quotes(joint.name), in_quotes(on_it.front()->name)));
  }
}

}  // namespace

void check_tree(Tree& tree, Diagnostics& diagnostics) {
  name_parts(tree.links, "link", tree, diagnostics);
  name_parts(tree.joints, "joint", tree, diagnostics);
  // Mass beyond each joint: a leaf that moves without any would make the mass matrix singular.
  std::vector<double> beyond(tree.links.size());
  for (std::size_t i = 0; i < tree.links.size(); ++i) beyond[i] = tree.links[i].mass;
  // Joints may stand in any order: as many passes as the tree is deep.
  std::vector<int> parent(tree.links.size(), -1);
  for (const Joint& joint : tree.joints) parent[static_cast<std::size_t>(joint.child)] = joint.parent;
  for (std::size_t i = 0; i < tree.links.size(); ++i)
    for (int above = parent[i]; above >= 0; above = parent[static_cast<std::size_t>(above)])
      beyond[static_cast<std::size_t>(above)] += tree.links[i].mass;
  for (const Joint& joint : tree.joints) {
    const Link& child = tree.links[static_cast<std::size_t>(joint.child)];
    if (joint.type != "weld" && beyond[static_cast<std::size_t>(joint.child)] == 0)
      diagnostics.error(
          child.place,
          fmt::format("the link moves by the joint {} and carries no mass: its acceleration would be undefined; "
                      "give it an inertia, or fix the joint",
                      in_quotes(joint.name)));
  }
  if (diagnostics.ok()) check_free(tree, diagnostics);
}

}  // namespace withy::exchange
