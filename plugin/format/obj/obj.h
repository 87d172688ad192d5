// Cages as Wavefront OBJ, with the tags for sharpness of OpenSubdiv's regression shapes.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "pelagic/cage.h"

namespace pelagic {

inline constexpr std::size_t kMostObjBytes = std::size_t{256} << 20;  // 1e6 faces take some 100 MiB

// What is wrong with a file, at which line of it, and what would be right.
class ObjError : public std::runtime_error {
  public:
    ObjError(std::string problem, std::string accepted)
        : std::runtime_error(problem + "; accepted: " + accepted),
          problem_(std::move(problem)),
          accepted_(std::move(accepted)) {}
    const std::string& problem() const { return problem_; }  // "pool.obj:12: the face has two corners"
    const std::string& accepted() const { return accepted_; }

  private:
    std::string problem_, accepted_;
};

// The cage that a file's text describes; z up, metres. `name`: as messages call the file. Numbers are read as in C,
// whatever the locale; a line that ends with \ goes on in the next.
//
//   v x y z                    points; a weight of 1 or a colour may follow, and is passed over
//   vt u v                     texture coordinates, for all corners or for none
//   f v v v …                  faces, of corners v, v/vt, v//vn or v/vt/vn, from 1 on, or from −1 backwards
//   t crease 2/1/0 v v s       sharpness of edges (pairs of points; one s, or one each); here and below from 0 on
//   t corner 1/1/0 v s         of points (one s, or one each)
//   t hole 1/0/0 f             faces that are left out
//   t interpolateboundary 1/0/0 n    0 none, 1 edge and corner (as without the tag), 2 edge only
//   o g s l p vn usemtl mtllib #     passed over
//
// Throws ObjError for anything else, for a number that isn't finite, and for what Cage refuses.
Cage parse_obj(std::string_view text, const std::string& name);

}  // namespace pelagic
