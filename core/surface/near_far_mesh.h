// The topology of the mesh from near to far (near_far.h): how many points it has, and which of them make a face.
// It follows from two numbers and is the same wherever the camera is.
//
// A square of quads is surrounded by square rings of quads, each with cells twice as long as those inside it, and the
// last ring by a far part of rows that become circles. In terms of the binary tree of right triangles that halves each at
// its longest side (Duchaineau 1997, in Hu 2006, §3), a ring is two levels above the one inside it: two
// bisections halve a triangle's legs. Where depths differ, the tree's conforming triangulation splits the coarser cells
// towards the points of the finer ones; so does the band of triangles between two neighbours here.
//
// Each square is centred on the camera in steps of its own cells. The hole of a ring is wider than the square inside it
// by one to three of that one's cells on each side, as the steps fall. The band between them joins the two borders,
// which stay parallel, so that its triangles keep their orientation and their area whatever the step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/surface/rest_surface.h"

namespace pelagic {

class NearFarMesh {
  public:
    // A square of cells, of which those in the middle are missing. All numbers are cells of its own.
    struct Level {
        int cells = 1;   // a side
        int hole = 0;    // a side of what is missing: none, in the near patch
        int width = 0;   // from the border to the hole
        int before = 0;  // from the border to the cell that the camera is over: left of it, and below it
        std::size_t first_point = 0;

        bool has_hole() const { return hole > 0; }
        std::size_t points() const;
        // x, y: 0 … cells, and not within the hole.
        std::size_t point(int x, int y) const;
        // Calls visit(x, y) for the points in their order: rows from the lowest, x fastest.
        template <class Visit>
        void for_each_point(Visit&& visit) const {
            for (int y = 0; y <= cells; ++y)
                for (int x = 0; x <= cells; ++x) {
                    if (x > width && y > width && y < width + hole && x < width + hole) x = width + hole;
                    visit(x, y);
                }
        }
        bool is_on_border(int x, int y) const { return x == 0 || y == 0 || x == cells || y == cells; }
    };

    // size_m, > 0: the side of the near patch; resolution, ≥ 1: its quads a side.
    NearFarMesh(double size_m, int resolution);

    // The near patch, and the rings from the innermost one outwards.
    const std::vector<Level>& levels() const { return levels_; }
    int rings() const { return static_cast<int>(levels_.size()) - 1; }
    // The far part: rows of columns, closed all round. The columns' azimuths are even and rise; the first is in the corner
    // below on the left, at −135°.
    int columns() const { return columns_; }
    int rows() const { return rows_; }
    std::size_t far_point(int row, int column) const {
        return first_far_ + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }
    std::size_t points() const { return far_point(rows_, 0); }
    std::size_t quads() const;
    std::size_t triangles() const;

    // Quads in squares and in the far part, triangles in bands. st is one to one with the mesh, laid out in concentric
    // squares of even width; it says nothing about lengths.
    void set_faces(Faces& faces) const;

  private:
    void add_quads(const Level& level, Faces& faces) const;
    void add_band(std::size_t level, Faces& faces) const;
    void set_st(Faces& faces) const;

    std::vector<Level> levels_;
    int columns_ = 0, rows_ = 0;
    std::size_t first_far_ = 0;
};

}  // namespace pelagic
