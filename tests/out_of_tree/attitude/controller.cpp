// The attitude loop in C++: the controller of docs/attitude-loop.md about a simulation that it steps.
#include <array>
#include <cstdio>
#include <string>
#include <withy/withy.hpp>

namespace {

constexpr double step = 0.125;  // s: a power of two, so that every door counts the same times
constexpr double proportional = 4.0, integral = 0.2, derivative = 22.0;

/// From attitude and rate of the bus to the torques of the motors, axis by axis.
class Controller {
 public:
  double command(std::size_t axis, double q_scalar, double q_axis, double rate) {
    const double error = q_scalar < 0 ? -2 * q_axis : 2 * q_axis;  // rad, for small angles
    learned_[axis] += integral * step * error;
    return proportional * error + learned_[axis] + derivative * rate;
  }

 private:
  std::array<double, 3> learned_{};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const withy::host::Library library;
    withy::host::Simulation craft(withy::host::Scene::read(library, argv[1]));
    std::array<std::size_t, 3> motor{}, q{}, rate{};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string axis(1, "xyz"[i]);
      motor[i] = craft.input_index("motor_" + axis);
      q[i] = craft.output_index("float.q" + axis);
      rate[i] = craft.output_index("gyro." + axis);
    }
    const std::size_t scalar = craft.output_index("float.qw"), tip = craft.output_index("left_boom.tip.deflection_y");
    Controller controller;
    std::printf("t,qw,qx,qy,qz,tip\n");
    for (int k = 1; k <= 960; ++k) {
      std::array<double, 3> command{};
      for (std::size_t i = 0; i < 3; ++i)
        command[i] = controller.command(i, craft.output(scalar), craft.output(q[i]), craft.output(rate[i]));
      for (std::size_t i = 0; i < 3; ++i) craft.set_input(motor[i], command[i]);
      craft.step(step * k);
      std::printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", craft.time(), craft.output(scalar), craft.output(q[0]),
                  craft.output(q[1]), craft.output(q[2]), craft.output(tip));
    }
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
