/// \file
/// Precompiled for the core and the plugins: see cmake/WithyBuildTime.cmake.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "eigen_instances.hpp"
#include "withy/core/model/model.hpp"
#include "withy/core/plugin/entry.hpp"
