/// \file
/// Files of a finite-element program to a modal body: what `withy import` does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "withy/bodies/modal/sid_body.hpp"
#include "withy/fem/reduce.hpp"
#include "withy/fem/summary.hpp"
#include "withy/fem/surface.hpp"

namespace withy::fem {

/// Which files, and what to reduce them to.
struct ImportJob {
  std::string job;                      ///< of CalculiX: the files' name without extension
  std::string mesh;                     ///< input deck or result file; empty: that of the job
  std::string stiffness;                ///< of Abaqus; empty: the job's
  std::string mass_matrix;              ///< the same
  std::string root;                     ///< clamped nodes: node set or numbers
  std::vector<std::string> interfaces;  ///< rigid sections with static modes: a set, a node, or name=17,18,19
  std::vector<std::string> stations;    ///< nodes without modes of their own
  int modes = 10;                       ///< fixed-interface modes
  double highest = 0;                   ///< [Hz], modes above it are dropped; 0: none
};

/// Whether the geometric stiffness is known.
struct SecondOrder {
  double imbalance = 0;  ///< of stresses and unit loads, relative
  std::string lacking;   ///< why it is not known; empty where it is
};

/// How the body is drawn.
struct Drawn {
  std::string text;     ///< of the file, see surface_text; empty where the faces are not known
  std::string lacking;  ///< why it is not known, or what of it is not drawn; empty where all is
  std::size_t vertices = 0, faces = 0;
};

struct Imported {
  Reduction body;
  Summary summary;
  sid::Data data;     ///< what is written
  SidReport as_body;  ///< what the modal body makes of it
  SecondOrder second_order;
  Drawn drawn;
};

/// \throws InputError, std::domain_error where the files do not describe a body that can be reduced.
Imported import(const ImportJob& job);
/// The files that it reads. \throws InputError as above
std::vector<std::filesystem::path> files_read(const ImportJob& job);

}  // namespace withy::fem
