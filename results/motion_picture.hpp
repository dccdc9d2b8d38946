/// \file
/// A moving picture of several runs of one scene.
#pragma once

#include <string>

#include "withy/study/comparison.hpp"

namespace withy {

/// As SVG that moves (SMIL): the tree in every listed run, over each other, in the plane it takes up most of, again and
/// again; the way of the last tip behind it. A run that stopped stays where it did, marked with a cross. The picture
/// takes between 8 and 20 s and says how much slower or faster than the motion that is. It opens in browsers and shows
/// as an image in pages and documents; where nothing moves it stands at the end of the motion.
std::string motion_picture(const std::string& title, const study::Comparison& comparison);

}  // namespace withy
