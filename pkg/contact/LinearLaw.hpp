// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "LinearContact.hpp"

#include <array>

namespace yade {

class Law2_ScGeom_LinearPhys_Linear : public LawFunctor {
public:
	bool go(shared_ptr<IGeom>& geometry, shared_ptr<IPhys>& physics, Interaction* contact) override;

private:
	bool advance(const ScGeom& geom, LinearPhys& phys, const Interaction& contact);
	void pushApart(const ScGeom& geom, const LinearPhys& phys, const Interaction& contact) const;
	void push(const ScGeom& geom, const LinearPhys& phys, const Interaction& contact) const;
	void nameEnergies();
	void book(const hexmembrane::ContactStep& step, const LinearPhys& phys, const hexmembrane::ContactMemory<Real>& memory);

	// Indices of the energies, -1: not named yet.
	int elasticIndex = -1;
	std::array<int, 3> workIndices{-1, -1, -1};
	int named = 0;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(Law2_ScGeom_LinearPhys_Linear,LawFunctor,
		"PFC's linear contact laws on spheres and on spheres against boundaries: linear, linear with rolling resistance, linear contact bond. "
		"Every contact does what its LinearPhys asks for and no more.\n\n"
		"Normal force Fn = kn u, no tension: the contact is erased when u < 0. Shear Fs <- Fs - ks Δus, carried along with the contact plane, cut to μ Fn. "
		"Rolling resistance M <- M - kr Δθ, kr = ks Rm², bending only, cut to μr Rm Fn. "
		"Bonded: Fn = kn u of either sign, no slip, no moment; tension above the strength takes both forces, "
		"shear above the strength leaves them in compression as far as μ Fn holds.\n\n"
		"The geometry is ScGeom (no 6D, no orientations). Its shear increment is PFC's true relative displacement at the contact point with "
		"``Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=False)``; "
		"with YADE's default the tangential displacement of centres is 1 + u/l times as long and energies close up to that factor only.\n\n"
		"With O.trackEnergy: 'elastPotential', 'plastDissip' (sliding), 'rollDissip' (rolling), 'bondDissip' (elastic energy set free by breaking bonds).",
		((int,tensileBreaks,0,Attr::readonly,"Bonds that broke in tension so far."))
		((int,shearBreaks,0,Attr::readonly,"Bonds that broke in shear so far."))
	);
	// clang-format on
	FUNCTOR2D(ScGeom, LinearPhys);
};
REGISTER_SERIALIZABLE(Law2_ScGeom_LinearPhys_Linear);

} // namespace yade
