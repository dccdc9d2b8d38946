#include "withy/program/log.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <memory>

namespace withy::program {
namespace {

spdlog::logger standard_error() {
  spdlog::logger logger("withy", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger.set_pattern("%T.%e %v");
  return logger;
}

}  // namespace

void log(std::string_view line) {
  static spdlog::logger logger = standard_error();
  logger.info(line);
}

}  // namespace withy::program
