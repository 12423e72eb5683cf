// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/CellShares.hpp"
#include "kernels/measure/SlabStress.hpp"

namespace hexmembrane {

/// What encloses the grains: a tube of triangles round them, cut by two horizontal faces.
struct Enclosure {
	std::vector<Vec3> centres;                 ///< of the spheres that the tube is made of (m)
	double radius;                             ///< of these spheres (m)
	std::vector<Vec3> inner;                   ///< the point of the tube's surface that belongs to each sphere (m)
	std::vector<std::array<int, 3>> triangles; ///< of the surface, counter-clockwise seen from outside
	double bottom, top;                        ///< heights of the faces (m)
};

/// The grains' power cells within an enclosure, and a mesh of tetrahedra that fills the same volume.
///
/// Cells: a point of the enclosed volume belongs to the grain with the least power, |x - centre|^2 - radius^2.
///
/// Mesh: its corners are the grains' centres, the points of the tube's surface, and feet, the projections of the grains near a face on it. Which corners make
/// a tetrahedron is the power triangulation of grains, the tube's spheres, and the grains' images behind the faces: touching spheres are neighbours in it, so
/// the tube's triangles are facets nearly everywhere. Where one is not, the cycle of facets between the mesh and the tube is filled with tetrahedra from one
/// of its corners. The mesh's boundary thus is the tube by construction, whatever the positions: a tetrahedron that the move from centres to
/// surface points turned inside out counts negative, and sums over the mesh are those of the enclosed volume exactly (Gauss). The faces cut the mesh.
class PowerCells {
public:
	/// A tetrahedron of the mesh; corners are numbered grains first, then points of the tube, then feet.
	struct Tetrahedron {
		std::array<int, 4> corners;
		int times; ///< how often it counts; negative: inside out
	};

	/// \param grains centres and radii, one at least
	/// \throws FieldError for input that is not finite or has no volume; FieldFailure for a tube that does not reach the faces
	PowerCells(const std::vector<PowerSite>& grains, const Enclosure& enclosure);

	/// Volumes of the grains' cells (m3). That of a grain within others, or far outside, is 0.
	const std::vector<double>& volumes() const { return volume; }

	/// Integral over each cell of the displacement gradient, entry (i, j) du_i/dx_j (m3). Linear in each tetrahedron; at a foot sideways the grain's displacement,
	/// vertically the face's. The sum over the cells is that of u (x) n over the enclosure's surface.
	/// \param grains, inner displacements (m) of the grains and of the tube's points \param bottom, top upward displacements of the faces (m)
	/// \throws FieldError for other numbers of displacements
	std::vector<Mat3> gradients(const std::vector<Vec3>& grains, const std::vector<Vec3>& inner, double bottom, double top) const;

	/// Grains that share a tetrahedron of the mesh: those of grain i lie from starts[i] to starts[i + 1]. (Without those that meet only across a gap in the grains.)
	const std::vector<int>& starts() const { return firstNeighbour; }
	const std::vector<int>& neighbours() const { return meshNeighbour; }

	const std::vector<Vec3>& corners() const { return place; }
	const std::vector<Tetrahedron>& tetrahedra() const { return mesh; }
	/// The grain of each foot.
	const std::vector<int>& feet() const { return footOf; }
	/// Tetrahedra that were filled in beside the tube.
	int filled() const { return filledIn; }

private:
	void listFeet(std::vector<PowerSite>& sites);
	void select(const PowerTriangulation& all, const Enclosure& enclosure);
	void share(const std::vector<PowerSite>& sites, const PowerTriangulation& all);
	void listNeighbours();
	bool isTube(int corner) const { return corner >= grainCount && corner < grainCount + tubeCount; }
	/// -1 at or below the lower face, 1 at or above the upper one, 0 between.
	int beyond(int corner) const { return place[corner][2] <= low ? -1 : place[corner][2] >= high ? 1 : 0; }

	int grainCount, tubeCount, filledIn = 0;
	double low, high;
	std::vector<Vec3> place;
	std::vector<int> footOf; // grains, those at the lower face first
	std::size_t lowerFeet = 0;
	std::vector<Tetrahedron> mesh;
	std::vector<int> shareStarts; // by tetrahedron
	std::vector<CellShares::Share> shares;
	std::vector<double> volume;
	std::vector<int> firstNeighbour, meshNeighbour;
};

} // namespace hexmembrane
