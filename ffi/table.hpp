// What the patch tables of all references have in common.
#pragma once

#include <opensubdiv/far/patchTableFactory.h>

#include <cfloat>

namespace catoptric {

// Exact on regular patches: the defaults are drawing approximations.
inline OpenSubdiv::Far::PatchTableFactory::Options exact_options(int isolation) {
    using Options = OpenSubdiv::Far::PatchTableFactory::Options;
    Options options(isolation);
    options.SetPatchPrecision<double>();
    options.SetEndCapType(Options::ENDCAP_GREGORY_BASIS);
    options.useInfSharpPatch = true;                  // the default smooths creases
    options.generateLegacySharpCornerPatches = false; // the default moves smooth corners
    options.useSingleCreasePatch = false;             // drawing only
    options.generateVaryingTables = false;
    return options;
}

// Parameters below the normal range count as 0: end caps divide by them, which overflows.
inline double flushed(double parameter) { return parameter < DBL_MIN ? 0.0 : parameter; }

// The parameters of an n-gon's quadrants count from the n-gon: their derivatives come back doubled.
inline double derivative_scale(OpenSubdiv::Far::PatchParam param) { return param.NonQuadRoot() ? 0.5 : 1.0; }

inline bool is_regular(OpenSubdiv::Far::PatchTable const &table,
                       OpenSubdiv::Far::PatchTable::PatchHandle const &handle) {
    using Descriptor = OpenSubdiv::Far::PatchDescriptor;
    auto const type = table.GetPatchDescriptor(handle).GetType();
    return type == Descriptor::REGULAR || type == Descriptor::LOOP || type == Descriptor::QUADS;
}

} // namespace catoptric
