/// \file
/// Precompiled for the scene reader and the commands: see cmake/WithyBuildTime.cmake.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eigen_instances.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/simulation/simulate.hpp"
#include "withy/scene/scene.hpp"
