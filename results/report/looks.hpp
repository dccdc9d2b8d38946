/// \file
/// What bodies look like in pictures: what the scene says under `visual`, and sections of beams.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "withy/core/model/model.hpp"
#include "withy/results/report/solids.hpp"
#include "withy/scene/mesh_file.hpp"
#include "withy/scene/scene.hpp"

namespace withy {

/// Of the bodies of a scene; one made of nothing knows none. Copies share what they know.
class Looks {
 public:
  Looks() = default;
  /// Reads the meshes that the scene names; the scene must outlive it. \throws std::domain_error where one has changed
  /// since the scene was checked
  explicit Looks(const Scene& scene);

  /// The surface that a rigid body is given [m, body axes]; null where it is given none.
  [[nodiscard]] const Surface* surface(const std::string& body) const;
  /// The outer faces of a body of modes, with their shapes; null where it is given none.
  [[nodiscard]] const ModeSurface* mode_surface(const std::string& body) const;
  /// Sections of a beam at the places x [m] from its root: as `visual` says, else the ellipse with the section's radii
  /// of gyration, see equivalent_section. Empty for what is no beam.
  [[nodiscard]] std::vector<Outline> sections(const BodyNode& node, const std::vector<double>& x) const;
  /// Of a plate [m]: as `visual` says, else see equivalent_thickness. 0 for what is no plate.
  [[nodiscard]] double thickness(const std::string& name) const;

 private:
  struct Known {
    std::unordered_map<std::string_view, const Value*> bodies;  ///< as checked
    std::map<std::string, Surface> surfaces;
    std::map<std::string, ModeSurface> mode_surfaces;
  };
  [[nodiscard]] const Value* body(const std::string& name) const;

  std::shared_ptr<const Known> known_ = std::make_shared<const Known>();
};

/// The solid ellipse that stands for a beam's section at x [m]: its half axes are twice the radii of gyration i_z, i_y.
/// Those follow, as far as the beam says so, from ρI/(ρA), from EI/EA, or from ρI_p/(ρA) = i_y² + i_z²; else from
/// i² = (EI/ρA)/(E/ρ) with the E/ρ of steel, aluminium and titanium alike, 2.6e7 m²/s². At most a tenth of its length.
Outline equivalent_section(const Value& beam, double x);

/// The thickness [m] that a solid plate of metal has with its D and its mass per area: h² = 12 (1 − ν²) (D/m)/(E/ρ). At
/// most a tenth of its shorter edge.
double equivalent_thickness(const Value& plate);

}  // namespace withy
