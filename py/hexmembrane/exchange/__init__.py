# SPDX-License-Identifier: GPL-2.0-or-later
"""States of PFC here: tables of balls, contacts, walls and measurement spheres, as the exporters of scripts/pfc.d write them."""
