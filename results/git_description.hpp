/// \file
/// What git calls the commit this is built from; its source is written by cmake/GitDescription.cmake.
#pragma once

namespace withy {

extern const char* const git_description;  ///< empty where it was not built from a repository

}  // namespace withy
