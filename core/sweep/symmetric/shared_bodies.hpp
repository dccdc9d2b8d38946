/// \file
/// Equal constants of the nodes of a symmetric sweep become one, which stays in the nearest caches.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "withy/core/sweep/symmetric/symmetric_sweep.hpp"

namespace withy::sweep {

/// Rigid parts of the nodes, equal ones once.
template <class Space>
class RigidParts {
 public:
  void share(SharedValue<RigidPart<Space>>& part) {
    if (part.empty()) return;
    std::string key;  // member by member: between them there may be bytes of no meaning
    append(key, part->inertia);
    append(key, part->mass);
    append(key, part->moment);
    part = parts_.try_emplace(std::move(key), part).first->second;
  }

 private:
  template <class T>
  static void append(std::string& key, const T& value) {
    key.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  std::unordered_map<std::string, SharedValue<RigidPart<Space>>> parts_;
};

/// Whether two numbers or arrays of them have the same bits.
template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(static_cast<const void*>(&a), static_cast<const void*>(&b), sizeof(T)) == 0;
}
template <class T>
bool same_bits(const SharedValue<T>& a, const SharedValue<T>& b) {
  return a.empty() || b.empty() ? a.empty() == b.empty() : same_bits(*a, *b);
}
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const T& x, const T& y) { return same_bits(x, y); });
}

/// Whether two are one object already; equal numbers of twins are.
template <class T>
bool same_object(const SharedNumbers<T>& a, const SharedNumbers<T>& b) {
  return a.data() == b.data();
}
template <class T>
bool same_object(const SharedValue<T>& a, const SharedValue<T>& b) {
  return a.empty() || b.empty() ? a.empty() == b.empty() : &*a == &*b;
}

template <class Space>
bool same(const SymmetricStation<Space>& a, const SymmetricStation<Space>& b) {
  return same_bits(a.fields.X, b.fields.X) && same_object(a.fields.first, b.fields.first) &&
         same_object(a.fields.second, b.fields.second) && a.loaded == b.loaded && a.has_children == b.has_children &&
         a.work_I == b.work_I && same_object(a.J, b.J) && same_object(a.carried, b.carried);
}

/// Whether two nodes may have one body. One that is not seen to be the same costs memory, no more.
template <class Space>
bool same(const SymmetricBody<Space>& a, const SymmetricBody<Space>& b) {
  return same_object(a.base, b.base) && same_object(a.stiffness, b.stiffness) && same_object(a.damping, b.damping) &&
         same_object(a.C0, b.C0) && same_object(a.G0, b.G0) && same_object(a.I1, b.I1) &&
         same_object(a.mass.data, b.mass.data) && a.mass.root_mass == b.mass.root_mass &&
         same_object(a.rotary.axes, b.rotary.axes) && same_object(a.rotary.fields, b.rotary.fields) &&
         same_object(a.rod, b.rod) && same_bits(a.factor, b.factor) && same_bits(a.Y0, b.Y0) &&
         same_bits(a.reduced, b.reduced) && same_bits(a.M, b.M) &&
         std::equal(a.stations.begin(), a.stations.end(), b.stations.begin(), b.stations.end(),
                    [](const auto& s, const auto& t) { return same(s, t); });
}

/// Lets nodes of the same body share it; once all have their children, and their places in the work memory.
template <class Space>
void share_bodies(std::vector<SymmetricNode<Space>>& nodes) {
  using Body = SharedValue<SymmetricBody<Space>>;
  std::unordered_map<const void*, std::vector<Body>> known;  // by their rigid part
  for (SymmetricNode<Space>& node : nodes) {
    std::vector<Body>& candidates = known[&*node.own->base];
    const auto found =
        std::find_if(candidates.begin(), candidates.end(), [&](const Body& b) { return same(*b, *node.own); });
    if (found != candidates.end()) {
      node.own = *found;
    } else {
      candidates.push_back(node.own);
    }
  }
}

}  // namespace withy::sweep
