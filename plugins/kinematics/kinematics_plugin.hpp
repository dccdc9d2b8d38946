/// \file
/// What the strain kinematics of this folder share.
#pragma once

#include "withy/core/plugin/registry.hpp"
#include "withy/core/plugin/strain_kinematics.hpp"

namespace withy {

/// A strain kinematics without options.
template <class Kinematics>
Plugin<StrainKinematics> kinematics_plugin(const char* id, const char* summary) {
  return {.id = id,
          .summary = summary,
          .parameters = {},
          .make = [](const Value& /*parameters*/, const MakeContext& /*context*/) -> std::unique_ptr<StrainKinematics> {
            return std::make_unique<Kinematics>();
          }};
}

Plugin<StrainKinematics> linear_kinematics();
Plugin<StrainKinematics> quadratic_kinematics();
Plugin<StrainKinematics> exact_kinematics();
Plugin<StrainKinematics> foreshortening_kinematics();

}  // namespace withy
