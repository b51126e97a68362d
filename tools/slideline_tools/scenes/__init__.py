# SPDX-License-Identifier: MIT
"""The scenes: each function returns the text of one complete deck (SI units; plane strain, or per
radian)."""
from slideline_tools.scenes.block import block, block_grids
from slideline_tools.scenes.collision import collision, collision_grids
from slideline_tools.scenes.hertz import hertz, hertz_grids
from slideline_tools.scenes.oblique import oblique, oblique_grids
from slideline_tools.scenes.patch import patch, patch_grids
from slideline_tools.scenes.sliding import sliding, sliding_grids
from slideline_tools.scenes.symmetric_plate import symmetric_plate, symmetric_plate_grid
from slideline_tools.scenes.taylor import taylor, taylor_grid

__all__ = ["block", "block_grids", "collision", "collision_grids", "committed_decks", "hertz", "hertz_grids", "oblique",
           "oblique_grids", "patch", "patch_grids", "sliding", "sliding_grids", "symmetric_plate", "symmetric_plate_grid",
           "taylor", "taylor_grid"]


def committed_decks():
    """Path below `input/` and text of every deck there that a scene writes; the others are kept as they are."""
    for level in (1, 2, 3, 4):
        yield f"collision/collision{suffix(level)}.k", collision(level)
    for level in (1, 2, 3):
        yield f"sliding/sliding{suffix(level)}.k", sliding(level)
    for level in (1, 2):
        yield f"block/block{suffix(level)}.k", block(level=level)
        yield f"block/block_implicit{suffix(level)}.k", block(level=level, implicit=True)
    for mesh in ("3/2", "5/4", "7/5", "51/50"):
        yield f"patch/patch_{mesh.replace('/', '_')}.k", patch(mesh=mesh)
    yield "hertz/hertz.k", hertz()
    for n_x, n_y in ((8, 4), (16, 8), (32, 16)):
        for law in ("elastic", "elastoplastic"):
            yield (f"symmetric_plate/plate_{n_x}x{n_y}_{law}.k",
                   symmetric_plate(n_x, n_y, elastoplastic=law == "elastoplastic"))
    yield "taylor/taylor.k", taylor()


def suffix(level):
    """What the file name of a deck says of its level."""
    return "" if level == 1 else f"_{level}"
