// Bodies in the light of the sea (objects[].file) as Wavefront OBJ, with their materials in MTL files.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pelagic/object_mesh.h"
#include "plugin/format/obj/obj.h"

namespace pelagic {

inline constexpr std::size_t kMostObjectBytes = std::size_t{1} << 30;  // some ten million triangles
inline constexpr std::size_t kMostMaterialBytes = std::size_t{16} << 20;

// The text of a file that the OBJ names, from its folder; none: there is no such file that can be read.
using MaterialText = std::function<std::optional<std::string>(const std::string& file)>;

// What is wrong with a picture: the ends of a sentence about it.
struct PictureRefused {
    std::string problem, accepted;
};
// The picture that an MTL file names, from the OBJ's folder, of at most so many texels. Throws PictureRefused.
using MaterialPicture =
    std::function<std::shared_ptr<const ObjectImage>(const std::string& file, std::size_t most_texels)>;

// The body that a file's text describes; z up, metres. `name`: as messages call the file. Numbers and lines as parse_obj() has them.
//
//   v x y z             points; a weight of 1 or a colour may follow, and is passed over
//   vn x y z            normals of corners, of any length; one without a length counts as none
//   vt u v              places in pictures, (0, 0) their lower left corner and (1, 1) their upper right one; they repeat
//   f v v v …           faces of up to 1000 corners, v, v/vt, v//vn or v/vt/vn, counter-clockwise seen from outside. Those of more than
//                       three are cut into triangles (by ears; they may be concave, and are best flat); those without an area are left out
//   s n, s off          of the faces below. Where corners have no normal, faces of one group are smooth where they meet at less than 50°;
//                       with "s off" none is, without any s all are one group
//   mtllib, usemtl      materials: Kd (linear Rec. 709, as Blender writes it), Ke, Pr, or Ns as Blender writes it: roughness
//                       1 − √(Ns/1000). The brightest number of the file's Ke becomes 1 if it is more. map_Kd: a picture in place
//                       of Kd, with its options -s and -o; the others are passed over, and no picture cuts anything out
//   o g l p and others  passed over
//
// Notes of the mesh say what was passed over though it would be seen: materials that aren't there (they are grey), pictures of
// anything but the colour, transparency. Throws ObjError for anything else: lines of none of these kinds, curved surfaces, numbers that aren't finite, more than
// limits.h has, and a body without area.
ObjectMesh parse_object_obj(std::string_view text, const std::string& name, const MaterialText& material_text,
                            const MaterialPicture& picture);

}  // namespace pelagic
