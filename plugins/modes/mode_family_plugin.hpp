/// \file
/// What the mode families of this folder share that need no options: a family is its functions in bending and those of
/// a rod, in torsion or elongation.
#pragma once

#include "withy/core/plugin/mode_family.hpp"
#include "withy/core/plugin/registry.hpp"

namespace withy {

/// Makes the first `count` functions of a beam's strain.
using MakeFunctions = std::unique_ptr<ShapeFunctions> (*)(const BeamData& beam, std::size_t count);

/// For a family without functions for a strain.
inline std::unique_ptr<ShapeFunctions> no_functions(const BeamData& /*beam*/, std::size_t /*count*/) { return nullptr; }

/// A family that depends on the beam alone.
template <MakeFunctions bending, MakeFunctions rod, std::size_t most_functions, bool cantilevers>
class PlainFamily final : public ModeFamily {
 public:
  std::size_t most() const override { return most_functions; }
  bool spans_cantilevers() const override { return cantilevers; }
  std::unique_ptr<ShapeFunctions> functions(const BeamData& beam, std::size_t count) const override {
    return (beam.strain == BeamData::Strain::bending ? bending : rod)(beam, count);
  }
};

/// `cantilevers` as ModeFamily::spans_cantilevers.
template <MakeFunctions bending, MakeFunctions torsion, std::size_t most_functions = 200, bool cantilevers = false>
void enroll_family(Enrollment& enrollment, const char* id, const char* summary) {
  enrollment.add<ModeFamily>(
      {.id = id,
       .summary = summary,
       .parameters = {},
       .make = [](const Value& /*parameters*/, const MakeContext& /*context*/) -> std::unique_ptr<ModeFamily> {
         return std::make_unique<PlainFamily<bending, torsion, most_functions, cantilevers>>();
       }});
}

}  // namespace withy
