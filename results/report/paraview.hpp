/// \file
/// Motions as files that ParaView and other programs of VTK read.
#pragma once

#include <filesystem>
#include <vector>

#include "withy/results/report/animation.hpp"

namespace withy {

/// Writes a series, FILE.pvd, and beside it a folder of its name with an unstructured grid (.vtu) for each moment of
/// each run: the surfaces of all bodies in the world [m]; of each point its `displacement` from where it would be on
/// the undeformed body [m, world axes], of each cell the number of its `body`. What the folder held of an earlier
/// series is removed. \throws std::system_error
void write_paraview(const std::filesystem::path& file, const std::vector<Animation>& runs);

}  // namespace withy
