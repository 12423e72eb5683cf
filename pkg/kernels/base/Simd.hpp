// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

/// Marks a leaf loop over plain arrays of doubles that is compiled several times and picked by the processor at load time: one build runs on every
/// x86-64 machine. (Not under sanitizers, whose start-up comes after the choice.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define HEXMEMBRANE_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define HEXMEMBRANE_WIDEST
#endif
