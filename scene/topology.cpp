#include "withy/scene/topology.hpp"

#include <fmt/format.h>

#include "withy/scene/names.hpp"

namespace withy {
namespace {

using Inboard = std::vector<const Link*>;

bool report_cycles(const Inboard& inboard, const Checker& checker) {
  const std::size_t n = inboard.size();
  std::vector<std::size_t> visited(n, 0);  // number of the walk that came by, 0: none
  bool good = true;
  for (std::size_t start = 0; start < n; ++start) {
    std::size_t b = start;
    while (visited[b] == 0 && inboard[b] != nullptr && inboard[b]->parent >= 0) {
      visited[b] = start + 1;
      b = static_cast<std::size_t>(inboard[b]->parent);
    }
    if (visited[b] == 0) visited[b] = n + 1;
    if (visited[b] != start + 1) continue;
    std::vector<std::string> names;
    std::size_t at = b;
    do {
      names.push_back(inboard[at]->name);
      at = static_cast<std::size_t>(inboard[at]->parent);
    } while (at != b);
    checker.key_error("/hinges/" + inboard[b]->name,
                      names.size() == 1
                          ? fmt::format("the hinge {} hangs a body on itself; its parent is another body, or the world",
                                        names.front())
                          : fmt::format("the hinges {} make a ring that does not hang on the world; let one of their "
                                        "parents be world, and close the ring with constraints",
                                        listed(names)));
    good = false;
  }
  return good;
}

}  // namespace

bool check_topology(const std::vector<std::string>& bodies, const std::vector<Link>& links, const Checker& checker) {
  Inboard inboard(bodies.size(), nullptr);
  bool links_complete = true;
  bool good = true;
  for (const Link& link : links) {
    if (link.child == -2) links_complete = false;
    if (link.child < 0) continue;
    const auto child = static_cast<std::size_t>(link.child);
    if (inboard[child] == nullptr) {
      inboard[child] = &link;
      continue;
    }
    checker.diagnostics().error(link.child_place,
                                fmt::format("body '{}' is the child of hinge '{}' already; each body of a tree has one",
                                            bodies[child], inboard[child]->name));
    good = false;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    // A hinge whose child is wrong may have been meant for this body: one message is enough.
    if (inboard[b] != nullptr || !links_complete) continue;
    checker.key_error("/bodies/" + bodies[b],
                      "no hinge has this body as its child; each body hangs on one (type free for one that floats)");
    good = false;
  }
  return report_cycles(inboard, checker) && good;
}

}  // namespace withy
