// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace hexmembrane {

/*! Makes the 3D view draw the classes `names` of a plugin that is loaded after the view's renderer was made.
 *
 * Needs the classes to be registered (an object of each was made, so that its class index is assigned) and Python's lock. Does nothing
 * where there is no renderer yet: one that is made later finds the classes in Omega's table. */
void registerInView(const std::vector<std::string>& names);

} // namespace hexmembrane
