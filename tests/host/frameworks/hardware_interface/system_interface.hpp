// What the hardware of docs/recipes.md takes of ROS 2 control, declared as its interface is.
#pragma once
#include <cstdio>
#include <string>
#include <unordered_map>
#include <vector>

namespace rclcpp {
class Time {};
class Duration {
 public:
  double seconds() const;
};
class Logger {};
Logger get_logger(const std::string& name);
}  // namespace rclcpp
#define RCLCPP_ERROR(logger, ...) (static_cast<void>(logger), std::printf(__VA_ARGS__))

namespace hardware_interface {
enum class return_type { OK, ERROR };
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
struct ComponentInfo {
  std::string name;
};
struct HardwareInfo {
  std::unordered_map<std::string, std::string> hardware_parameters;
  std::vector<ComponentInfo> joints;
};
class Handle {
 public:
  Handle(const std::string& joint, const std::string& interface, double* value);
};
class StateInterface : public Handle {
  using Handle::Handle;
};
class CommandInterface : public Handle {
  using Handle::Handle;
};
class SystemInterface {
 public:
  using CallbackReturn = hardware_interface::CallbackReturn;
  virtual ~SystemInterface() = default;
  virtual CallbackReturn on_init(const HardwareInfo& info);
  virtual std::vector<StateInterface> export_state_interfaces() = 0;
  virtual std::vector<CommandInterface> export_command_interfaces() = 0;
  virtual return_type read(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;
  virtual return_type write(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;

 protected:
  HardwareInfo info_;
};
}  // namespace hardware_interface
