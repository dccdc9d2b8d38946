#include "withy/core/simulation/diagnosis.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace withy {
namespace {

std::string sign_text(int sign) { return sign > 0 ? "positive" : (sign < 0 ? "negative" : "zero"); }

/// "97 % modes of 'link2', most of all link2.bending_y[2]"
std::string weakest_direction(const Layout& layout, const std::vector<double>& direction) {
  double greatest = -1;
  std::string owner;
  const auto weigh = [&](const std::vector<Slot>& slots, const std::string& what) {
    for (const Slot& slot : slots) {
      double share = 0;
      for (std::size_t i = slot.speed; i < slot.speed + slot.speeds; ++i) share += direction[i] * direction[i];
      if (share <= greatest) continue;
      greatest = share;
      owner = what + " '" + slot.name + "'";
    }
  };
  weigh(layout.bodies, "modes of");
  weigh(layout.hinges, "hinge");
  const auto most = std::max_element(direction.begin(), direction.end(),
                                     [](double a, double b) { return std::abs(a) < std::abs(b); });
  return brief(std::round(100 * greatest)) + " % " + owner + ", most of all " +
         layout.speed_names[static_cast<std::size_t>(most - direction.begin())];
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Loads that give an effort that is not finite, with the first such time found.
std::string nonfinite_loads(const Model& model, const State& state, double ahead) {
  const Layout& layout = model.layout();
  const std::span<const double> y(state.y);
  std::string text;
  for (const LoadNode& node : model.loads()) {
    std::vector<double> scratch(node.load->scratch());
    std::vector<double> efforts(layout.speeds);
    // From just after the state on, at intervals that double: a load may fail from some time on.
    for (double after = 0; after <= ahead; after = after > 0 ? 2 * after : ahead * 0x1p-30) {
      std::fill(efforts.begin(), efforts.end(), 0.0);
      node.load->add(state.time + after, y.first(layout.positions), y.subspan(layout.positions, layout.speeds), efforts,
                     scratch);
      const auto bad = std::find_if(efforts.begin(), efforts.end(), [](double e) { return !std::isfinite(e); });
      if (bad != efforts.end()) {
        text += (text.empty() ? "" : "; ") + ("load '" + node.name + "' gives " + brief(*bad) + " on ") +
                layout.speed_names[static_cast<std::size_t>(bad - efforts.begin())] +
                " at t = " + brief(state.time + after) + " s";
        break;
      }
      if (!(ahead > 0)) break;
    }
  }
  return text;
}

}  // namespace

std::string brief(double x) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::general, 4);
  return {text, end.ptr};
}

bool lost_definiteness(const Conditioning& start, const Conditioning& end, const std::optional<SignChange>& change) {
  return change.has_value() || end.determinant_sign != start.determinant_sign ||
         (start.smallest_eigenvalue > 0 && end.smallest_eigenvalue <= 0);
}

std::string describe_mass_matrix(const Layout& layout, const Conditioning& start, const Conditioning& end,
                                 const std::optional<SignChange>& change) {
  if (end.weakest.empty())
    return layout.speeds == 0 ? "There is nothing that moves." : "The mass matrix is not finite.";
  std::string text;
  if (change) {
    text = "The mass matrix became singular on the way and then indefinite: det M changed sign between t = " +
           brief(change->before) + " and " + brief(change->after) + " s";
  } else if (lost_definiteness(start, end, change)) {
    text = "The mass matrix lost its definiteness on the way: det M is " + sign_text(end.determinant_sign) +
           ", at the start it was " + sign_text(start.determinant_sign);
  } else {
    text = "The mass matrix is " + std::string(end.smallest_eigenvalue > 0 ? "still positive definite" : "indefinite") +
           ": det M is " + sign_text(end.determinant_sign);
  }
  return text + ". Condition of M " + brief(end.condition) + " (at the start " + brief(start.condition) +
         "), smallest eigenvalue of its symmetric part " + brief(end.smallest_eigenvalue) + " (" +
         brief(start.smallest_eigenvalue) + "); the direction of least mass is " +
         weakest_direction(layout, end.weakest) + ".";
}

std::string describe_nonfinite(const Model& model, const EquationsOfMotion& equations, const State& state,
                               double ahead) {
  if (const std::string loads = nonfinite_loads(model, state, ahead); !loads.empty()) return loads;
  const Layout& layout = equations.layout();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < layout.speeds; ++i) {
    if (!std::isfinite(state.y[layout.positions + i])) names.push_back(layout.speed_names[i]);
  }
  if (!names.empty()) return "the speeds " + joined(names) + " are not finite";
  Work work = equations.make_work();
  std::vector<double> y_dot(state.y.size());
  const Evaluation e = equations.derivatives(state.time, state.y, y_dot, work);
  if (e.outcome == Evaluation::Outcome::singular) return {};
  for (std::size_t i = 0; i < layout.speeds; ++i) {
    if (!std::isfinite(y_dot[layout.positions + i])) names.push_back(layout.speed_names[i]);
  }
  if (!names.empty()) return "the accelerations of " + joined(names) + " are not finite";
  return {};
}

}  // namespace withy
