/// \file
/// Pictures as files, by the ending of their name.
#pragma once

#include <filesystem>
#include <string_view>

namespace withy {

/// Writes a picture that is SVG: as it is to a name that ends in .svg; drawn with two pixels for each of its units, on
/// white, to one that ends in .png, by the program rsvg-convert of librsvg. Whole or not at all.
/// \throws study::InputError where the name ends otherwise; std::runtime_error where rsvg-convert is not installed or
/// fails, std::system_error where a file cannot be written
void write_picture(const std::filesystem::path& file, std::string_view svg);

}  // namespace withy
